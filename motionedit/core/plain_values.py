"""Values of a file that another program may have written, or a disk damaged: taken as what they must be, or refused."""

from __future__ import annotations

import json
import math
from typing import Any

# Beyond it no length, angle, rate or number of frames is one, and squares of it still are numbers.
BEYOND_SENSE = 1e9


def json_of(data: bytes) -> Any:  # noqa: ANN401  whatever it holds
    """Return the value of JSON in UTF-8.

    Raises
    ------
    ValueError
        It is none, has a number that is not finite, or is nested beyond any use.
    """

    def refuse(name: str) -> float:
        raise ValueError(f"{name} is no number of JSON")

    try:
        return json.loads(data.decode(), parse_constant=refuse)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def mapping(value: object) -> dict[str, Any]:
    """Return a value that is a mapping; else a ValueError, as all below."""
    if not isinstance(value, dict):
        raise ValueError("no mapping")  # noqa: TRY004  the caller knows one fault: not as it should be
    return value


def items(value: object) -> list[Any]:
    """Return a value that is a list."""
    if not isinstance(value, list):
        raise ValueError("no list")  # noqa: TRY004
    return value


def text(value: object) -> str:
    """Return a value that is a text."""
    if not isinstance(value, str):
        raise ValueError("no text")  # noqa: TRY004
    return value


def switch(value: object) -> bool:
    """Return a value that is true or false."""
    if not isinstance(value, bool):
        raise ValueError("neither true nor false")  # noqa: TRY004
    return value


def number(value: object, low: float = -BEYOND_SENSE, high: float = BEYOND_SENSE) -> float:
    """Return a value that is a finite number within bounds."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
        raise ValueError("no number in its range")
    return float(value)


def positive(value: object) -> float:
    """Return a value that is a number above 0, and not so near that one over it is beyond sense."""
    return number(value, 1.0 / BEYOND_SENSE)


def whole(value: object, low: int = 0, high: int = int(BEYOND_SENSE)) -> int:
    """Return a value that is a whole number within bounds."""
    found = number(value, low, high)
    if not math.floor(found) == found:
        raise ValueError("no whole number")
    return int(found)
