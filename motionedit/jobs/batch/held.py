"""Clips that a process holds from one phase of a run to the next: one that has the same clip again reads it once."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask


class _Held(threading.local):
    """Clips without their rows, by their labels, and how many bytes their motions are: each thread's own."""

    def __init__(self) -> None:
        self.clips: dict[str, Clip] = {}
        self.bytes = 0


_HELD = _Held()


def hold(task: ClipTask, clip: Clip, *, most: int) -> None:
    """Hold what `other_rows_pieces` needs of a clip that was read, if all that is held is no more than `most` bytes."""
    motion = clip.motion
    size = _HELD.bytes + motion.rotations.nbytes + motion.translations.nbytes
    if task.clip is None and task.source is not None and size <= most:
        _HELD.bytes = size
        _HELD.clips[task.label] = clip.without_rows()


def with_held(task: ClipTask) -> ClipTask:
    """Return a task with its clip, which is held no more, if it was."""
    clip = _HELD.clips.pop(task.label, None)
    return task if clip is None else replace(task, clip=clip)


def let_go() -> None:
    """Hold no clips: the next run reads its own."""
    _HELD.clips.clear()
    _HELD.bytes = 0
