"""What the functions of the face take: clips, specs and folders in their several forms."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePath
from typing import Any

from motionedit.core.bvh import Clip
from motionedit.errors import UsageError
from motionedit.jobs.batch.plan import ClipTask, RunOptions, find_clips

AnyPath = str | os.PathLike[str]
AnySpec = AnyPath | Mapping[str, Any]
AnyClip = AnyPath | Clip

_CLIP = "a clip, as a path or a Clip"


def path_of(path: AnyPath, *, wanted: str = "a path") -> Path:
    """Return a path; ``-``, which is a stream on the command line, is refused, and so is what is no path.

    Raises
    ------
    UsageError
        It is neither; `wanted` says in the message what would be right.
    """
    name = os.fspath(path) if isinstance(path, (str, os.PathLike)) else None
    if not isinstance(name, str):
        raise UsageError(f"must be {wanted}, not a value of type {type(path).__name__}")
    if name in ("", "-") or "\0" in name:
        raise UsageError(f"{name!r} is no file; give a path")
    return Path(name)


def events_of(events: Mapping[str, int] | None) -> Mapping[str, int]:
    """Return frames of events as `load_spec` takes them.

    Raises
    ------
    UsageError
        They are no mapping of names.
    """
    if events is None:
        return {}
    if not isinstance(events, Mapping) or not all(isinstance(name, str) for name in events):
        raise UsageError("events must be a mapping of names to frames, such as {'hit': 94}")
    return events


def spec_of(spec: AnySpec) -> Path | Mapping[str, Any]:
    """Return a spec as `load_spec` takes it."""
    return spec if isinstance(spec, Mapping) else path_of(spec, wanted="a spec, as a path or a mapping")


def task_of(clip: AnyClip) -> ClipTask:
    """Return the task of one clip."""
    if isinstance(clip, Clip):
        # A clip in memory is called by its name, as one that is given as a file.
        return ClipTask(clip.source, clip.label, None, PurePath(clip.label).name, clip=clip)
    path = path_of(clip, wanted=_CLIP)
    if path.is_dir():
        raise UsageError("is a folder; an edit takes one clip", file=str(path))
    (task,) = find_clips([path])
    return task


def tasks_of(clips: AnyClip | Iterable[AnyClip]) -> list[ClipTask]:
    """Return the tasks of clips; folders stand for the clips below them, as on the command line.

    Raises
    ------
    UsageError
        There is no clip; something given does not exist; two clips in memory have one label.
    """
    if isinstance(clips, (str, os.PathLike, Clip)):
        several = [clips]
    elif isinstance(clips, Iterable):
        several = list(clips)
    else:
        raise UsageError(f"must be clips or folders, not a value of type {type(clips).__name__}")
    tasks: list[ClipTask] = []
    for clip in several:
        tasks += [task_of(clip)] if isinstance(clip, Clip) else find_clips([path_of(clip, wanted=_CLIP)])
    if not tasks:
        raise UsageError("no clip is given")
    names = [task.relative for task in tasks]
    for i, name in enumerate(names):
        if name in names[:i]:
            first = tasks[names.index(name)].label
            raise UsageError(f"{first} and {tasks[i].label} would both be called {name}; give each its own label")
    return tasks


def options_of(*, jobs: int = 1, lenient: bool = False) -> RunOptions:
    """Return how a run goes about its clips: all or none, and what is no user's error is raised as it is.

    Raises
    ------
    UsageError
        A negative number of workers.
    """
    if jobs < 0:
        raise UsageError(f"{jobs} workers; give 1 or more, or 0 for all cores")
    return RunOptions(jobs=jobs, lenient=lenient, keep_going=False, verbosity=2)
