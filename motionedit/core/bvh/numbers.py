"""Decimal numbers between text and double precision, whole blocks of a file at once, correctly rounded.

A number of at most 15 digits is an integer below 2^53 divided by a power of ten that a double holds exactly, so one
division rounds it correctly. The integer is read eight digits at a time inside 64-bit words.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.scan import WORD_LENGTH, number
from motionedit.core.bvh.scan import decimals as decimals_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray

_WINDOW = 16  # bytes of a number that are read at once
_MOST_DIGITS = 15  # 10^15 < 2^53
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


# The four characters of every number below 10,000, read as one row.
_FOURS = np.arange(10_000, dtype=np.uint16)[:, None] // np.array([1000, 100, 10, 1], np.uint16) % np.uint16(10)
_FOURS = frozen(_FOURS.astype(np.uint8) + np.uint8(_ZERO))
# Above this a double has no fraction left, and 64-bit integers end soon after.
_LARGEST = 1e15


@dataclass(frozen=True)
class FaultyWord:
    """The first word of a block that is no finite decimal number: its place among the block's words."""

    index: int


@dataclass(frozen=True, eq=False)
class Text:
    """Words of text: `chars` of shape (N, W), each word at the right end of its row, and their `lengths` (N,)."""

    chars: NDArray[np.uint8]
    lengths: IntArray

    def joined(self) -> NDArray[np.uint8]:
        """Return all words one after the other."""
        width = self.chars.shape[1]
        joined: NDArray[np.uint8] = self.chars[np.arange(width) >= width - self.lengths[:, None]]
        return joined


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
    points = np.flatnonzero(block == ord("."))
    digits = np.count_nonzero(block - np.uint8(_ZERO) <= _NINE - _ZERO)
    if solid != digits + len(points) + np.count_nonzero(signed):
        return None
    points += starts[0]
    k = _from_point_on(points, starts, stops)
    if k is None:
        return None
    digits_of = lengths - (k > 0)
    if int(digits_of.min()) < 1 or int(digits_of.max()) > _MOST_DIGITS:
        return None
    mantissa = _mantissas(data, stops, lengths, longest)
    low, high = int(k.min()), int(k.max())
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


def _from_point_on(points: IntArray, starts: IntArray, stops: IntArray) -> IntArray | None:
    """Return the number of characters from each word's point on, 0 without one; None where a word has two."""
    if len(points) == len(starts) and bool(np.all((points >= starts) & (points < stops))):
        return stops - points
    owners = np.searchsorted(starts, points, side="right") - 1
    if bool(np.any(owners[1:] == owners[:-1])):
        return None
    k = np.zeros(len(starts), np.intp)
    k[owners] = stops[owners] - points
    return k


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
    # The reader takes 1-2 for two numbers.
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


def format_block(values: FloatArray, *, decimals: int, ends: NDArray[np.uint8] | None = None) -> Text:
    """Return values as text with a fixed number of decimals, never in scientific notation and never -0.0.

    Parameters
    ----------
    values : shape (N,)
        Finite.
    decimals : int
        1 to 17.
    ends : shape (N,), optional
        A character to follow each value.
    """
    if len(values) and np.abs(values).max() >= _LARGEST:
        return _format_large(values, decimals=decimals, ends=ends)
    size = np.abs(values)
    whole = size.astype(np.int64)
    fraction = np.rint((size - whole) * 10.0**decimals).astype(np.int64)
    carried = fraction >= 10**decimals
    whole += carried
    fraction[carried] = 0
    minus = np.signbit(values) & ((whole > 0) | (fraction > 0))
    largest = int(whole.max(initial=0))
    places = len(str(largest))
    tail = ends is not None
    width = 1 + places + 1 + decimals + tail
    chars = np.empty((len(values), width), np.uint8)
    point = 1 + places
    _put_digits(chars, whole, start=1, stop=point)
    chars[:, point] = ord(".")
    _put_digits(chars, fraction, start=point + 1, stop=point + 1 + decimals)
    if ends is not None:
        chars[:, -1] = ends
    lengths = np.full(len(values), 2 + decimals + tail)
    for k in range(1, places):
        lengths += whole >= 10**k
    chars[np.flatnonzero(minus), (width - 1 - lengths)[minus]] = ord("-")
    lengths += minus
    return Text(chars, lengths)


def _put_digits(chars: NDArray[np.uint8], numbers: NDArray[np.int64], *, start: int, stop: int) -> None:
    """Write numbers right-aligned, with leading zeros, into the columns from start to stop."""
    while stop - start > 4:
        higher = numbers // 10_000
        chars[:, stop - 4 : stop] = _FOURS[numbers - higher * 10_000]
        numbers = higher
        stop -= 4
    chars[:, start:stop] = _FOURS[numbers, 4 - (stop - start) :]


def _format_large(values: FloatArray, *, decimals: int, ends: NDArray[np.uint8] | None) -> Text:
    """Format one by one values that are too large for the digit tables."""
    words = [f"{value:.{decimals}f}".encode() for value in values.tolist()]
    if ends is not None:
        words = [word + bytes((end,)) for word, end in zip(words, ends.tolist(), strict=True)]
    lengths = np.array([len(word) for word in words])
    width = int(lengths.max())
    joined = b"".join(word.rjust(width) for word in words)
    return Text(np.frombuffer(joined, np.uint8).reshape(len(words), width), lengths)
