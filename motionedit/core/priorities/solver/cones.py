"""Limits of joints that turn about any axis: inequalities above all layers, in effect where a step would pass them.

A frame is solved without them first. Where the solution is beyond a limit, the frame is solved on, and in each
iteration the limits that the step would pass become equalities: the joint turns onto the limit, no further that way.

With bone b and centre c in the world, a turn w of the joint changes its swing by n . w, n = c x b / |c x b|, and its
twist by (b + c) . w / (1 + b . c). The two are orthogonal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.limits import swing_and_twist
from motionedit.core.priorities.solver.constants import BEYOND_LIMIT, NO_DIRECTION, ON_LIMIT

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.priorities.solver.problem import LimitColumns, Problem


class Cones:
    """The limits of N frames, two a joint: swings, then twists, L in all.

    `active` (N, L) tells which the step is set on.
    """

    def __init__(self, problem: Problem, local: FloatArray, world: WorldPoses) -> None:
        limits, columns = problem.limits, problem.columns
        joints = columns.joints[limits.places]
        self._size = columns.size
        self._mobility = np.tile(problem.mobility[limits.places], 2)
        self._places = np.tile(limits.places, 2)
        self._limits = np.concatenate((limits.swing, limits.twist))
        parents = columns.skeleton.parents[joints]
        above = np.where((parents >= 0)[:, None], world.rotations[:, parents], rot.IDENTITY)
        along = np.broadcast_to(limits.along, (len(local), *limits.along.shape))
        bone = rot.rotate(world.rotations[:, joints], along)
        center = rot.rotate(rot.multiply(above, limits.centers), along)
        across = rot.cross(center, bone)
        length = np.linalg.norm(across, axis=2, keepdims=True)
        # A bone in the middle swings anywhere; one straight behind twists about nothing.
        swings = np.where(length > NO_DIRECTION, across / np.maximum(length, NO_DIRECTION), 0.0)
        half = np.maximum(np.linalg.norm(bone + center, axis=2, keepdims=True), NO_DIRECTION)
        self._turns = np.concatenate((swings, (bone + center) / half), axis=1)
        # |b + c| / 2 is the cosine of half the swing.
        self._rates = np.concatenate((np.ones_like(length), 2.0 / half), axis=1)[..., 0]
        self.values = _values(limits, local[:, joints])
        self.active = np.zeros(self.values.shape, dtype=np.bool_)
        self._wanted = np.zeros(self.values.shape)

    def beyond(self, step: FloatArray) -> FloatArray:
        """Return by how much a step (N, n) takes joints beyond limits that it is not set on, rad, shape (N, L)."""
        over = np.abs(self._after(step)) - self._limits
        return np.where(self.active | (over <= ON_LIMIT), 0.0, over)

    def set_on(self, step: FloatArray) -> BoolArray:
        """Set the limits that a step (N, n) passes, and return in which frames there are any, shape (N,)."""
        new = self.beyond(step) > 0.0
        self._wanted = np.where(new, np.copysign(self._limits, self._after(step)), self._wanted)
        self.active |= new
        found: BoolArray = np.any(new, axis=1)
        return found

    def rows(self) -> FloatArray:
        """Return the active limits as orthonormal rows over the unknowns, shape (N, L, n); others are rows of zeros."""
        rows = np.zeros((*self.active.shape, self._size))
        for k, place in enumerate(self._places):
            rows[:, k, 3 * place : 3 * place + 3] = self._turns[:, k] * self.active[:, k, None]
        return rows

    def onto(self) -> FloatArray:
        """Return the step (N, n) that sets joints on their active limits."""
        turns = np.where(self.active, (self._wanted - self.values) / (self._rates * self._mobility), 0.0)
        return (turns[:, None] @ self.rows())[:, 0]

    def _after(self, step: FloatArray) -> FloatArray:
        """Return where a step (N, n) takes swings and twists, shape (N, L)."""
        turns = step[:, :-3].reshape(len(step), -1, 3)[:, self._places]
        after: FloatArray = self.values + self._rates * self._mobility * np.sum(turns * self._turns, axis=2)
        return after


def are_beyond(limits: LimitColumns, local: FloatArray) -> BoolArray:
    """Return in which frames any limit is passed, shape (N,), from the joints' local rotations (N, C, 4)."""
    beyond: BoolArray = np.any(
        np.abs(_values(limits, local)) > np.concatenate((limits.swing, limits.twist)) + BEYOND_LIMIT, axis=1
    )
    return beyond


def _values(limits: LimitColumns, local: FloatArray) -> FloatArray:
    """Return the swings and the twists of joints, shape (N, 2 C), rad."""
    q = rot.between(limits.centers, local)
    swing, twist = swing_and_twist(q, limits.along)
    return np.concatenate((swing, twist), axis=1)
