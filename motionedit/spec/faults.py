"""What is wrong in a spec and under which keys, before the file and line are known; and the words for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

Keys = tuple[str | int, ...]

# Longer values are cut in messages: the line and key say where the rest stands.
_LONGEST_SHOWN = 40
# More names than this are no help on one line.
_MOST_NAMES = 14


@dataclass(frozen=True)
class Fault:
    """One fault: `message` on one line, `keys` from where it was found; `file` and `line` where it is not the spec."""

    message: str
    keys: Keys = ()
    file: str | None = None
    line: int | None = None

    def under(self, *keys: str | int) -> Fault:
        """Return the fault as seen from further up the tree."""
        return replace(self, keys=(*keys, *self.keys))


class FaultyValueError(ValueError):
    """A value with one or several faults; a ValueError, as what a value that is none raises."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(fault.message for fault in self.faults))


def faulty(message: str, *keys: str | int) -> FaultyValueError:
    """Return an error with one fault, to be raised."""
    return FaultyValueError([Fault(message, keys)])


def dotted(keys: Iterable[str | int]) -> str:
    """Return keys as messages name them: ``goals.0.at``."""
    return ".".join(str(key) for key in keys)


def show(value: object) -> str:
    """Return a plain value as its user would write it, cut to a length that fits a message."""
    text = _flow(value)
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def _flow(value: object, *, inside: bool = False) -> str:
    shown = str(value)
    match value:
        case None:
            shown = "nothing"
        case bool():
            shown = "true" if value else "false"
        case str():
            # repr keeps the message on one line, whatever the text holds.
            text = value[: _LONGEST_SHOWN + 1]
            shown = text if inside and text.isidentifier() else repr(text)
        case dict():
            pairs = list(value.items())[:_LONGEST_SHOWN]
            shown = "{" + ", ".join(f"{key}: {_flow(item, inside=True)}" for key, item in pairs) + "}"
        case list() | tuple():
            shown = "[" + ", ".join(_flow(item, inside=True) for item in value[:_LONGEST_SHOWN]) + "]"
        case float():
            shown = f"{value:g}" if float(f"{value:g}") == value else repr(value)
    return shown


def listed(names: Iterable[str]) -> str:
    """Return names for a message, the first ones where there are too many."""
    all_names = list(names)
    shown = ", ".join(all_names[:_MOST_NAMES])
    more = len(all_names) - _MOST_NAMES
    return f"{shown} and {more} more" if more > 0 else shown


# How alike a name must be to the one that was meant, 0 to 1: 'Club' is 0.6 like 'LThumb'.
_ALIKE = 0.65


def nearest(name: str, names: Sequence[str]) -> str | None:
    """Return the name that was probably meant, if any is near."""
    import difflib

    folded = {other.casefold(): other for other in reversed(names)}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=1, cutoff=_ALIKE)
    return folded[close[0]] if close else None


def did_you_mean(name: str, names: Sequence[str], *, otherwise: str) -> str:
    """Return ``did you mean 'weight'?``, or `otherwise` where no name is near."""
    meant = nearest(name, names)
    return f"did you mean '{meant}'?" if meant is not None else otherwise
