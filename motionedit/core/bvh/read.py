"""Reading BVH clips: every row, in double precision, or a refusal with the file's line."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.header import Header, read_header
from motionedit.core.bvh.rows import Rows, read_rows, row_capacity, values_between
from motionedit.core.bvh.scan import refusal
from motionedit.core.motion import Motion, write_poses
from motionedit.dataclass import dataclass
from motionedit.errors import BvhError

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class BvhText:
    """A file's own bytes and where its header's numbers and its rows stand in them."""

    data: bytes
    header: Header
    rows: Rows


@dataclass(frozen=True, eq=False)
class Clip:
    """A BVH file that was read.

    Attributes
    ----------
    label : str
        The name that messages give it.
    motion : Motion
        Its F frames.
    text : BvhText
        The file's own bytes and their layout.
    warnings : tuple of str
        What leniency accepted, one line each.
    source : Path or None
        The file that it, or the clip that it was made from, was read from; None where there is none.
    """

    label: str
    motion: Motion
    text: BvhText
    warnings: tuple[str, ...] = ()
    source: Path | None = None

    def __repr__(self) -> str:
        # Not the bytes of the file and all its numbers, which would fill a screen.
        frames, joints = len(self.motion), len(self.motion.skeleton)
        return f"<Clip {self.label!r}: {frames} frames, {joints} joints, {self.motion.frame_rate:.4g} Hz>"

    @cached_property
    def values(self) -> FloatArray:
        """Channel values as in the file, degrees and clip units, shape (F, C).

        Read from the text when first asked for: a long clip that is only edited does not hold them.
        """
        return frozen(self.values_between(0, len(self.motion)))

    def values_between(self, start: int, stop: int) -> FloatArray:
        """Return the channel values of the frames from start up to stop, shape (stop - start, C)."""
        return values_between(self.text.data, self.text.rows, start, stop)

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the file's bytes, hexadecimal."""
        import hashlib

        return hashlib.sha256(self.text.data).hexdigest()


def read_clip(path: Path, *, label: str | None = None, lenient: bool = False) -> Clip:
    """Return the clip in a file.

    Parameters
    ----------
    path : Path
        The BVH file.
    label : str, optional
        The name in messages; the path if not given.
    lenient : bool
        Whether a row count other than `Frames:` says is accepted, with a warning; the whole rows are used.

    Raises
    ------
    BvhError
        Where the file cannot be opened or is not legal, with the line.
    """
    name = str(path) if label is None else label
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BvhError(f"cannot be read: {error.strerror or error}", file=name) from error
    return replace(parse_clip(data, label=name, lenient=lenient), source=path)


def parse_clip(data: bytes, *, label: str, lenient: bool = False) -> Clip:
    """Return the clip that a BVH file's bytes hold; see `read_clip`."""
    header = read_header(data, label=label)
    skeleton, start = header.skeleton, header.rows_start
    columns = skeleton.channel_count
    capacity = row_capacity(data, start, columns=columns, expected=header.frames, lenient=lenient)
    # Pages that are never written to cost no memory.
    rotations = np.empty((capacity, len(skeleton), 4))
    translations = np.empty((capacity, len(skeleton.translated), 3))

    def take(first: int, values: FloatArray) -> None:
        block = slice(first, first + len(values))
        write_poses(skeleton, values, rotations=rotations[block], translations=translations[block])

    rows = read_rows(data, start, columns=columns, expected=header.frames, label=label, lenient=lenient, take=take)
    warnings = _row_count_warnings(data, header, rows, label=label, lenient=lenient)
    frames = len(rows.starts)
    motion = Motion(skeleton, frozen(rotations[:frames]), frozen(translations[:frames]), header.frame_time)
    return Clip(label, motion, BvhText(data, header, rows), warnings)


def _row_count_warnings(data: bytes, header: Header, rows: Rows, *, label: str, lenient: bool) -> tuple[str, ...]:
    """Return the warnings for what --lenient accepts; refuse the rest."""
    place = header.frames_span[0]
    found = rows.found
    if found == 0 and (header.frames == 0 or lenient):
        raise refusal(data, "the file has no frames", label=label, at=place)
    warnings = []
    if rows.cut_off is not None:
        cut = refusal(data, "the last row is cut short and left out", label=label, at=rows.cut_off)
        warnings.append(str(cut))
    if found != header.frames:
        counted = "1 row" if found == 1 else f"{found} rows"
        message = f"Frames: says {header.frames}, the file has {counted}"
        if not lenient:
            raise refusal(data, f"{message}; --lenient uses the rows that are there", label=label, at=place)
        warnings.append(str(refusal(data, f"{message}, which are used", label=label, at=place)))
    return tuple(warnings)
