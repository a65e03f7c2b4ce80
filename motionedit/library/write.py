"""`motionedit.write`: a clip into a file."""

from __future__ import annotations

from pathlib import Path

from motionedit.core.bvh import Clip
from motionedit.errors import UsageError
from motionedit.library.outputs import file_for, text_of, write_files
from motionedit.library.paths import AnyPath


def write(clip: Clip, path: AnyPath) -> Path:
    """Write a clip, whole or not at all, and return the file.

    Parameters
    ----------
    clip : Clip
        Its motion is what is written, wherever its text has another one (see `Clip.with_motion`).
    path : str or path-like
        A name ending in ``.bvh`` is that file; anything else is a folder, for a file of the clip's own name. Folders on
        the way are made; a file that exists is replaced.

    Raises
    ------
    MotionEditError
        The file is the one that the clip, or the clip that it was made from, was read from; or it cannot be written.

    Examples
    --------
    >>> clip = motionedit.read("data/walk.bvh")
    >>> path = motionedit.write(clip, "copies")
    """
    if not isinstance(clip, Clip):
        own = "; it has a method write" if hasattr(clip, "write") else ""
        raise UsageError(f"must be a Clip, not a value of type {type(clip).__name__}{own}")
    target = file_for(clip, path)
    write_files({target: text_of(clip)}, inputs=[] if clip.source is None else [clip.source])
    return target
