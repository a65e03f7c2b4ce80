"""A point follows a trajectory: a shape constraint S(T(t)) ([PRIO] section 4.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.measure import WORLD, Measure, relative_rows
from motionedit.core.priorities.kinds.effector import EffectorConstraint
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.positions import position_targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.solver.points import Point


@dataclass(frozen=True, eq=False, kw_only=True)
class Position(EffectorConstraint):
    """An effector is where its points say, as far as the counted axes go."""

    type: ClassVar[str] = "position"
    places_effector: ClassVar[bool] = True
    averages: ClassVar[bool] = True

    def targets(self, scene: Scene) -> Targets:
        """Return the trajectory, over the input's own."""
        return Targets(*self.active(len(scene.before.motion)), placed(self, scene))

    def task(self, targets: Targets, stage: Stage) -> PositionTask:
        """Return the task of the point."""
        return position_task(self, targets, stage)


def placed(constraint: EffectorConstraint, scene: Scene) -> FloatArray:
    """Return the positions (n, 3) that an effector's points ask for, as they are measured."""
    if not constraint.points:
        return constraint.path(scene)
    return position_targets(
        constraint.path(scene),
        constraint.points,
        ease_in=constraint.ease_in,
        ease_out=constraint.ease_out,
        since=constraint.since,
        curve=scene.curve,
    )[1]


def position_task(constraint: EffectorConstraint, targets: Targets, stage: Stage) -> PositionTask:
    """Return the task of a constraint's point at the stage's frames."""
    point, base = stage.point(constraint.effector), stage.joint(constraint.measure.base)
    return PositionTask(point, targets.positions_at(stage.frames), constraint.measure, base)


@dataclass(frozen=True, eq=False)
class PositionTask:
    """A point follows targets (N, 3) as `measure` has them; `base` is the measure's, as the unknowns move it."""

    point: Point
    targets: FloatArray
    measure: Measure = WORLD
    base: Point | None = None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = target - x and dx/d(unknowns), as `Task`."""
        del local
        x, J = self.point.position(poses), self.point.position_rows(poses)
        if self.base is not None:
            between = x - self.base.position(poses)
            inverse = np.swapaxes(rot.to_matrix(self.base.rotation(poses)), 1, 2)
            x = (inverse @ between[..., None])[..., 0]
            J = relative_rows(inverse, between, J, self.base.position_rows(poses), self.base.rotation_rows(poses))
        rows = self.measure.rows
        return self.targets[frames][:, list(self.measure.counted)] - x @ rows.T, rows @ J

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver."""
        point = self.point
        return (CompiledTask("position", point.recruited, self.targets, point, self.base, measure=self.measure),)
