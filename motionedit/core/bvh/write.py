"""Writing BVH clips whole: the file's own bytes, new rows under its own header, or a fresh file."""

from __future__ import annotations

from io import BytesIO
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.bvh.format import format_fixed, place
from motionedit.core.bvh.rows import BLOCK_BYTES
from motionedit.core.compiled import compiled, room
from motionedit.core.euler import joint_angles
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.bvh.text import Written
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

FEWEST_DECIMALS = 6
# The characters of a number but its decimals: a sign, 16 digits, a point, and the blank after it.
LONGEST_WHOLE = 19
# A double below 10 carries no more.
MOST_DECIMALS = 17
# Of a file whose length is foretold, so much is left free, one part of so many.
_SPARE = 32


def unedited_bytes(clip: Written) -> bytes:
    """Return the file's own bytes."""
    return clip.text.data


def resampled_bytes(clip: Written, motion: Motion) -> bytes:
    """Return a file of the clip's own header with the rows of another motion of its skeleton.

    `Frames:` and `Frame Time:` are put right; rows use the file's line ending and one blank between values. `BvhError`
    where a value is not finite.
    """
    values = joint_angles(motion, start=clip.text.values_between(0, 1)[0])
    return _whole(other_rows_pieces(clip, values, frame_time=motion.frame_time), values)


def other_rows_pieces(clip: Written, values: FloatArray, *, frame_time: float) -> Iterator[bytes | memoryview]:
    """Yield what `resampled_bytes` returns, piece by piece, given its channel values (F, C).

    The first piece is what stands above the rows.
    """
    check_finite(clip, values)
    ending = _line_ending(clip.text.data, clip.text.header.rows_start)
    yield head_bytes(clip, frames=len(values), frame_time=frame_time) + ending
    yield from rows_pieces(values, decimals=decimals_of_edits(clip), ending=ending)


def new_bytes(motion: Motion, *, decimals: int = FEWEST_DECIMALS) -> bytes:
    """Return a motion as a fresh BVH file: tabs, LF, a fixed number of decimals.

    `BvhError` where a value is not finite.
    """
    skeleton = motion.skeleton
    values = joint_angles(motion, start=np.zeros(skeleton.channel_count))
    if not np.isfinite(values).all():
        message = "a motion with values that are not finite cannot be written"
        raise BvhError(message)
    lines = [*hierarchy_lines(skeleton, decimals), "MOTION", f"Frames: {len(values)}"]
    lines.append(f"Frame Time: {plain_number(motion.frame_time)}")
    head = "".join(f"{line}\n" for line in lines).encode()
    return _whole(chain((head,), rows_pieces(values, decimals=decimals, ending=b"\n")), values)


def plain_number(value: float) -> str:
    """Return the shortest text that reads back as the same double, without an exponent."""
    return np.format_float_positional(value, trim="0")


def decimals_of_edits(clip: Written) -> int:
    """Return how many decimals new values get: the most among the clip's own, within limits."""
    return min(max(clip.text.rows.decimals, FEWEST_DECIMALS), MOST_DECIMALS)


def check_finite(clip: Written, values: FloatArray, cells: BoolArray | None = None, *, first: int = 0) -> None:
    """Raise `BvhError` where a value of the chosen cells, or of all, is not finite; row 0 is frame `first`."""
    good = np.isfinite(values)
    if cells is not None:
        good |= ~cells
    if not good.all():
        frame = first + int(np.argmin(good.all(axis=1)))
        message = f"the edit gives values at frame {frame} that are not finite; nothing is written"
        raise BvhError(message, file=clip.label)


def head_bytes(clip: Written, *, frames: int, frame_time: float | None = None) -> bytes:
    """Return the bytes above the rows, with the frame count, and the frame time if given, put right."""
    header = clip.text.header
    data, (start, stop) = bytes(clip.text.file.between(0, header.rows_start)), header.frames_span
    count = data[start:stop] if frames == header.frames else str(frames).encode()
    time_start, time_stop = header.frame_time_span
    time = data[time_start:time_stop]
    if frame_time is not None and frame_time != header.frame_time:
        time = plain_number(frame_time).encode()
    return data[:start] + count + data[stop:time_start] + time + data[time_stop : header.rows_start]


def joined(pieces: Iterable[bytes | memoryview], *, about: int) -> bytes:
    """Return pieces in one.

    Joining them would hold the file twice, and a stream that grows may be copied again and again: so it has room for
    about so many bytes from the start.
    """
    stream = BytesIO(room(about + about // _SPARE))
    stream.writelines(pieces)
    stream.truncate()
    return stream.getvalue()


def _whole(pieces: Iterator[bytes | memoryview], values: FloatArray) -> bytes:
    """Return a head and rows of values below it, as `rows_pieces` has them, in one."""
    head, first = next(pieces), next(pieces, b"")
    return joined(chain((head, first), pieces), about=len(head) + len(first) * -(-len(values) // _rows_at_once(values)))


def rows_pieces(values: FloatArray, *, decimals: int, ending: bytes) -> Iterator[bytes | memoryview]:
    """Yield the text of rows of values, with a blank between two and the line ending after each, block by block."""
    step = _rows_at_once(values)
    for start in range(0, len(values), step):
        yield rows_text(values[start : start + step], decimals=decimals, ending=ending)


def _rows_at_once(values: FloatArray) -> int:
    # A value that moves takes about ten characters.
    return max(BLOCK_BYTES // (10 * int(values.shape[1])), 1)


def rows_text(values: FloatArray, *, decimals: int, ending: bytes) -> memoryview:
    """Return the text of a block of rows, as `rows_pieces` does."""
    kernel = compiled()
    if kernel is not None:
        text = np.empty(values.size * (decimals + LONGEST_WHOLE) + len(values) * len(ending), np.uint8)
        length = kernel.rows_to_text(np.ascontiguousarray(values), values.shape[1], decimals, ending, text)
        if length >= 0:
            return text.data[:length]
    ends = np.full(values.shape[1], ord(" "), np.uint8)
    ends[-1] = ord("\n")
    words = format_fixed(values.reshape(-1), decimals=decimals, ends=np.tile(ends, len(values)))
    margin = words.chars.shape[1]
    stops = np.cumsum(words.lengths)
    text = np.empty(margin + int(stops[-1]), np.uint8)
    place(words.chars, stops, out=text, margin=margin)
    text = text[margin:]
    return text.data if ending == b"\n" else memoryview(text.tobytes().replace(b"\n", ending))


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
