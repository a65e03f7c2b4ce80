"""Writing BVH clips: new numbers spliced into the file's own bytes, or whole new rows under its own header."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.bvh.format import format_fixed, place
from motionedit.core.bvh.rows import BLOCK_BYTES
from motionedit.core.bvh.scan import words_between
from motionedit.core.euler import angle_track, joint_angles, runs
from motionedit.core.motion import position_columns, rotation_columns
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.bvh.read import Clip
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

FEWEST_DECIMALS = 6
# A double below 10 carries no more.
MOST_DECIMALS = 17
# Blanks between two values that are copied column by column; wider gaps are rare and copied one by one.
_WIDE_GAP = 16


def unedited_bytes(clip: Clip) -> bytes:
    """Return the file's own bytes."""
    return clip.text.data


def edited_bytes(clip: Clip, motion: Motion, *, touched: BoolArray, moved: BoolArray | None = None) -> bytes:
    """Return the clip's bytes with the values that an edit touched replaced, and all other bytes kept.

    Parameters
    ----------
    motion : Motion
        The edited motion, as many frames as the clip.
    touched : shape (F, J)
        Where a joint's rotation channels are rewritten.
    moved : shape (F, P), optional
        Where the position channels of the joints `skeleton.translated` are rewritten; nowhere if not given.

    Raises
    ------
    BvhError
        Where a value to be written is not finite.
    """
    edit = _edit(clip, motion, touched, moved)
    if not edit.cells.any():
        return clip.text.data
    _check_finite(clip, edit.values, edit.cells)
    # A stream grows in place, where joining pieces would hold the file twice.
    stream = BytesIO()
    stream.write(_head(clip, frames=len(clip.values)))
    _splice_rows(stream, clip, edit)
    return stream.getvalue()


def resampled_bytes(clip: Clip, motion: Motion) -> bytes:
    """Return a file of the clip's own header with the rows of another motion of its skeleton.

    `Frames:` and `Frame Time:` are put right; rows use the file's line ending and one blank between values.
    """
    values = joint_angles(motion, start=clip.values[0])
    _check_finite(clip, values)
    data, header = clip.text.data, clip.text.header
    head = _head(clip, frames=len(values), frame_time=motion.frame_time)
    ending = _line_ending(data, header.rows_start)
    return head + ending + _rows_text(values, decimals=_decimals(clip), ending=ending)


def new_bytes(motion: Motion, *, decimals: int = FEWEST_DECIMALS) -> bytes:
    """Return a motion as a fresh BVH file: tabs, LF, a fixed number of decimals."""
    skeleton = motion.skeleton
    values = joint_angles(motion, start=np.zeros(skeleton.channel_count))
    if not np.isfinite(values).all():
        message = "a motion with values that are not finite cannot be written"
        raise BvhError(message)
    lines = [*hierarchy_lines(skeleton, decimals), "MOTION", f"Frames: {len(values)}"]
    lines.append(f"Frame Time: {plain_number(motion.frame_time)}")
    head = "".join(f"{line}\n" for line in lines).encode()
    return head + _rows_text(values, decimals=decimals, ending=b"\n")


def plain_number(value: float) -> str:
    """Return the shortest text that reads back as the same double, without an exponent."""
    return np.format_float_positional(value, trim="0")


def _decimals(clip: Clip) -> int:
    return min(max(clip.text.rows.decimals, FEWEST_DECIMALS), MOST_DECIMALS)


@dataclass(frozen=True, eq=False)
class _Edit:
    """What an edit rewrites: `columns` (K,) of the rows, their `values` (F, K), and which `cells` (F, K) of them."""

    columns: IntArray
    values: FloatArray
    cells: BoolArray


def _edit(clip: Clip, motion: Motion, touched: BoolArray, moved: BoolArray | None) -> _Edit:
    """Return the new values of the columns that an edit touches; the other columns cost no memory."""
    skeleton = clip.motion.skeleton
    masks: dict[int, BoolArray] = {}
    tracks: dict[int, FloatArray] = {}
    for joint in np.flatnonzero(touched.any(axis=0)).tolist():
        columns = rotation_columns(skeleton, [joint])[0]
        if columns:
            angles = angle_track(motion, joint, given=clip.values[:, columns], touched=touched[:, joint])
            for column, track in zip(columns, angles.T, strict=True):
                masks[column], tracks[column] = touched[:, joint], track
    for p, joint in enumerate(skeleton.translated.tolist()):
        if moved is not None and moved[:, p].any():
            for axis, column in position_columns(skeleton, joint):
                masks[column], tracks[column] = moved[:, p], motion.translations[:, p, axis]
    columns = sorted(masks)
    values = np.empty((len(clip.values), len(columns)))
    cells = np.empty((len(clip.values), len(columns)), dtype=np.bool_)
    for k, column in enumerate(columns):
        values[:, k], cells[:, k] = tracks.pop(column), masks[column]
    return _Edit(np.array(columns, dtype=np.intp), values, cells)


def _check_finite(clip: Clip, values: FloatArray, cells: BoolArray | None = None) -> None:
    bad = ~np.isfinite(values)
    if cells is not None:
        bad &= cells
    if bad.any():
        frame = int(np.argmax(bad.any(axis=1)))
        message = f"the edit gives values at frame {frame} that are not finite; nothing is written"
        raise BvhError(message, file=clip.label)


def _head(clip: Clip, *, frames: int, frame_time: float | None = None) -> bytes:
    """Return the bytes above the rows, with the frame count, and the frame time if given, put right."""
    data, header = clip.text.data, clip.text.header
    start, stop = header.frames_span
    count = data[start:stop] if frames == header.frames else str(frames).encode()
    time_start, time_stop = header.frame_time_span
    time = data[time_start:time_stop]
    if frame_time is not None and frame_time != header.frame_time:
        time = plain_number(frame_time).encode()
    return data[:start] + count + data[stop:time_start] + time + data[time_stop : header.rows_start]


