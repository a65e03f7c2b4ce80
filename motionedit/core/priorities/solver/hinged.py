"""Columns that turn about one axis or two, in numpy: what is along these of rows and steps, and their limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.solver.constants import LIMIT_ROUNDS, ON_LIMIT, SIDED_ROUNDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.priorities.solver.cones import Cones
    from motionedit.core.priorities.solver.layers import Descent
    from motionedit.core.priorities.solver.one_sided import Rows
    from motionedit.core.priorities.solver.problem import HingeColumns, Problem


class Hinges:
    """The hinges of N frames: world axes (N, H, 3), angles (N, H) in rad, their columns' unknowns `blocks` (H, 3).

    Unknowns are turns over their mobility. Of a column's three the first is the turn about its hinge's axis, the second
    about that of its second hinge, if any; the others stay 0. `turns` (H,) is the unknown that is each hinge's turn.
    """

    def __init__(self, problem: Problem, local: FloatArray, world: WorldPoses) -> None:
        hinges = problem.hinges
        joints = problem.columns.joints[hinges.places]
        parents = problem.columns.skeleton.parents[joints]
        inner = parents >= 0
        # A turn about an axis leaves it where the parent has it; the second of two is where the joint itself has it.
        self.axes = np.repeat(hinges.axes[None], len(local), axis=0)
        carriers = np.where(hinges.second, joints, parents)
        carried = inner | hinges.second
        self.axes[:, carried] = rot.rotate(world.rotations[:, carriers[carried]], self.axes[:, carried])
        self.angles = _angles(hinges, local[:, joints])
        self.limits = hinges.limits
        self.mobility = problem.mobility[hinges.places]
        self.places = hinges.places
        self.blocks = 3 * hinges.places[:, None] + np.arange(3)
        self.turns = 3 * hinges.places + hinges.second
        self.pairs = np.flatnonzero(hinges.second)

    def on_axes(self, J: FloatArray) -> FloatArray:
        """Return rows, shape (N, k, n), with what they have along each hinge's axis in its first unknown."""
        if not len(self.places):
            return J
        J = J.copy()
        along = np.einsum("nkhc,nhc->nkh", J[:, :, self.blocks], self.axes)
        J[:, :, self.blocks] = 0.0
        J[:, :, self.turns] = along
        return J

    def in_world(self, step: FloatArray) -> FloatArray:
        """Return a step, shape (N, n), with each hinge's turn as a world-axis increment."""
        if not len(self.places):
            return step
        turns = step[:, self.turns, None] * self.axes
        step = step.copy()
        step[:, self.blocks] = turns
        for second in self.pairs:
            # The first hinge turns what the second has turned: exactly so, or the joint would leave its two channels.
            both = rot.multiply(rot.exp(turns[:, second - 1]), rot.exp(turns[:, second]))
            step[:, self.blocks[second]] = rot.log(both)
        return step

    def out_of_limits(self, step: FloatArray, free: BoolArray) -> BoolArray:
        """Return which free hinges a step (N, n) would take beyond their limits, shape (N, H)."""
        after = self._after(step)
        out: BoolArray = (np.abs(after - self._limited(after)) > ON_LIMIT) & free[:, self.turns]
        return out

    def keep_limits(
        self,
        rows: Rows,
        cones: Cones | None,
        z: FloatArray,
        descent: Descent,
        down: Callable[..., Descent],
        gain: FloatArray,
    ) -> None:
        """Set hinges that would leave their limits on them, take them out of the system, and go `down` again.

        One-sided rows that would be violated are taken into the system, and joints set on limits that they would pass.
        """
        if not len(self.places) and not rows.any_one_sided and cones is None:
            return
        fixed, free = np.zeros_like(z), descent.free.copy()
        for left in reversed(range(SIDED_ROUNDS if rows.any_one_sided else LIMIT_ROUNDS)):
            step = descent.tasks + gain * descent.home
            out = self.out_of_limits(step, free)
            passed = False if cones is None else cones.set_on(step)
            again = np.flatnonzero(out.any(axis=1) | rows.take_in(step, left=left) | passed)
            if not len(again):
                break
            onto = (self._limited(self._after(step)) - self.angles) / self.mobility
            for h in np.flatnonzero(out.any(axis=0)):
                these = np.flatnonzero(out[:, h])
                fixed[these, self.turns[h]] = onto[these, h]
                free[these, self.turns[h]] = False
            onto_limits = 0.0 if cones is None else cones.onto()[again]
            limits = np.zeros((len(again), 0, z.shape[1])) if cones is None else cones.rows()[again]
            kept = fixed[again] + onto_limits
            new = down(again, rows.taking_part(again), z[again], fixed=kept, free=free[again], limits=limits)
            descent.replace_rows(again, new)

    def _after(self, step: FloatArray) -> FloatArray:
        after: FloatArray = self.angles + self.mobility * step[:, self.turns]
        return after

    def _limited(self, angles: FloatArray) -> FloatArray:
        limited: FloatArray = np.clip(angles, self.limits[:, 0], self.limits[:, 1])
        return limited


def _angles(hinges: HingeColumns, rotations: FloatArray) -> FloatArray:
    """Return the hinges' angles in rad, shape (N, H), from their joints' local rotations (N, H, 4)."""
    upper, lower = (np.broadcast_to(each, (*rotations.shape[:2], 3)).copy() for each in (hinges.upper, hinges.lower))
    first, second = ~hinges.second, hinges.second
    lower[:, first] = rot.rotate(rotations[:, first], lower[:, first])
    upper[:, second] = rot.unrotate(rotations[:, second], upper[:, second])
    along = np.sum(hinges.axes * upper, axis=2) * np.sum(hinges.axes * lower, axis=2)
    sine = np.sum(hinges.axes * rot.cross(upper, lower), axis=2)
    angles: FloatArray = np.arctan2(sine, np.sum(upper * lower, axis=2) - along)
    return angles
