"""From decimal text to double precision, whole blocks of a file at once, correctly rounded.

A number of at most 15 digits and a point is an integer below 2^53 divided by a power of ten that a double holds
exactly, so one division rounds it correctly. The integer is read eight digits at a time inside 64-bit words.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.scan import WORD_LENGTH, number
from motionedit.core.bvh.scan import decimals as decimals_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray

# Bytes of a number that are read at once: 15 digits and a point, or 16 digits, which one conversion rounds correctly.
_WINDOW = 16
_ZERO, _NINE = ord("0"), ord("9")
_NUMERIC = b"0123456789+-.eE \t\n\r\v\f"

# For a number of L characters, the bytes of its window that belong to it.
_LENGTHS = np.arange(_WINDOW + 1)
_MASKS = np.zeros((_WINDOW + 1, _WINDOW), np.uint8)
for _length in _LENGTHS:
    _MASKS[_length, _WINDOW - _length :] = 0x0F
_MASKS_16 = frozen(_MASKS.view("<u8").astype(np.uint64))
_MASKS_8 = frozen(_MASKS_16[:9, 1].copy())

# Indexed by k, the characters from the point on (0: no point). A point's low four bits are 14.
_K = np.arange(_WINDOW + 1, dtype=np.int64)
_POINT = frozen(np.where(_K > 0, 14 * 10 ** np.maximum(_K - 1, 0), 0))
_SHIFTED = frozen(np.where(_K > 0, 10**_K, 10**17))
_NINES = frozen(np.where(_K > 0, 9 * 10 ** np.maximum(_K - 1, 0), 0))
_SCALE = frozen(10.0 ** np.maximum(_K - 1, 0))


@dataclass(frozen=True)
class FaultyWord:
    """The first word of a block that is no finite decimal number: its place among the block's words."""

    index: int


def parse_block(data: bytes, starts: IntArray, stops: IntArray, *, out: FloatArray) -> int | FaultyWord:
    """Write the values of words into `out` and return the largest number of decimals among them.

    Parameters
    ----------
    data : bytes
        The file. At least 16 bytes stand before the first word.
    starts, stops : shape (N,)
        First byte of each word and the byte after its last.
    out : shape (N,)
        Receives the values, correctly rounded.
    """
    decimals = _parse_plain(data, starts, stops, out)
    if decimals is None:
        decimals = _parse_long(data, starts, stops, out)
    return _parse_any(data, starts, stops, out) if decimals is None else decimals


def _parse_plain(data: bytes, starts: IntArray, stops: IntArray, out: FloatArray) -> int | None:
    """Parse words of a sign, at most 15 digits and a point; None where a word is anything else."""
    block = np.frombuffer(data, np.uint8, count=int(stops[-1] - starts[0]), offset=int(starts[0]))
    first = block[starts - starts[0]]
    minus = first == ord("-")
    signed = minus | (first == ord("+"))
    lengths = stops - starts
    solid = int(lengths.sum())
    lengths -= signed
    longest = int(lengths.max())
    if longest > _WINDOW:
        return None
    points = block == ord(".")
    pointed = int(np.count_nonzero(points))
    digits = np.count_nonzero(block - np.uint8(_ZERO) <= _NINE - _ZERO)
    if solid != digits + pointed + np.count_nonzero(signed):
        return None
    k = _from_point_on(points, pointed, starts, stops)
    if k is None:
        return None
    if isinstance(k, int):
        fewest, low, high = int(lengths.min()) - 1, k, k
    else:
        fewest, low, high = int((lengths - (k > 0)).min()), int(k.min()), int(k.max())
    if fewest < 1:
        return None
    mantissa = _mantissas(data, stops, lengths, longest)
    if low == high:
        # numpy divides faster by one number than by many.
        mantissa -= _POINT[low]
        mantissa -= mantissa // _SHIFTED[low] * _NINES[low]
        np.divide(mantissa, _SCALE[low], out=out)
    else:
        mantissa -= _POINT[k]
        mantissa -= mantissa // _SHIFTED[k] * _NINES[k]
        np.divide(mantissa, _SCALE[k], out=out)
    np.negative(out, out=out, where=minus)
    return max(high - 1, 0)


def _from_point_on(points: BoolArray, count: int, starts: IntArray, stops: IntArray) -> IntArray | int | None:
    """Return the number of characters from each word's point on, 0 without one; None where a word has two.

    `points` tells where the block that begins with the first word has its `count` points. One number is returned
    where all words agree, as they do in most files: then no point need be searched for.
    """
    places = stops - starts[0]
    k = _first_word_from_point_on(points, int(places[0]))
    if count == len(starts) and 0 < k <= int((stops - starts).min()) and points[places - k].all():
        return k
    at = np.flatnonzero(points)
    owners = np.searchsorted(starts, at + starts[0], side="right") - 1
    if bool(np.any(owners[1:] == owners[:-1])):
        return None
    each = np.zeros(len(starts), np.intp)
    each[owners] = places[owners] - at
    return each


def _first_word_from_point_on(points: BoolArray, length: int) -> int:
    return length - int(np.argmax(points[:length])) if points[:length].any() else 0


def _mantissas(data: bytes, stops: IntArray, lengths: IntArray, longest: int) -> NDArray[np.int64]:
    """Return the words read as integers; a point counts as a digit of 14."""
    size = 8 if longest <= 8 else _WINDOW
    windows = np.ndarray((len(data) - size + 1,), f"V{size}", buffer=data, strides=(1,))
    w = windows[stops - size].view("<u8").astype(np.uint64, copy=False)
    w &= _MASKS_8[lengths] if size == 8 else _MASKS_16[lengths].reshape(-1)
    # Neighbouring digits, then pairs, then fours, are joined side by side; lanes hold 14 as a digit too.
    for factor, shift, lanes in (
        (10, 8, 0x00FF00FF00FF00FF),
        (100, 16, 0x0000FFFF0000FFFF),
        (10_000, 32, 0x00000000FFFFFFFF),
    ):
        upper = w >> np.uint64(shift)
        w *= np.uint64(factor)
        w += upper
        w &= np.uint64(lanes)
    halves = w.view(np.int64)
    return halves if size == 8 else halves[0::2] * 10**8 + halves[1::2]


def _parse_long(data: bytes, starts: IntArray, stops: IntArray, out: FloatArray) -> int | None:
    """Parse words with many digits or exponents by numpy's own reader; None where that could be wrong."""
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
    with_exponent = np.union1d(_owners(block, ord("e"), starts), _owners(block, ord("E"), starts))
    decimals = decimals[~np.isin(with_point, with_exponent)]
    exact = (decimals_of(data[starts[i] : stops[i]]) for i in with_exponent)
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
