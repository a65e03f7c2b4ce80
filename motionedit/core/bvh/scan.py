"""The bytes of a BVH file as places: lines, words and values, found without copying the file."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from motionedit.errors import BvhError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from motionedit.core.arrays import IntArray

# Quoted text of a hostile file must not fill the screen.
_QUOTE_LENGTH = 40
# The longest exact decimal expansion of a double has fewer characters; longer words are no numbers anyone wrote.
WORD_LENGTH = 1200
# No body is larger in any unit, and squares and cubes of it are still numbers, its own in single precision, too.
LARGEST_LENGTH = 1e30
_NUMBER = re.compile(rb"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def refusal(data: bytes, message: str, *, label: str, at: int) -> BvhError:
    """Return the error for a fault at byte `at`, with its line counted from 1.

    LF, CR LF and a lone CR each end a line, in one file together if need be.
    """
    return BvhError(message, file=label, line=line_number(data, at))


def line_number(data: bytes, at: int) -> int:
    """Return the number, from 1, of the line that byte `at` stands in."""
    before = np.frombuffer(data, np.uint8, count=min(at, len(data)))
    feeds = before == ord("\n")
    returns = before == ord("\r")
    pairs = np.count_nonzero(returns[:-1] & feeds[1:])
    return 1 + int(np.count_nonzero(feeds)) + int(np.count_nonzero(returns)) - int(pairs)


def quoted(word: bytes) -> str:
    """Return a word of the file as text for a message: escaped and cut short."""
    text = repr(text_of(word[: _QUOTE_LENGTH + 1]))
    return text if len(word) <= _QUOTE_LENGTH else f"{text[: _QUOTE_LENGTH - 2]}...'"


def text_of(word: bytes) -> str:
    """Return bytes as text: UTF-8, or Latin-1 where they are none, so that every name can be read."""
    try:
        return word.decode("utf-8")
    except UnicodeDecodeError:
        return word.decode("latin-1")


def number(word: bytes) -> float | None:
    """Return the value of a decimal number, or None where the word is none, is too long or is not finite."""
    if len(word) > WORD_LENGTH or not _NUMBER.fullmatch(word):
        return None
    value = float(word)
    return value if np.isfinite(value) else None


def decimals(word: bytes) -> int:
    """Return how many decimals a number's text carries; an exponent counts as if it were written out."""
    mantissa, _, exponent = word.lower().partition(b"e")
    _, _, fraction = mantissa.partition(b".")
    return max(len(fraction) - (int(exponent) if exponent else 0), 0)


def words_between(data: bytes, start: int, stop: int) -> tuple[IntArray, IntArray]:
    """Return where each word begins and ends (exclusive) between two bytes that cut no word, shapes (N,)."""
    solid = np.frombuffer(data, np.uint8, count=stop - start, offset=start) > ord(" ")
    edges = np.flatnonzero(solid[1:] != solid[:-1])
    edges += start + 1
    if solid[0]:
        edges = np.concatenate(([start], edges))
    if solid[-1]:
        edges = np.concatenate((edges, [stop]))
    return edges[0::2], edges[1::2]


def line_breaks(chars: NDArray[np.uint8]) -> IntArray:
    """Return the places of line feeds and carriage returns."""
    return np.flatnonzero((chars == ord("\n")) | (chars == ord("\r")))


def line_blocks(data: bytes, start: int, *, size: int) -> Iterator[tuple[int, int]]:
    """Yield (start, stop) of blocks of whole lines from byte `start` on, each about `size` bytes.

    A line that is longer than a block stands alone in its own.
    """
    feed = -1
    while start < len(data):
        aim = start + size
        stop = len(data)
        if aim < len(data):
            if feed < aim:
                # Remembered, because in a file of lone carriage returns each search runs to the end.
                found = data.find(b"\n", aim)
                feed = found if found >= 0 else len(data)
            carriage = data.find(b"\r", aim, min(feed, aim + size))
            stop = carriage if carriage >= 0 else feed
            if stop - start > 2 * size:
                last = max(data.rfind(b"\n", start, aim), data.rfind(b"\r", start, aim))
                if last > start:
                    stop = last
                else:
                    carriage = data.find(b"\r", aim, feed)
                    stop = carriage if carriage >= 0 else feed
            stop = min(stop + 1, len(data))
        yield start, stop
        start = stop
