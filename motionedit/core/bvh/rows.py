"""The rows of a BVH file's MOTION part: read block by block, strictly, with the line of every fault."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.parse import FaultyWord, parse_block
from motionedit.core.bvh.scan import line_blocks, line_breaks, quoted, refusal, words_between

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray

# A block and its arrays stay in the processor's cache.
BLOCK_BYTES = 1 << 17
_CUT_NUMBER = re.compile(rb"[+-]?[0-9]*\.?[0-9]*(?:[eE][+-]?)?[0-9]*")


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of a file.

    Attributes
    ----------
    values : shape (F, C)
        As in the file, double precision.
    starts, stops : shape (F,)
        First byte of each row's first value, and the byte after its last.
    decimals : int
        The largest number of decimals among the values.
    cut_off : int or None
        The byte where a last row begins that was cut short and left out (lenient only).
    surplus : int
        Rows after more than the expected ones, which were only counted: the file will be refused.
    """

    values: FloatArray
    starts: IntArray
    stops: IntArray
    decimals: int
    cut_off: int | None
    surplus: int


@dataclass(frozen=True)
class _Block:
    starts: IntArray
    stops: IntArray
    decimals: int
    cut_off: int | None = None


def read_rows(data: bytes, start: int, *, columns: int, expected: int, label: str, lenient: bool) -> Rows:
    """Return the rows from byte `start` on.

    Parameters
    ----------
    columns : int
        C, the number of channels.
    expected : int
        Frames that the file declares; memory is set aside for so many, or for what the file can hold.
    lenient : bool
        Whether a last row with too few values is left out instead of refused.

    Raises
    ------
    BvhError
        With the line, where a value is no finite number or a row has not C values.
    """
    # A value and its blank take two bytes. Pages that are never written to cost nothing.
    capacity = (len(data) - start + 1) // 2 // columns + 1
    if not lenient:
        capacity = min(capacity, expected + 1)
    values = np.empty((capacity, columns))
    starts, stops = [np.zeros(0, np.intp)], [np.zeros(0, np.intp)]
    count = surplus = decimals = 0
    cut_off = None
    for begin, end in line_blocks(data, start, size=BLOCK_BYTES):
        if not lenient and count > expected:
            surplus += _rows_within(data, begin, end)
            continue
        words = _words(data, begin, end, columns, label, frame=count)
        room = len(words[0]) // columns + 1
        if count + room > len(values):
            # More rows than declared come in a strict reading: this block is read all the same, the next are counted.
            values = np.concatenate((values[:count], np.empty((room, columns))))
        out = values[count : count + room]
        block = _read_block(data, begin, end, words, out, label, frame=count, lenient=lenient)
        starts.append(block.starts)
        stops.append(block.stops)
        count += len(block.starts)
        decimals = max(decimals, block.decimals)
        cut_off = block.cut_off
    return Rows(
        frozen(values[:count]),
        frozen(np.concatenate(starts)),
        frozen(np.concatenate(stops)),
        decimals,
        cut_off,
        surplus,
    )


def _rows_within(data: bytes, begin: int, end: int) -> int:
    """Return how many lines of a block are not blank."""
    chars = np.frombuffer(data, np.uint8, count=end - begin, offset=begin)
    lines = np.concatenate(([0], line_breaks(chars[:-1]) + 1))
    return int(np.count_nonzero(np.logical_or.reduceat(chars > ord(" "), lines)))


def _words(data: bytes, begin: int, end: int, columns: int, label: str, *, frame: int) -> tuple[IntArray, IntArray]:
    """Return the words of a block, after refusing what cannot be text or is one endless line."""
    chars = np.frombuffer(data, np.uint8, count=end - begin, offset=begin)
    # Control characters other than tab, line feed, vertical tab, form feed and carriage return.
    odd = (chars < 32) & (chars - np.uint8(9) > 4)
    if odd.any():
        at = begin + int(np.argmax(odd))
        what = "a NUL byte" if data[at] == 0 else f"control character 0x{data[at]:02x}"
        raise refusal(data, f"{what} among the values: not a text file", label=label, at=at)
    if len(chars) > 2 * BLOCK_BYTES:
        solid = chars > 32
        found = int(np.count_nonzero(solid[1:] & ~solid[:-1])) + int(solid[0])
        if found != columns:
            at = begin + int(np.argmax(solid))
            raise refusal(data, _wrong_count(frame, found, columns), label=label, at=at)
    return words_between(data, begin, end)


def _read_block(
    data: bytes,
    begin: int,
    end: int,
    words: tuple[IntArray, IntArray],
    out: FloatArray,
    label: str,
    *,
    frame: int,
    lenient: bool,
) -> _Block:
    starts, stops = words
    columns = out.shape[1]
    if len(starts) == 0:
        return _Block(starts, stops, 0)
    chars = np.frombuffer(data, np.uint8, count=end - begin, offset=begin)
    # Words before each line's end; the last line may have none.
    upto = np.append(np.searchsorted(starts, line_breaks(chars) + begin), len(starts))
    counts = np.diff(upto, prepend=0)
    counts = counts[counts > 0]
    decimals = parse_block(data, starts, stops, out=out.reshape(-1)[: len(starts)])
    faulty = decimals.index if isinstance(decimals, FaultyWord) else len(starts)
    whole = np.flatnonzero(counts != columns)
    rows = int(whole[0]) if len(whole) else len(counts)  # rows before the first of another length
    cut_off = None
    if rows < len(counts):
        first, found = rows * columns, int(counts[rows])
        at_end = rows == len(counts) - 1 and not data[int(stops[-1]) :].strip()
        # A file that was cut short may end inside a number.
        may_be_cut = at_end and _CUT_NUMBER.fullmatch(data, int(starts[-1]), int(stops[-1]))
        if faulty >= len(starts) - bool(may_be_cut) or faulty >= first + found:
            if not (lenient and at_end and found < columns):
                message = _wrong_count(frame + rows, found, columns)
                raise refusal(data, message, label=label, at=int(starts[first]))
            cut_off = int(starts[first])
            faulty = len(starts)
    if faulty < len(starts):
        word = data[starts[faulty] : stops[faulty]]
        message = f"frame {frame + _row_of(faulty, counts)}: {quoted(word)} is not a finite number"
        raise refusal(data, message, label=label, at=int(starts[faulty]))
    used = rows * columns
    return _Block(
        starts[:used:columns],
        stops[columns - 1 : used : columns],
        0 if isinstance(decimals, FaultyWord) else decimals,
        cut_off,
    )


def _row_of(word: int, counts: IntArray) -> int:
    return int(np.searchsorted(np.cumsum(counts), word, side="right"))


def _wrong_count(frame: int, found: int, columns: int) -> str:
    values = "1 value" if found == 1 else f"{found} values"
    channels = "1 channel" if columns == 1 else f"{columns} channels"
    return f"frame {frame} has {values}, the hierarchy has {channels}"
