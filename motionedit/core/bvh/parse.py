"""From decimal text to doubles, correctly rounded: what csrc/read_text.c leaves, and all where nothing is compiled."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.bvh.scan import WORD_LENGTH, number
from motionedit.core.bvh.scan import decimals as decimals_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray

_NUMERIC = b"0123456789+-.eE \t\n\r\v\f"


@dataclass(frozen=True)
class FaultyWord:
    """The first word of a block that is no finite decimal number: its place among the block's words."""

    index: int


def parse_block(data: bytes, starts: IntArray, stops: IntArray, *, out: FloatArray) -> int | FaultyWord:
    """Write the values of words into `out` and return the largest number of decimals among them.

    Parameters
    ----------
    data : bytes
        The file.
    starts, stops : shape (N,)
        First byte of each word and the byte after its last.
    out : shape (N,)
        Receives the values, correctly rounded.
    """
    decimals = _parse_long(data, starts, stops, out)
    return _parse_any(data, starts, stops, out) if decimals is None else decimals


def _parse_long(data: bytes, starts: IntArray, stops: IntArray, out: FloatArray) -> int | None:
    """Parse words by numpy's own reader; None where that could be wrong."""
    text = data[int(starts[0]) : int(stops[-1])]
    if text.translate(None, _NUMERIC) or int((stops - starts).max()) > WORD_LENGTH:
        return None  # the reader would take nan, inf and hexadecimal digits
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            values = np.fromstring(text, dtype=np.float64, sep=" ")
    except (DeprecationWarning, ValueError):
        return None
    # Older readers take 1-2 for two numbers.
    if len(values) != len(starts) or not np.isfinite(values).all():
        return None
    out[:] = values
    block = np.frombuffer(text, np.uint8)
    with_point = _owners(block, ord("."), starts)
    points = np.flatnonzero(block == ord(".")) + starts[0]
    decimals = stops[with_point] - points - 1
    exponents = np.zeros(len(starts), dtype=np.bool_)
    exponents[_owners(block | np.uint8(0x20), ord("e"), starts)] = True
    decimals = decimals[~exponents[with_point]]
    exact = (decimals_of(data[starts[i] : stops[i]]) for i in np.flatnonzero(exponents))
    return max(int(decimals.max(initial=0)), *exact, 0)


def _owners(block: NDArray[np.uint8], letter: int, starts: IntArray) -> IntArray:
    """Return the index of the word that each occurrence of a letter stands in."""
    places = np.flatnonzero(block == letter) + starts[0]
    return np.asarray(np.searchsorted(starts, places, side="right") - 1, dtype=np.intp)


def _parse_any(data: bytes, starts: IntArray, stops: IntArray, out: FloatArray) -> int | FaultyWord:
    """Parse words of any length and form one by one; this is the rule that the fast way must agree with."""
    most = 0
    for i, (start, stop) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
        word = data[start:stop]
        value = number(word)
        if value is None:
            return FaultyWord(i)
        out[i] = value
        most = max(most, decimals_of(word))
    return most
