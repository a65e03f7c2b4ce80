"""The pull back to the reference: the vector z of eq. (1), and its acceleration.

At the end of a solve the layers are met and only the pull is left. Each iteration shortens it by a factor that depends
on how the layers' solutions bend, and may even lengthen it, to and fro. Two pulls and the step between them show that
factor; the secant through them ends in one step what would take many.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.solver.constants import (
    LARGEST_FACTOR,
    LARGEST_TASK_SHARE,
    LARGEST_WAY_BACK,
    NO_CHANGE,
)
from motionedit.core.priorities.solver.layers import Descent, off_layers
from motionedit.core.priorities.solver.points import turn_to_local
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.solver.points import Columns
    from motionedit.core.priorities.solver.problem import Reference


def attraction(
    columns: Columns, reference: Reference, poses: WorldPoses, motion: Motion, frames: IntArray
) -> FloatArray:
    """Return z, shape (N, n): the increments that bring the column joints back to the reference.

    z = log(q_ref q^-1) per joint, as world-axis increments; and the way back of the root where the reference has one,
    or the first part of it.
    """
    targets = reference.rotations[frames[:, None], columns.joints]
    z = np.zeros((len(frames), columns.size))
    turns = turn_to_local(columns.skeleton, poses, motion.rotations, joints=columns.joints, targets=targets)
    z[:, :-3] = turns.reshape(len(frames), -1)
    if reference.root is not None and len(columns.skeleton.translated):
        root = columns.skeleton.translation_places[columns.root]
        back = reference.root[frames] - motion.translations[:, root]
        back *= LARGEST_WAY_BACK / np.maximum(rot.length(back), LARGEST_WAY_BACK)[:, None]
        above = int(columns.skeleton.parents[columns.root])
        z[:, -3:] = rot.rotate(poses.rotations[:, above], back) if above >= 0 else back
    return z


@dataclass(eq=False)
class Memory:
    """The iteration before, of N frames: its pulls (N, n), steps (N, n), lengths of task steps (N,), free unknowns."""

    homes: FloatArray
    steps: FloatArray
    tasks: FloatArray
    free: BoolArray

    @classmethod
    def empty(cls, frames: int, size: int) -> Memory:
        """Return the memory of no iteration: no unknown was free, so that none compares with it."""
        return cls(
            np.zeros((frames, size)), np.zeros((frames, size)), np.zeros(frames), np.zeros((frames, size), np.bool_)
        )

    def keep(self, frames: IntArray, descent: Descent, steps: FloatArray) -> None:
        """Remember an iteration of some frames and the steps (N, n) that were made."""
        self.homes[frames], self.steps[frames] = descent.home, steps
        self.tasks[frames], self.free[frames] = np.linalg.norm(descent.tasks, axis=1), descent.free


def accelerated(memory: Memory, frames: IntArray, descent: Descent) -> FloatArray:
    """Return the pull h, shape (N, n), after a secant step where it applies, else as it is.

    With h' and the step x' of the iteration before, y = h - h', and c = (h . y) / (y . y), which makes |h - c y| least:
    h - c P (x' + y), where P takes off what the layers see.
    """
    home = descent.home
    step, change = memory.steps[frames], home - memory.homes[frames]
    length, task = np.linalg.norm(home, axis=1), np.linalg.norm(descent.tasks, axis=1)
    size = np.sum(change * change, axis=1)
    usable = (memory.free[frames] == descent.free).all(axis=1) & (size > NO_CHANGE)
    usable &= memory.tasks[frames] < LARGEST_TASK_SHARE * np.linalg.norm(step, axis=1)
    usable &= task < LARGEST_TASK_SHARE * length
    if not usable.any():
        return home
    way = (step + change) * descent.free
    share = np.where(usable, np.sum(home * change, axis=1) / np.where(usable, size, 1.0), 0.0)
    fast = home - share[:, None] * off_layers(descent.Q, way)
    longest = LARGEST_FACTOR * length / np.maximum(np.linalg.norm(fast, axis=1), 1e-300)
    return np.where(usable[:, None], fast * np.minimum(1.0, longest)[:, None], home)
