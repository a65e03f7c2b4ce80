"""`motionedit.read`: a clip out of a file."""

from __future__ import annotations

from motionedit.core.bvh import Clip, read_clip
from motionedit.library.file_errors import file_errors
from motionedit.library.options import switch
from motionedit.library.paths import AnyPath, path_of


@file_errors()
def read(path: AnyPath, *, lenient: bool = False) -> Clip:
    """Return the clip in a BVH file.

    Parameters
    ----------
    path : str or path-like
        The file.
    lenient : bool
        Whether a row count other than `Frames:` says is accepted: the whole rows are used, and `clip.warnings` says so.

    Returns
    -------
    Clip
        `clip.motion` has `rotations`, unit quaternions w, x, y, z, shape (F, J, 4), `translations` in clip units,
        `frame_time` in seconds and `skeleton` (names, parents, offsets); `clip.values` are the numbers of the file,
        degrees and clip units, shape (F, C). All arrays are read-only: `clip.with_motion` makes a clip of others, and
        `motionedit.write` a file of it.

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
    file = path_of(path)
    # Its source holds after the working folder has changed: nothing is written over it.
    return read_clip(file.absolute(), label=str(file), lenient=switch(lenient, "lenient"))
