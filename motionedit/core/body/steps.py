"""How far joints turn from one frame to the next: in a motion, and in the change that an edit made of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion

# Steps are told as they would be at this rate, Hz.
STEP_RATE = 60.0
# What is this small is rounding, degrees: nothing stepped.
_NOTHING = 1e-6


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
    return _steps((motion.rotations[first:, j] for j in range(len(motion.skeleton))), motion.frame_time, first)


def change_steps(before: Motion, after: Motion, *, first: int) -> Steps:
    """Return the largest steps of input^-1 * output of the local rotations.

    Both motions have the same frames of the same skeleton. Where both hold a rotation by the same numbers nothing
    steps, to the bit.
    """
    one, other = before.rotations[first:], after.rotations[first:]
    changes = (
        None if np.array_equal(one[:, j], other[:, j]) else rot.multiply(rot.conjugate(one[:, j]), other[:, j])
        for j in range(len(before.skeleton))
    )
    return _steps(changes, before.frame_time, first)


def _steps(turns: Iterable[FloatArray | None], frame_time: float, first: int) -> Steps:
    """Return the steps of joint after joint, shape (F, 4) each, None for one that does not turn."""
    degrees, frames = [], []
    for q in turns:
        steps = np.zeros(0) if q is None else rot.angle_between(q[:-1], q[1:])
        worst = int(np.argmax(steps)) if len(steps) else 0
        degrees.append(float(np.degrees(steps[worst])) / (frame_time * STEP_RATE) if len(steps) else 0.0)
        frames.append(first + worst + 1)
    return Steps(frozen(np.array(degrees)), frozen(np.array(frames, dtype=np.intp)))
