"""What the functions of the face take for clips: files, folders, clips in memory, edited clips."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePath

from motionedit.core.bvh import Clip
from motionedit.dataclass import replace
from motionedit.errors import UsageError
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import ClipTask, find_clips
from motionedit.library.edited import Edited
from motionedit.library.paths import AnyPath, path_of

AnyClip = AnyPath | Clip | Edited
AnyClips = AnyClip | Iterable[AnyClip]

_CLIP = "a clip, as a path, a Clip or an Edited"


def clip_task(clip: AnyClip, *, lenient: bool) -> tuple[Clip, ClipTask]:
    """Return one clip, read if it is a file, and its task.

    Raises
    ------
    UsageError
        It is no clip, or a folder.
    BvhError, ClipError
        It cannot be read; or its motion is another one than its file's, and cannot be written into it.
    """
    if isinstance(clip, (Clip, Edited)):
        task = _in_memory(clip)
    else:
        path = _path_of(clip)
        if path.is_dir():
            raise UsageError("is a folder; an edit takes one clip", file=str(path))
        (task,) = _found(path)
    read = read_task(task, lenient=lenient)
    return read, replace(task, clip=read)


def clip_tasks(clips: AnyClips) -> list[ClipTask]:
    """Return the tasks of clips; folders stand for the clips below them, as on the command line.

    Raises
    ------
    UsageError
        There is no clip; something given does not exist; two clips have one name.
    """
    if isinstance(clips, (str, os.PathLike, Clip, Edited)):
        several: list[AnyClip] = [clips]
    elif isinstance(clips, Iterable):
        several = list(clips)
    else:
        raise UsageError(f"must be clips or folders, not a value of type {type(clips).__name__}")
    tasks: list[ClipTask] = []
    for clip in several:
        tasks += [_in_memory(clip)] if isinstance(clip, (Clip, Edited)) else _found(_path_of(clip))
    if not tasks:
        raise UsageError("no clip is given")
    _refuse_shared_names(tasks)
    return tasks


def _path_of(clip: AnyPath) -> Path:
    if hasattr(clip, "clip"):
        # The mean of a model, or the first of several clips: not what is meant by the whole.
        kind = type(clip).__name__
        raise UsageError(f"must be {_CLIP}, not a value of type {kind}; give one of its clips, such as its .clip")
    return path_of(clip, wanted=_CLIP)


def _found(path: Path) -> list[ClipTask]:
    """Return the tasks of a file or folder, whose paths hold after the working folder has changed."""
    return [replace(task, source=task.source and task.source.absolute()) for task in find_clips([path])]


def _in_memory(clip: Clip | Edited) -> ClipTask:
    """Return the task of a clip in memory, which is called by its name, as one that is given as a file.

    Where its motion is not that of its text, the motion is what is meant.
    """
    given = clip.clip if isinstance(clip, Edited) else clip
    meant = given.with_motion(given.motion)
    source = meant.source and meant.source.absolute()
    return ClipTask(source, meant.label, None, PurePath(meant.label).name, clip=meant)


def _refuse_shared_names(tasks: list[ClipTask]) -> None:
    first: dict[str, ClipTask] = {}
    for task in tasks:
        other = first.setdefault(task.relative, task)
        if other is task:
            continue
        remedy = "give the folder that both are below"
        if task.clip is not None or other.clip is not None:
            remedy = "give one another label, such as dataclasses.replace(clip, label='other.bvh')"
        raise UsageError(f"{other.label} and {task.label} would both be called {task.relative}; {remedy}")
