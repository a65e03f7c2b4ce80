"""Position and orientation of one joint together: a footplant that cannot roll."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core.priorities.kinds.effector import EffectorConstraint
from motionedit.core.priorities.kinds.orientation import OrientationTask, orientation_task, turned
from motionedit.core.priorities.kinds.position import PositionTask, placed, position_task
from motionedit.core.priorities.task_targets import Targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.solver.problem import CompiledTask


@dataclass(frozen=True, eq=False, kw_only=True)
class Pose(EffectorConstraint):
    """An effector is where its points say, and its joint turned as they say."""

    type: ClassVar[str] = "pose"
    turns: ClassVar[bool] = True
    places_effector: ClassVar[bool] = True

    def targets(self, scene: Scene) -> Targets:
        """Return trajectory and turns, over the input's own."""
        return Targets(*self.active(len(scene.before.motion)), placed(self, scene), turned(self, scene))

    def task(self, targets: Targets, stage: Stage) -> PoseTask:
        """Return the task of the point and its joint."""
        return PoseTask(position_task(self, targets, stage), orientation_task(self, targets, stage))


@dataclass(frozen=True, eq=False)
class PoseTask:
    """The rows of a position, then those of an orientation; one radian weighs as `METRES_PER_RADIAN`."""

    position: PositionTask
    orientation: OrientationTask

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the rows of both, as `Task`."""
        parts = [task.evaluate(poses, local, frames) for task in (self.position, self.orientation)]
        return np.concatenate([e for e, _ in parts], axis=1), np.concatenate([J for _, J in parts], axis=1)

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return the rows of both for the compiled solver."""
        return (*self.position.compiled(), *self.orientation.compiled())
