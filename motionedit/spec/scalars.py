"""Plain values out of YAML made into numbers, words, names and vectors, or refused in plain words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from motionedit.spec.faults import Fault, FaultyValueError, did_you_mean, faulty, show

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import TypeVar

    T = TypeVar("T")

Vector = tuple[float, float, float]
AXES = ("x", "y", "z")
# No number of a spec is larger, or, where it is above 0, smaller: squares of such are no numbers any more, and no clip
# has them, in whichever unit.
LARGEST, SMALLEST = 1e9, 1e-12
# A direction shorter than this says nothing.
_SHORTEST = 1e-9


def number(
    value: object,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    smallest: float = SMALLEST,
    largest: float = LARGEST,
) -> float:
    """Return a number within its bounds, and of a size that makes sense: `smallest` is for those above 0."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise faulty(f"must be a number, not {show(value)}")
    if not math.isfinite(value):
        raise faulty("must be a finite number")
    _check_range(value, above=above, at_least=at_least, at_most=at_most)
    _check_size(value, largest)
    if above == 0.0 and value < smallest:
        raise faulty(f"must be at least {smallest:g}, not {show(value)}")
    return float(value)


def whole(value: object, *, at_least: int | None = None, largest: float = LARGEST) -> int:
    """Return a whole number within its bound, and of a size that makes sense; ``9.0`` is 9."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise faulty(f"must be a whole number, not {show(value)}")
    if not math.isfinite(value) or value != int(value):
        raise faulty(f"must be a whole number, not {show(value)}")
    _check_range(value, at_least=at_least)
    _check_size(value, largest)
    return int(value)


def _check_size(value: float, largest: float) -> None:
    """Refuse in words what no honest use has, and what would overflow."""
    if value > largest:
        raise faulty(f"must be at most {largest:.10g}, not {show(value)}")
    if value < -largest:
        raise faulty(f"must be at least {-largest:.10g}, not {show(value)}")


def _check_range(
    value: float, *, above: float | None = None, at_least: float | None = None, at_most: float | None = None
) -> None:
    wrong = (
        (above is not None and value <= above)
        or (at_least is not None and value < at_least)
        or (at_most is not None and value > at_most)
    )
    if wrong:
        raise faulty(f"must be {range_words(above=above, at_least=at_least, at_most=at_most)}, not {show(value)}")


def range_words(*, above: float | None = None, at_least: float | None = None, at_most: float | None = None) -> str:
    """Return the bounds in words: ``larger than 0``, ``from -1 to 1``, ``at least 2``."""
    if above is not None:
        ending = "" if at_most is None else f" and at most {at_most:g}"
        return f"larger than {above:g}{ending}"
    if at_least is not None and at_most is not None:
        return f"from {at_least:g} to {at_most:g}"
    return "" if at_least is None else f"at least {at_least:g}"


def flag(value: object) -> bool:
    """Return true or false; YAML 1.1's yes, no, on and off are words."""
    if not isinstance(value, bool):
        raise faulty(f"must be true or false, not {show(value)}")
    return value


def word(value: object, choices: Sequence[str]) -> str:
    """Return one of a few words."""
    if isinstance(value, str) and value in choices:
        return value
    wanted = f"must be {one_of(choices)}, not {show(value)}"
    meant = did_you_mean(value, choices, otherwise="") if isinstance(value, str) else ""
    raise faulty(f"{wanted}; {meant}" if meant else wanted)


def one_of(choices: Sequence[str]) -> str:
    """Return ``a``, ``a or b``, ``a, b or c``."""
    return choices[0] if len(choices) == 1 else f"{', '.join(choices[:-1])} or {choices[-1]}"


def name(value: object, *, what: str) -> str:
    """Return a name; a number is refused, because YAML may have read ``001`` as 1."""
    if not isinstance(value, str) or not value.strip():
        quoted = "; put quotes around it" if isinstance(value, (int, float)) else ""
        raise faulty(f"must be {what}, not {show(value)}{quoted}")
    if any(not character.isprintable() for character in value):
        raise faulty(f"must be {what} on one line, not {show(value)}")
    return value


def items(value: object, parse: Callable[[object], T], *, what: str, empty: bool = False) -> tuple[T, ...]:
    """Return a list with each item parsed; every faulty item is reported under its index."""
    if not isinstance(value, list):
        raise faulty(f"must be {what}, not {show(value)}")
    if not value and not empty:
        raise faulty(f"must be {what}, not an empty list")
    found: list[T] = []
    faults: list[Fault] = []
    for i, item in enumerate(value):
        try:
            if item is None:
                raise faulty("needs a value")
            found.append(parse(item))
        except FaultyValueError as error:
            faults += [fault.under(i) for fault in error.faults]
    if faults:
        raise FaultyValueError(faults)
    return tuple(found)


def names(value: object, *, what: str, empty: bool = False) -> tuple[str, ...]:
    """Return a list of different names."""
    found = items(value, lambda item: name(item, what="a name"), what=what, empty=empty)
    faults = [Fault(f"'{item}' is listed twice", (i,)) for i, item in enumerate(found) if item in found[:i]]
    if faults:
        raise FaultyValueError(faults)
    return found


def vector(value: object) -> Vector:
    """Return three finite numbers."""
    x, y, z = numbers(value, count=3, what="three numbers [x, y, z]")
    return x, y, z


def direction(value: object) -> Vector:
    """Return three finite numbers that are not all zero, or next to it."""
    found = vector(value)
    if max(map(abs, found)) < _SHORTEST:
        raise faulty(f"must be a direction, not {show(value) if any(found) else '[0, 0, 0]'}")
    return found


def numbers(value: object, *, count: int, what: str) -> tuple[float, ...]:
    """Return a list of exactly `count` finite numbers."""
    if not isinstance(value, list) or len(value) != count:
        raise faulty(f"must be {what}, not {show(value)}")
    return items(value, number, what=what)


def axes(value: object) -> tuple[int, ...]:
    """Return the indices of some of x, y, z, in that order: ``[z, x]`` is (0, 2)."""
    found = names(value, what="a list of some of x, y, z")
    faults = [Fault(f"must be x, y or z, not {show(item)}", (i,)) for i, item in enumerate(found) if item not in AXES]
    if faults:
        raise FaultyValueError(faults)
    return tuple(sorted(AXES.index(item) for item in found))
