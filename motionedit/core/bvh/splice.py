"""Writing an edit: new numbers spliced into the file's own bytes, everything else kept."""

from __future__ import annotations

from functools import lru_cache
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen, runs
from motionedit.core.bvh.format import format_fixed, place
from motionedit.core.bvh.rows import BLOCK_BYTES
from motionedit.core.bvh.scan import words_between
from motionedit.core.bvh.short_edit import short_edit
from motionedit.core.bvh.write import LONGEST_WHOLE, check_finite, decimals_of_edits, head_bytes, joined, rows_text
from motionedit.core.compiled import compiled
from motionedit.core.euler_pieces import piece_angles, touched_angles, touched_pieces
from motionedit.core.motion import position_columns
from motionedit.core.skeleton import slice_or_all
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.bvh.text import Written
    from motionedit.core.euler_pieces import Piece
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# Rows of a long clip that are solved and held at a time; of a shorter one all angles are held, and so many of its rows
# laid out at a time, near the processor.
SEGMENT, _ROWS = 1 << 14, 1 << 10
# Blanks between two values that are copied column by column; wider gaps are rare and copied one by one.
_WIDE_GAP = 16


def edited_bytes(clip: Written, motion: Motion, *, touched: BoolArray, moved: BoolArray | None = None) -> bytes:
    """Return the clip's bytes with the values that an edit touched replaced, and all other bytes kept.

    Parameters
    ----------
    motion : Motion
        The edited motion, as many frames as the clip; its frame time is written where it is another one.
    touched : shape (F, J)
        Where a joint's rotation channels are rewritten.
    moved : shape (F, P), optional
        Where the position channels of the joints `skeleton.translated` are rewritten; nowhere if not given.

    Raises
    ------
    BvhError
        Where a value to be written is not finite.
    """
    pieces = edited_pieces(clip, motion, touched=touched, moved=moved)
    first = next(pieces)
    return clip.text.data if first is clip.text.data else joined(chain((first,), pieces), about=len(clip.text.file))


def edited_pieces(
    clip: Written, motion: Motion, *, touched: BoolArray, moved: BoolArray | None = None
) -> Iterator[bytes | memoryview]:
    """Yield what `edited_bytes` returns, piece by piece: a long file need not be held to be written."""
    positions = _moved_columns(motion, moved)
    is_short = len(clip.text.file) <= BLOCK_BYTES and len(motion) <= SEGMENT
    short = short_edit(clip, motion, touched, moved, positions) if is_short else None
    if short is not None:
        yield head_bytes(clip, frames=len(motion), frame_time=motion.frame_time)
        yield from clip.text.file.pieces(clip.text.header.rows_start, short.start)
        yield short.text
        yield from _tail(clip, short.stop)
        return
    plan = _plan(clip, motion, touched, positions)
    if len(plan.columns) == 0 and motion.frame_time == clip.text.header.frame_time:
        yield clip.text.data
        return
    yield head_bytes(clip, frames=len(motion), frame_time=motion.frame_time)
    at = clip.text.header.rows_start
    step = _ROWS if len(motion) <= SEGMENT else SEGMENT
    for start in range(0, len(motion), step):
        edit = _edit(plan, motion, touched, moved, slice(start, min(start + step, len(motion))))
        check_finite(clip, edit.values, edit.cells, first=start)
        at = yield from _spliced_rows(clip, edit, start, at)
    yield from _tail(clip, at)


@dataclass(frozen=True, eq=False)
class _Plan:
    """Which `columns` (K,) an edit touches, their `joints` (K,), and their `values` (F, K), or a long clip's pieces.

    `positions` are the `_moved_columns` among them.
    """

    columns: IntArray
    joints: IntArray
    positions: list[tuple[int, int, int]]
    values: FloatArray | None
    pieces: dict[int, list[Piece]]


@dataclass(frozen=True, eq=False)
class _Edit:
    """What is rewritten in a segment of n rows: the `columns` (K,), their `values` (n, K), and which `cells` (n, K)."""

    columns: IntArray
    values: FloatArray
    cells: BoolArray


