"""From double precision to decimal text, whole blocks of a file at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray

# The four characters of every number below 10,000, as one 32-bit word.
_DIGITS = np.arange(10_000)[:, None] // np.array([1000, 100, 10, 1]) % 10 + ord("0")
_FOURS = frozen(_DIGITS.astype(np.uint8).view("<u4").reshape(-1))
# From here on values are formatted one by one: a double has no decimals left, and 64-bit integers end soon after.
_LARGEST = 1e15


@dataclass(frozen=True, eq=False)
class Words:
    """Words of text.

    Attributes
    ----------
    chars : shape (N, W)
        Each word stands at the right end of its row; what is left of it means nothing.
    lengths : shape (N,)
        Characters of each word.
    """

    chars: NDArray[np.uint8]
    lengths: IntArray


def format_fixed(values: FloatArray, *, decimals: int, ends: NDArray[np.uint8] | None = None) -> Words:
    """Return values with a fixed number of decimals, never in scientific notation and never as -0.0.

    Parameters
    ----------
    values : shape (N,)
        Finite; at least one.
    decimals : int
        1 to 17.
    ends : shape (N,), optional
        A character to follow each value, part of its word.
    """
    size = np.abs(values)
    if size.max() >= _LARGEST:
        return _format_large(values, decimals=decimals, ends=ends)
    whole, fraction = _split(size, decimals)
    places = len(str(int(whole.max())))
    tail = int(ends is not None)
    # Digits are laid four at a time, from the right, each four over the zeros that the last left too many.
    point = 1 + -(-places // 4) * 4
    width = -(-(point + 1 + decimals + tail) // 8) * 8
    point = width - tail - decimals - 1
    chars = np.empty((len(values), width), np.uint8)
    if ends is not None:
        chars[:, -1] = ends
    _lay_digits(chars, fraction, stop=width - tail, count=decimals)
    chars[:, point] = ord(".")
    lengths = np.full(len(values), 2 + decimals + tail)
    for k in range(1, places):
        lengths += whole >= 10**k
    minus = np.flatnonzero((values < 0.0) & ((whole > 0) | (fraction > 0)))
    _lay_digits(chars, whole, stop=point, count=places)
    lengths[minus] += 1
    chars.reshape(-1)[(minus + 1) * width - lengths[minus]] = ord("-")
    return Words(chars, lengths)


def place(words: NDArray[np.uint8], stops: IntArray, *, out: NDArray[np.uint8], margin: int) -> None:
    """Write words into a line of text, each ending before its stop, given in rising order.

    Each row of `words`, shape (N, W), is written whole, the last first: what a row has too much on its left falls on
    the word before it, which is written after, or on the blanks between them, which are the caller's to write.

    Parameters
    ----------
    out : shape (margin + text,)
        The text. Its first `margin` bytes, at least W, take what the first words have too much.
    """
    width = words.shape[1]
    windows = np.ndarray((len(out) - width + 1,), f"V{width}", buffer=out.data, strides=(1,))
    windows[stops[::-1] + (margin - width)] = words.view(f"V{width}").reshape(-1)[::-1]


def _split(size: FloatArray, decimals: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the whole part and the decimals, as integers, of values that are not negative."""
    whole = size.astype(np.int64)
    fraction = np.rint((size - whole) * 10.0**decimals).astype(np.int64)
    carried = np.flatnonzero(fraction >= 10**decimals)
    whole[carried] += 1
    fraction[carried] = 0
    return whole, fraction


def _lay_digits(chars: NDArray[np.uint8], numbers: NDArray[np.int64], *, stop: int, count: int) -> None:
    """Write `count` digits of numbers before column `stop`, with leading zeros up to a multiple of four."""
    rows, width = chars.shape
    for end in range(stop, stop - count, -4):
        last = end - 4 <= stop - count
        higher = numbers if last else numbers // 10_000
        four = numbers if last else numbers - higher * 10_000
        column = np.ndarray((rows,), "<u4", buffer=chars.data, offset=end - 4, strides=(width,))
        column[:] = _FOURS[four]
        numbers = higher


def _format_large(values: FloatArray, *, decimals: int, ends: NDArray[np.uint8] | None) -> Words:
    """Format one by one values that are too large for the digit table."""
    words = [f"{value:.{decimals}f}".encode() for value in values.tolist()]
    words = [word if float(word) else word.lstrip(b"-") for word in words]
    if ends is not None:
        words = [word + bytes((end,)) for word, end in zip(words, ends.tolist(), strict=True)]
    lengths = np.array([len(word) for word in words])
    width = int(lengths.max())
    joined = bytearray().join(word.rjust(width) for word in words)
    return Words(np.frombuffer(joined, np.uint8).reshape(len(words), width), lengths)
