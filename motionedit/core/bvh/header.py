"""What stands above the rows of a BVH file: the HIERARCHY, and the two lines under MOTION."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from motionedit.core.bvh.hierarchy import read_hierarchy
from motionedit.core.bvh.scan import number, quoted, text_of
from motionedit.core.bvh.words import Words, is_count, shown
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.skeleton import Skeleton

_FRAMES = re.compile(rb"\s*(Frames[ \t]*:)[ \t]*([^\r\n]*)", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*(Frame[ \t]*Time[ \t]*:)[ \t]*([^\r\n]*)", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Header:
    """What stands above the rows.

    `frames_span` and `frame_time_span` are the (start, stop) bytes of the two numbers; `rows_start` is the byte
    where the line of the frame time ends.
    """

    skeleton: Skeleton
    frames: int
    frame_time: float
    frames_span: tuple[int, int]
    frame_time_span: tuple[int, int]
    rows_start: int


def read_header(data: bytes, *, label: str) -> Header:
    """Return the header of a BVH file; `BvhError` with the line where it is not legal."""
    words = Words(data, label)
    skeleton = read_hierarchy(words)
    counted, frames_at = _value_of(words, _FRAMES, "Frames:")
    if not counted:
        words.refuse("Frames: has no count", frames_at)
    if not is_count(counted):
        words.refuse(f"Frames: {quoted(counted)} is not a count of frames", frames_at)
    timed, time_at = _value_of(words, _FRAME_TIME, "Frame Time:")
    if not timed:
        words.refuse("Frame Time: has no number", time_at)
    frame_time = number(timed)
    if frame_time is None:
        words.refuse(f"Frame Time: {quoted(timed)} is not a number", time_at)
    if frame_time <= 0.0:
        words.refuse(f"Frame Time: {text_of(timed)} is not positive", time_at)
    return Header(
        skeleton=skeleton,
        frames=int(counted),
        frame_time=frame_time,
        frames_span=(frames_at, frames_at + len(counted)),
        frame_time_span=(time_at, time_at + len(timed)),
        rows_start=words.at,
    )


def _value_of(words: Words, pattern: re.Pattern[bytes], key: str) -> tuple[bytes, int]:
    match = pattern.match(words.data, words.at)
    if match is None:
        word, at = words.word()
        words.refuse(f"expected '{key}' in the MOTION part, found {shown(word)}", at)
    words.at = match.end()
    return match.group(2).rstrip(), match.start(2)