def _plan(clip: Written, motion: Motion, touched: BoolArray, positions: list[tuple[int, int, int]]) -> _Plan:
    skeleton, given = clip.text.motion.skeleton, clip.text.values_between
    is_touched = touched.any(axis=0).tobytes()
    every, joints, places = _columns_of(skeleton, is_touched, tuple(column for _, _, column in positions))
    if len(motion) > SEGMENT:
        return _Plan(every, joints, positions, None, touched_pieces(motion, touched, given=given, size=SEGMENT))
    values = np.empty((len(motion), len(every)))
    touched_angles(motion, touched, given=given, columns=places, out=values)
    for p, axis, column in positions:
        values[:, places[column]] = motion.translations[:, p, axis]
    return _Plan(every, joints, positions, values, {})


@lru_cache(maxsize=8)
def _columns_of(
    skeleton: Skeleton, is_touched: bytes, positions: tuple[int, ...]
) -> tuple[IntArray, IntArray, IntArray]:
    """Return the columns of touched joints' rotations and of positions, growing, their joints, and each's place there.

    The clips of a folder that share a skeleton are mostly touched alike.
    """
    touched = np.flatnonzero(np.frombuffer(is_touched, dtype=np.bool_)).tolist()
    columns = sorted({column for joint in touched for column in skeleton.columns(joint, "rotation")} | {*positions})
    every = np.array(columns, dtype=np.intp)
    places = np.zeros(skeleton.channel_count, dtype=np.intp)
    places[every] = np.arange(len(every))
    return frozen(every), frozen(np.searchsorted(skeleton.channel_starts, every, side="right") - 1), frozen(places)


def _moved_columns(motion: Motion, moved: BoolArray | None) -> list[tuple[int, int, int]]:
    """Return the place of each joint that is moved anywhere, an axis along which it is, and the column of that."""
    if moved is None:
        return []
    skeleton, joints = motion.skeleton, motion.skeleton.translated.tolist()
    return [
        (p, axis, column)
        for p, joint in enumerate(joints)
        if moved[:, p].any()
        for axis, column in position_columns(skeleton, joint)
    ]


def _edit(plan: _Plan, motion: Motion, touched: BoolArray, moved: BoolArray | None, rows: slice) -> _Edit:
    """Return the new values of a segment of rows; the columns that nothing touches take no memory."""
    if plan.values is not None:
        values = plan.values[rows]
    else:
        skeleton, place = motion.skeleton, {column: k for k, column in enumerate(plan.columns.tolist())}
        values = np.empty((rows.stop - rows.start, len(place)))
        for joint, pieces in plan.pieces.items():
            columns = [place[column] for column in skeleton.columns(joint, "rotation")]
            for piece in pieces:
                first, last = max(piece.start, rows.start), min(piece.stop, rows.stop)
                if first < last:
                    angles = piece_angles(motion, joint, piece=piece)[first - piece.start : last - piece.start]
                    for column, angle in zip(columns, angles.T, strict=True):
                        values[first - rows.start : last - rows.start, column] = angle
        for p, axis, column in plan.positions:
            values[:, place[column]] = motion.translations[rows, p, axis]
    cells = touched[rows].take(plan.joints, axis=1)
    if moved is not None:
        for p, _, column in plan.positions:
            cells[:, np.searchsorted(plan.columns, column)] = moved[rows, p]
    return _Edit(plan.columns, values, cells)


