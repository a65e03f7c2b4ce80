"""The JSON report: fixed keys in a fixed order, rounded numbers, no times of day, so that two reports compare."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from motionedit.version import __version__

SCHEMA = "motionedit/report/v1"
# Enough for any comparison, and few enough that the last bits of two machines do not show.
_DIGITS = 9
_SHORT = f"%.{_DIGITS}g"  # as a format that is made once
# Whole numbers below the first are as short already; below the second so many digits reach beyond so many decimals.
_WHOLE, _TENTH = 10.0**_DIGITS, 0.1
_INDENT = "\n  "
_AS_THEY_ARE = frozenset({type(None), bool, int, str})


def report_bytes(
    command: str,
    clips: Iterable[dict[str, Any]],
    *,
    spec: Mapping[str, Any] | None = None,
    more: Mapping[str, Any] | None = None,
) -> bytes:
    """Return what `report_pieces` yields in one piece."""
    return b"".join(report_pieces(command, clips, spec=spec, more=more))


def report_pieces(
    command: str,
    clips: Iterable[dict[str, Any]],
    *,
    spec: Mapping[str, Any] | None = None,
    more: Mapping[str, Any] | None = None,
) -> Iterator[bytes]:
    """Yield the report as UTF-8 JSON, clip by clip: a report of many clips need not be held to be written.

    Parameters
    ----------
    clips : iterable of dict
        One entry per clip, in the run's order.
    spec : mapping or None
        The spec with `--set` applied.
    more : mapping or None
        What a command adds below the fixed keys.
    """
    head = {"schema": SCHEMA, "version": __version__, "command": command, "spec": spec}
    keys = "".join(f"{_INDENT}{_scalar(key)}: {_text(plain(value), _INDENT)}," for key, value in head.items())
    yield _encoded(f'{{{keys}{_INDENT}"clips": [')
    inner = f"{_INDENT}  "
    count = 0
    for count, clip in enumerate(clips, start=1):
        yield _encoded(f"{',' if count > 1 else ''}{inner}{_text(plain(clip), inner)}")
    rest = "".join(f",{_INDENT}{_scalar(key)}: {_text(plain(value), _INDENT)}" for key, value in (more or {}).items())
    yield _encoded(f"{_INDENT if count else ''}]{rest}\n}}\n")


def without_frames(record: dict[str, Any]) -> dict[str, Any]:
    """Return a clip's entry without what is told frame by frame, which takes more than all else: `frames`, mappings."""
    kept: dict[str, Any] = {}
    for key, value in record.items():
        if key == "frames" and (type(value) is dict or isinstance(value, Mapping)):
            continue
        kept[key] = (
            [without_frames(item) if type(item) is dict else item for item in value] if type(value) is list else value
        )
    return kept


def _encoded(text: str) -> bytes:
    # File names need not be text; JSON must be.
    return text.encode(errors="replace")


def _text(value: Any, newline: str) -> str:  # noqa: ANN401  any plain value
    """Return JSON with a line for each key; a list of numbers or words stands on one, however long it is."""
    inner = f"{newline}  "
    if isinstance(value, dict) and value:
        items = [f"{_scalar(key)}: {_text(item, inner)}" for key, item in value.items()]
        return f"{{{inner}{f',{inner}'.join(items)}{newline}}}"
    if isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
        return f"[{inner}{f',{inner}'.join(_text(item, inner) for item in value)}{newline}]"
    return _scalar(value)


def _scalar(value: Any) -> str:  # noqa: ANN401  a number, a text, or a list of them
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def plain(value: Any) -> Any:  # noqa: ANN401  any value that a report may hold
    """Return a value as JSON holds it: numbers rounded, arrays as lists, what is not finite as null."""
    kind = type(value)
    if kind in _AS_THEY_ARE:
        return value
    if isinstance(value, float):
        return _rounded(value)
    if isinstance(value, (list, tuple)):
        return _plain_items(value)
    # The dearest question last: whether another class is a mapping.
    if kind is dict or isinstance(value, Mapping):
        return _plain_mapping(value)
    if hasattr(value, "tolist"):  # numpy's numbers and arrays
        return plain(value.tolist())
    return value if isinstance(value, (int, str)) else str(value)


# A clip's record has dozens of mappings, lists and numbers: what most of them are is told here without a call more.


def _plain_items(items: Sequence[Any]) -> list[Any]:
    if _AS_THEY_ARE.issuperset(map(type, items)):
        return list(items)
    return [_rounded(item) if type(item) is float else plain(item) for item in items]


def _plain_mapping(items: Mapping[Any, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, item in items.items():
        kind = type(item)
        if kind in _AS_THEY_ARE:
            value = item
        elif kind is float:
            value = _rounded(item)
        elif kind is list or kind is tuple:
            value = _plain_items(item)
        else:
            value = _plain_mapping(item) if kind is dict else plain(item)
        found[key if type(key) is str else str(key)] = value
    return found


def _rounded(value: float) -> float | None:
    if value.is_integer() and -_WHOLE < value < _WHOLE:
        return float(value) + 0.0
    if not math.isfinite(value):
        return None
    short = float(_SHORT % value)
    return round(short, _DIGITS) + 0.0 if -_TENTH < short < _TENTH else short
