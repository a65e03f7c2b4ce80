"""A joint is turned as asked ([PRIO] section 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.kinds.effector import EffectorConstraint
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.rotations import rotation_targets
from motionedit.core.units import METRES_PER_RADIAN
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.priorities.kinds.constraint import Scene, Stage, Symbol
    from motionedit.core.priorities.solver.points import Point


@dataclass(frozen=True, eq=False, kw_only=True)
class Orientation(EffectorConstraint):
    """A joint is turned as its points say, in the world or in the measure's base."""

    type: ClassVar[str] = "orientation"
    turns: ClassVar[bool] = True
    shifts: ClassVar[bool] = False
    symbol: ClassVar[Symbol] = "arc"

    def targets(self, scene: Scene) -> Targets:
        """Return the turns, over the input's own."""
        return Targets(*self.active(len(scene.before.motion)), None, turned(self, scene))

    def task(self, targets: Targets, stage: Stage) -> OrientationTask:
        """Return the task of the joint."""
        return orientation_task(self, targets, stage)


def turned(constraint: EffectorConstraint, scene: Scene) -> FloatArray:
    """Return the rotations (n, 4) that a joint's points ask for, as they are measured."""
    turns = constraint.own_turns(scene)
    return rotation_targets(
        turns,
        constraint.points,
        ease_in=constraint.ease_in,
        ease_out=constraint.ease_out,
        since=constraint.since,
    )[1]


def orientation_task(constraint: EffectorConstraint, targets: Targets, stage: Stage) -> OrientationTask:
    """Return the task of a constraint's joint at the stage's frames."""
    point, base = stage.point(constraint.effector), stage.joint(constraint.measure.base)
    return OrientationTask(point, targets.rotations_at(stage.frames), base)


@dataclass(frozen=True, eq=False)
class OrientationTask:
    """A joint follows target rotations, quaternions (N, 4), in the world or in the frame of a base joint."""

    point: Point
    targets: FloatArray
    base: Point | None = None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = log(q_target q^-1) and d(increment)/d(unknowns), in metres, as `Task`."""
        del local
        q, J = self.point.rotation(poses), self.point.rotation_rows(poses)
        if self.base is not None:
            q_base = self.base.rotation(poses)
            inverse = np.swapaxes(rot.to_matrix(q_base), 1, 2)
            J = inverse @ (J - self.base.rotation_rows(poses))
            q = rot.between(q_base, q)
        e = rot.log(rot.multiply(self.targets[frames], rot.conjugate(q)))
        return METRES_PER_RADIAN * e, METRES_PER_RADIAN * J

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver."""
        return (CompiledTask("orientation", self.point.recruited, self.targets, self.point, self.base),)
