"""The rows of a BVH file's MOTION part: read block by block, strictly, with the line of every fault."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.parse import FaultyWord, parse_block
from motionedit.core.bvh.scan import line_blocks, line_breaks, quoted, refusal, words_between
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.bvh.file_bytes import FileBytes

    TakeRows = Callable[[int, FloatArray], None]

# A block and its arrays stay in the processor's cache.
BLOCK_BYTES = 1 << 18
_CTRL_Z = b"\x1a"
_BLANK = b" \t\n\r\v\f" + _CTRL_Z
_CUT_NUMBER = re.compile(rb"[+-]?[0-9]*\.?[0-9]*(?:[eE][+-]?)?[0-9]*")


@dataclass(frozen=True, eq=False)
class Rows:
    """Where the rows of a file stand.

    Attributes
    ----------
    starts, stops : shape (F,)
        First byte of each row's first value, and the byte after its last.
    decimals : int
        The largest number of decimals among the values.
    cut_off : int or None
        The byte where a last row begins that was cut short and left out (lenient only).
    found : int
        Rows in the file, the one that was cut short left out. More than F where a strict reading found too many and
        only counted the rest.
    """

    starts: IntArray
    stops: IntArray
    decimals: int
    cut_off: int | None
    found: int


@dataclass(frozen=True)
class _Block:
    starts: IntArray
    stops: IntArray
    decimals: int
    cut_off: int | None = None


def row_capacity(data: bytes, start: int, *, columns: int, expected: int, lenient: bool) -> int:
    """Return how many rows to set memory aside for: as many as declared, or as the file can hold."""
    # A value and its blank take two bytes.
    most = (len(data) - start + 1) // 2 // columns + 1
    return most if lenient else min(most, expected)


def read_rows(
    data: bytes,
    start: int,
    *,
    columns: int,
    expected: int,
    label: str,
    lenient: bool,
    take: TakeRows,
    room: FloatArray | None = None,
) -> Rows:
    """Read the rows from byte `start` on and return where they stand.

    Parameters
    ----------
    columns : int
        C, the number of channels.
    expected : int
        Frames that the file declares.
    lenient : bool
        Whether a last row with too few values is left out instead of refused, and more rows than declared are read.
    take : callable
        Is given each block's first frame and values, shape (n, C), which are overwritten afterwards.
    room : shape (capacity, C), optional
        Where the values of a file of one block are put, if they are all that is in it; they stay there.

    Raises
    ------
    BvhError
        With the line, where a value is no finite number or a row has not C values.
    """
    scratch = np.empty((0, columns))
    starts, stops = [np.zeros(0, np.intp)], [np.zeros(0, np.intp)]
    count = surplus = decimals = 0
    cut_off = None
    for begin, end in line_blocks(data, start, size=BLOCK_BYTES):
        if not lenient and count > expected:
            surplus += _rows_within(data, begin, end)
            continue
        block = None if room is None or end - begin < len(data) - start else _whole_rows(data, begin, end, room)
        if room is not None and block is not None:
            scratch = room
        else:
            # A value and its blank take two bytes.
            most = (end - begin + 1) // 2 // columns + 1
            scratch = scratch if len(scratch) >= most else np.empty((most, columns))
            block = _whole_rows(data, begin, end, scratch)
        if block is None:
            words = _words(data, begin, end, columns, label, frame=count)
            block = _read_block(data, begin, end, words, scratch, label, frame=count, lenient=lenient)
        rows = len(block.starts)
        take(count, scratch[: rows if lenient else max(min(rows, expected - count), 0)])
        # Copies, for a slice would keep the places of all values.
        starts.append(block.starts.copy())
        stops.append(block.stops.copy())
        count += rows
        decimals = max(decimals, block.decimals)
        cut_off = block.cut_off
    return Rows(frozen(np.concatenate(starts)), frozen(np.concatenate(stops)), decimals, cut_off, count + surplus)


def values_between(file: FileBytes, rows: Rows, start: int, stop: int, *, columns: int) -> FloatArray:
    """Return the values of rows that were read, from frame start up to stop, shape (stop - start, C = columns)."""
    blocks = []
    step = max(BLOCK_BYTES * len(rows.starts) // len(file), 1)
    for first in range(start, stop, step):
        last = min(first + step, stop)
        text = file.between(int(rows.starts[first]), int(rows.stops[last - 1]))
        values = np.empty((last - first, columns))
        if _whole_rows(text, 0, len(text), values) is None:
            data = bytes(text)
            parse_block(data, *words_between(data, 0, len(data)), out=values.reshape(-1))
        blocks.append(values)
    return np.concatenate(blocks)


def _whole_rows(data: bytes | memoryview, begin: int, end: int, out: FloatArray) -> _Block | None:
    """Read whole rows into `out`, shape (room, C); None where other things stand there, and without a compiler."""
    kernel = compiled()
    if kernel is None:
        return None
    starts, stops = np.empty((2, len(out)), np.int64)
    found = kernel.rows_from_text(memoryview(data)[begin:end], out.shape[1], out, starts, stops)
    if found is None:
        return None
    count, decimals = found
    starts, stops = starts[:count], stops[:count]
    starts += begin
    stops += begin
    return _Block(starts, stops, decimals)


def _ends_text(data: bytes, at: int) -> bool:
    """Tell whether a byte is the Ctrl-Z with which old programs end a text: nothing but blanks follows it."""
    return data[at : at + 1] == _CTRL_Z and not data[at + 1 :].strip(_BLANK)


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
    at = begin + int(np.argmax(odd))
    if odd.any() and not _ends_text(data, at):
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
        at_end = rows == len(counts) - 1 and not data[int(stops[-1]) :].strip(_BLANK)
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
