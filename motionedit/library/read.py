"""`motionedit.read`: a clip out of a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.bvh import read_clip
from motionedit.library.file_errors import file_errors
from motionedit.library.inputs import path_of

if TYPE_CHECKING:
    from motionedit.core.bvh import Clip
    from motionedit.library.inputs import AnyPath


@file_errors()
def read(path: AnyPath, *, lenient: bool = False) -> Clip:
    """Return the clip in a BVH file.

    Parameters
    ----------
    path : path-like
        The file.
    lenient : bool
        Whether a row count other than `Frames:` says is accepted: the whole rows are used, and `clip.warnings` says so.

    Returns
    -------
    Clip
        `clip.motion` has `rotations`, unit quaternions w, x, y, z, shape (F, J, 4), `translations` in clip units,
        `frame_time` in seconds and `skeleton` (names, parents, offsets); `clip.values` are the numbers of the file,
        degrees and clip units, shape (F, C). All arrays are read-only.

    Raises
    ------
    MotionEditError
        The file cannot be read or is not legal, with the line.

    Examples
    --------
    >>> clip = motionedit.read("data/walk.bvh")
    >>> clip.motion.rotations.shape
    (145, 31, 4)
    """
    return read_clip(path_of(path, wanted="a path"), lenient=lenient)