def _splice_rows(stream: BytesIO, clip: Clip, edit: _Edit) -> None:
    """Write everything from the rows on, with the new text of the touched values in place of the old."""
    data, rows = memoryview(clip.text.data), clip.text.rows
    at = clip.text.header.rows_start
    decimals = _decimals(clip)
    row_bytes = (len(data) - at) // len(rows.starts) + 1
    for first, last in runs(np.asarray(edit.cells.any(axis=1))):
        step = max(BLOCK_BYTES // row_bytes, 1)
        for start in range(first, last, step):
            stop = min(start + step, last)
            begin, end = int(rows.starts[start]), int(rows.stops[stop - 1])
            stream.write(data[at:begin])
            stream.write(_spliced(clip, edit, slice(start, stop), decimals=decimals).data)
            at = end
    if rows.cut_off is None:
        stream.write(data[at:])
    else:
        # What is left of a row that was cut short would make the file unreadable.
        stream.write(clip.text.data[at : rows.cut_off].rstrip(b" \t"))


def _spliced(clip: Clip, edit: _Edit, rows: slice, *, decimals: int) -> NDArray[np.uint8]:
    """Return the text of some rows, from the first value to the last, with the touched values replaced."""
    data, layout = clip.text.data, clip.text.rows
    begin, end = int(layout.starts[rows.start]), int(layout.stops[rows.stop - 1])
    columns = clip.values.shape[1]
    starts, stops = words_between(data, begin, end)
    word = (np.arange(rows.stop - rows.start)[:, None] * columns + edit.columns).reshape(-1)
    values, cells = edit.values[rows].reshape(-1), edit.cells[rows].reshape(-1)
    if not cells.all():
        word, values = word[cells], values[cells]
    new = format_fixed(values, decimals=decimals)
    lengths = stops - starts
    if len(word) == len(starts):
        words, shifted = new.chars, np.cumsum(new.lengths - lengths)
    else:
        width = max(-(-int(lengths.max()) // 8) * 8, new.chars.shape[1])
        words = _windows(data, stops, width)
        words[word, width - new.chars.shape[1] :] = new.chars
        growth = np.zeros(len(starts), np.intp)
        growth[word] = new.lengths - lengths[word]
        shifted = np.cumsum(growth)
    starts -= begin
    stops -= begin
    shifted += stops
    margin = words.shape[1]
    text = np.empty(margin + int(shifted[-1]), np.uint8)
    place(words, shifted, out=text, margin=margin)
    old = np.frombuffer(data, np.uint8, count=end - begin, offset=begin)
    _copy_gaps(old, starts, stops, text[margin:], shifted)
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


def _rows_text(values: FloatArray, *, decimals: int, ending: bytes) -> bytes:
    """Return rows of values with a blank between two and the line ending after each."""
    ends = np.full(values.shape[1], ord(" "), np.uint8)
    ends[-1] = ord("\n")
    step = max(BLOCK_BYTES // (10 * values.shape[1]), 1)
    stream = BytesIO()
    for start in range(0, len(values), step):
        block = values[start : start + step]
        words = format_fixed(block.reshape(-1), decimals=decimals, ends=np.tile(ends, len(block)))
        margin = words.chars.shape[1]
        stops = np.cumsum(words.lengths)
        text = np.empty(margin + int(stops[-1]), np.uint8)
        place(words.chars, stops, out=text, margin=margin)
        text = text[margin:]
        stream.write(text.data if ending == b"\n" else text.tobytes().replace(b"\n", ending))
    return stream.getvalue()


def _line_ending(data: bytes, at: int) -> bytes:
    """Return the line ending at byte `at`, LF at the end of the file."""
    if data[at : at + 2] == b"\r\n":
        return b"\r\n"
    return data[at : at + 1] if data[at : at + 1] == b"\r" else b"\n"


def hierarchy_lines(skeleton: Skeleton, decimals: int) -> list[str]:
    """Return the lines of HIERARCHY, each joint's End Sites before its children."""
    lines = ["HIERARCHY"]
    sites: dict[int, list[FloatArray]] = {}
    for site in skeleton.end_sites:
        sites.setdefault(site.joint, []).append(site.offset)
    depth = np.zeros(len(skeleton), dtype=np.intp)
    for joint, name in enumerate(skeleton.names):
        parent = int(skeleton.parents[joint])
        depth[joint] = 0 if parent < 0 else depth[parent] + 1
        tabs = "\t" * int(depth[joint])
        channels = skeleton.channels[joint]
        lines += [
            f"{tabs}{'ROOT' if parent < 0 else 'JOINT'} {name}",
            f"{tabs}{{",
            f"{tabs}\t{_offset_line(skeleton.offsets[joint], decimals)}",
            f"{tabs}\t" + " ".join(("CHANNELS", str(len(channels)), *channels)),
        ]
        for offset in sites.get(joint, []):
            lines += [f"{tabs}\tEnd Site", f"{tabs}\t{{"]
            lines += [f"{tabs}\t\t{_offset_line(offset, decimals)}", f"{tabs}\t}}"]
        following = int(depth[skeleton.parents[joint + 1]]) + 1 if joint + 1 < len(skeleton) else 0
        lines += ["\t" * level + "}" for level in range(int(depth[joint]), following - 1, -1)]
    return lines


def _offset_line(offset: FloatArray, decimals: int) -> str:
    return "OFFSET " + " ".join(f"{value + 0.0:.{decimals}f}" for value in offset.tolist())
