"""Reading BVH clips: every row, in double precision, or a refusal with the file's line."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.bvh.file_bytes import FileBytes
from motionedit.core.bvh.header import read_header
from motionedit.core.bvh.rows import read_rows, row_capacity
from motionedit.core.bvh.scan import LARGEST_LENGTH, refusal
from motionedit.core.bvh.text import BvhText
from motionedit.core.compiled import room
from motionedit.core.motion import Motion, write_poses
from motionedit.dataclass import dataclass, replace
from motionedit.errors import BvhError
from motionedit.regular_files import NotAFileError, read_file

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from motionedit.core.bvh.header import Header
    from motionedit.core.bvh.rows import Rows

# Values, of which so many are kept: to read them again would take as long as to read the clip.
_FEW_VALUES = 1 << 17


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
        The file's own bytes and their layout. It belongs to `motion`: `dataclasses.replace` with another motion would
        leave the old one in it, `with_motion` does not.
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
        return frozen(self.text.values_between(0, len(self.text.rows.starts)))

    def with_motion(self, motion: Motion) -> Clip:
        """Return the clip with another motion in its file, of any number of frames and any frame time.

        What differs from the file's own numbers is written anew, to as many decimals as the file has and at least six;
        all other bytes stay. The new clip has the motion as its file has it, and the label and source of this one. It
        is this one where nothing differs. Rotations need not be of unit length.

        Raises
        ------
        ClipError
            The motion has another skeleton than the file, or arrays of other shapes; or it turns or moves a joint that
            has no channels for it.
        BvhError
            A value is not finite.

        Examples
        --------
        >>> from dataclasses import replace
        >>> import numpy as np
        >>> clip = motionedit.read("data/walk.bvh")
        >>> places = clip.motion.translations + np.array([0.0, 10.0, 0.0])
        >>> higher = clip.with_motion(replace(clip.motion, translations=places))
        >>> float(higher.values[0, 1] - clip.values[0, 1])
        10.0
        """
        text = self.text
        if motion is text.motion and motion.is_fixed:
            return self if motion is self.motion else replace(self, motion=motion)
        # Imported here: who only reads needs no writer.
        from motionedit.core.bvh.other_motion import bytes_with_motion

        own = text.motion if text.motion.is_fixed else self._read_again(text.data).motion
        data = bytes_with_motion(self, motion, own=own)
        if data is text.data:
            return self if motion is self.motion else replace(self, motion=own)
        return self._read_again(data)

    def _read_again(self, data: bytes) -> Clip:
        """Return the clip of other bytes; lenient, as the input may have been."""
        return parse_clip(data, label=self.label, lenient=True, source=self.source)

    def without_rows(self) -> Clip:
        """Return the clip with nothing of its file but what stands above the rows, and its first values.

        So much is what `other_rows_pieces` needs of it; it takes a third of the memory.
        """
        text, above = self.text, self.text.header.rows_start + len(b"\r\n")
        first = frozen(text.values_between(0, 1).copy())
        return replace(self, text=replace(text, file=FileBytes(text.data[:above]), values=first))

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
        data = read_file(path, room=room)
    except NotAFileError as error:
        raise BvhError(f"{error.strerror}; a pipe is given as '-'", file=name) from error
    except OSError as error:
        raise BvhError(f"cannot be read: {error.strerror or error}", file=name) from error
    return parse_clip(data, label=name, lenient=lenient, source=path)


def parse_clip(data: bytes, *, label: str, lenient: bool = False, source: Path | None = None) -> Clip:
    """Return the clip that a BVH file's bytes hold, and the file they are from, if any; see `read_clip`."""
    header = read_header(data, label=label)
    skeleton, start = header.skeleton, header.rows_start
    columns = skeleton.channel_count
    capacity = row_capacity(data, start, columns=columns, expected=header.frames, lenient=lenient)
    # Pages that are never written to cost no memory.
    rotations = np.empty((capacity, len(skeleton), 4))
    translations = np.empty((capacity, len(skeleton.translated), 3))

    kept = np.empty((capacity, columns)) if capacity * columns <= _FEW_VALUES else None

    def take(first: int, values: FloatArray) -> None:
        block = slice(first, first + len(values))
        if kept is not None and values.base is not kept:
            kept[block] = values
        write_poses(skeleton, values, rotations=rotations[block], translations=translations[block])

    rows = read_rows(
        data, start, columns=columns, expected=header.frames, label=label, lenient=lenient, take=take, room=kept
    )
    warnings = _row_count_warnings(data, header, rows, label=label, lenient=lenient)
    frames = len(rows.starts)
    _refuse_far_places(data, rows, translations[:frames], label=label)
    motion = Motion(skeleton, frozen(rotations[:frames]), frozen(translations[:frames]), header.frame_time)
    text = BvhText(FileBytes(data), header, rows, motion, None if kept is None else frozen(kept[:frames]))
    return Clip(label, motion, text, warnings, source)


def _refuse_far_places(data: bytes, rows: Rows, translations: FloatArray, *, label: str) -> None:
    """Refuse a position that is beyond any length, with its line."""
    if max(translations.max(initial=0.0), -translations.min(initial=0.0)) <= LARGEST_LENGTH:
        return
    sizes = np.abs(translations).max(axis=(1, 2))
    frame = int(np.argmax(sizes > LARGEST_LENGTH))
    message = f"frame {frame} has a position of {sizes[frame]:.3g}, which is beyond any length"
    raise refusal(data, message, label=label, at=int(rows.starts[frame]))


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