def _spliced_rows(clip: Written, edit: _Edit, first: int, at: int) -> Generator[bytes | memoryview, None, int]:
    """Yield a segment of rows from frame `first` on, with the new text of the touched values in place of the old.

    What stands from byte `at` up to the last touched row is yielded; the byte after it is returned.
    """
    file, rows = clip.text.file, clip.text.rows
    decimals = decimals_of_edits(clip)
    step = max(BLOCK_BYTES * len(rows.starts) // len(file), 1)
    for start, last in runs(np.asarray(edit.cells.any(axis=1))):
        for block in range(start, last + 1, step):
            chosen = slice(block, min(block + step, last + 1))
            begin, end = int(rows.starts[first + block]), int(rows.stops[first + chosen.stop - 1])
            yield from file.pieces(at, begin)
            old = file.between(begin, end)
            if edit.cells[chosen].all() and _is_plain(clip, old, edit.columns, chosen.stop - block):
                yield rows_text(edit.values[chosen], decimals=decimals, ending=b"\n")[:-1]
                at = end
                continue
            cells, values = edit.cells[chosen].reshape(-1), edit.values[chosen].reshape(-1)
            yield _spliced(clip, old, edit.columns, values, cells, decimals=decimals).data
            at = end
    return at


def _is_plain(clip: Written, old: bytes | memoryview, columns: IntArray, count: int) -> bool:
    """Return whether so many whole rows are written, and nothing stands in the `old` between values but blanks and LF.

    Such rows need no splicing: all their bytes are new. N values have N - 1 gaps, so as many blanks leave no room for
    a second one anywhere.
    """
    width = clip.text.motion.skeleton.channel_count
    if len(columns) < width:
        return False
    kernel = compiled()
    if kernel is not None:
        return bool(kernel.plain_gaps(old, count * width - 1))
    text = bytes(old)
    if any(blank in text for blank in (b"\t", b"\r", b"\v", b"\f")):
        return False
    # All at once: where each value has one, numpy is quicker than `count`.
    blanks = np.count_nonzero(np.frombuffer(text, np.uint8) <= ord(" "))
    return bool(blanks == count * width - 1)


def _tail(clip: Written, at: int) -> Iterator[bytes | memoryview]:
    file, cut_off = clip.text.file, clip.text.rows.cut_off
    if cut_off is None:
        return file.pieces(at, len(file))
    # What is left of a row that was cut short would make the file unreadable.
    return iter([bytes(file.between(at, cut_off)).rstrip(b" \t")])


def _spliced(
    clip: Written,
    old: bytes | memoryview,
    columns: IntArray,
    values: FloatArray,
    cells: BoolArray,
    *,
    decimals: int,
) -> NDArray[np.uint8]:
    """Return the text of rows, given the `old`, with the touched cells of some columns replaced."""
    width = clip.text.motion.skeleton.channel_count
    kernel = compiled()
    if kernel is not None:
        every = np.zeros((len(values) // len(columns), width), dtype=np.bool_)
        given, own = np.empty(every.shape), slice_or_all(columns)
        every[:, own], given[:, own] = cells.reshape(-1, len(columns)), values.reshape(-1, len(columns))
        text = np.empty(len(old) + every.size * (decimals + LONGEST_WHOLE), np.uint8)
        length = kernel.splice(old, every, given, decimals, text)
        if length >= 0:
            return text[:length]
    data = bytes(old)
    starts, stops = words_between(data, 0, len(data))
    word = (np.arange(0, len(starts), width)[:, None] + columns).reshape(-1)
    if not cells.all():
        word, values = word[cells], values[cells]
    new = format_fixed(values, decimals=decimals)
    lengths = stops - starts
    if len(word) == len(starts):
        words, shifted = new.chars, np.cumsum(new.lengths - lengths)
    else:
        wide = max(-(-int(lengths.max()) // 8) * 8, new.chars.shape[1])
        words = _windows(data, stops, wide)
        words[word, wide - new.chars.shape[1] :] = new.chars
        growth = np.zeros(len(starts), np.intp)
        growth[word] = new.lengths - lengths[word]
        shifted = np.cumsum(growth)
    shifted += stops
    margin = words.shape[1]
    text = np.empty(margin + int(shifted[-1]), np.uint8)
    place(words, shifted, out=text, margin=margin)
    _copy_gaps(np.frombuffer(data, np.uint8), starts, stops, text[margin:], shifted)
    return text[margin:]


def _copy_gaps(
    old: NDArray[np.uint8], starts: IntArray, stops: IntArray, new: NDArray[np.uint8], shifted: IntArray
) -> None:
    """Copy what stands between the words of `old`, from starts to stops, to between those of `new`."""
    gaps = starts[1:] - stops[:-1]
    new[shifted[:-1]] = old[stops[:-1]]
    for blank in range(1, min(int(gaps.max(initial=0)), _WIDE_GAP)):
        wide = np.flatnonzero(gaps > blank)
        new[shifted[wide] + blank] = old[stops[wide] + blank]
    for i in np.flatnonzero(gaps > _WIDE_GAP).tolist():
        new[shifted[i] : shifted[i] + gaps[i]] = old[stops[i] : starts[i + 1]]


def _windows(data: bytes, stops: IntArray, width: int) -> NDArray[np.uint8]:
    """Return the `width` bytes before each stop, shape (N, width)."""
    if stops[0] < width:
        data, stops = bytes(width) + data[: int(stops[-1])], stops + width
    windows = np.ndarray((len(data) - width + 1,), f"V{width}", buffer=data, strides=(1,))
    return windows[stops - width].view(np.uint8).reshape(-1, width)
