"""How far joints turn from one frame to the next: in a motion, and in the change that an edit made of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion

# Steps are told as they would be at this rate, Hz.
STEP_RATE = 60.0
# What is this small is rounding, degrees: nothing stepped.
_NOTHING = 1e-6
_BLOCK_POSES = 1 << 13


@dataclass(frozen=True, eq=False)
class Steps:
    """Each joint's largest turn from one frame to the next.

    Attributes
    ----------
    degrees : shape (J,)
        In a sixtieth of a second: a step at another rate is scaled to it.
    frames : shape (J,)
        The frame into which the joint steps.
    """

    degrees: FloatArray
    frames: IntArray

    @property
    def joint(self) -> int | None:
        """The joint with the largest step; None where nothing steps."""
        worst = int(np.argmax(self.degrees))
        return worst if self.degrees[worst] > _NOTHING else None


def own_steps(motion: Motion, *, first: int) -> Steps:
    """Return the largest steps of a motion's local rotations; a rest pose before `first` is left out."""
    if compiled() is not None:
        return _steps_at_once(None, motion, first)
    joints = np.arange(len(motion.skeleton))
    return _steps(joints, lambda some: motion.rotations[first:, some], motion, first)


def change_steps(before: Motion, after: Motion, *, first: int) -> Steps:
    """Return the largest steps of input^-1 * output of the local rotations.

    Both motions have the same frames of the same skeleton. Where both hold a rotation by the same numbers nothing
    steps, to the bit.
    """
    if compiled() is not None:
        return _steps_at_once(before, after, first)
    one, other = before.rotations[first:], after.rotations[first:]
    differ = np.zeros(one.shape[1:], dtype=np.bool_)
    # A few frames at a time: of a long motion all at once would take as much memory as its rotations have numbers.
    together = max(_BLOCK_POSES // len(before.skeleton), 1)
    for start in range(0, len(one), together):
        differ |= (one[start : start + together] != other[start : start + together]).any(axis=0)
    changed = np.flatnonzero(differ.any(axis=1))

    def changes(some: IntArray) -> FloatArray:
        return rot.between(one[:, some], other[:, some])

    return _steps(changed, changes, before, first)


def _steps_at_once(before: Motion | None, after: Motion, first: int) -> Steps:
    """Return the steps of all joints in one compiled loop: of a motion's own rotations, or of what changed them."""
    joints = len(after.skeleton)
    angles, frames = np.empty(joints), np.empty(joints, dtype=np.int64)
    turns = [None if each is None else np.ascontiguousarray(each.rotations) for each in (before, after)]
    compiled().steps(*turns, len(after), joints, first, angles, frames)
    degrees = np.degrees(angles) / (after.frame_time * STEP_RATE)
    return Steps(frozen(degrees), frozen(frames.astype(np.intp, copy=False)))


def _steps(joints: IntArray, turns: Callable[[IntArray], FloatArray], motion: Motion, first: int) -> Steps:
    """Return the steps of joints whose rotations are `turns` (F, n, 4) of so many of them; the others do not turn."""
    count, length = len(motion.skeleton), len(motion) - first
    degrees, worst = np.zeros(count), np.zeros(count, dtype=np.intp)
    # A few joints at a time: those of a long motion all at once would take several times its memory.
    together = max(_BLOCK_POSES // max(length, 1), 1)
    for start in range(0, len(joints) if length > 1 else 0, together):
        some = joints[start : start + together]
        q = turns(some)
        steps = rot.angle_between(q[:-1], q[1:])
        worst[some] = steps.argmax(axis=0)
        degrees[some] = np.degrees(steps.max(axis=0)) / (motion.frame_time * STEP_RATE)
    return Steps(frozen(degrees), frozen(first + worst + 1))
