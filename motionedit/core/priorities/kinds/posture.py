"""Joints keep the local rotations that they have in the input, or in the reference."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector
from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors, Movable, Symbol
from motionedit.core.priorities.recruiting import Recruits
from motionedit.core.priorities.solver.points import Point, Recruited, turn_to_local
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.units import METRES_PER_RADIAN
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.settings import Body
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Columns


@dataclass(frozen=True, eq=False, kw_only=True)
class Posture(Constraint):
    """The listed `joints` keep their local rotations, or have those of the reference where they follow it."""

    type: ClassVar[str] = "posture"
    symbol: ClassVar[Symbol] = "arc"

    joints: tuple[int, ...] = ()

    def recruits(self, movable: Movable) -> Recruits:
        """Return the joints themselves."""
        del movable
        return Recruits(frozenset(self.joints), root=False)

    def moved_by(self, movable: Movable) -> Recruits:
        """Return the joints themselves."""
        return self.recruits(movable)

    def carries(self, body: Body) -> bool:
        """Return False: to turn is no reason."""
        del body
        return False

    def targets(self, scene: Scene) -> Targets:
        """Return the interval, and the rotations of the reference where it follows that; else the input's are kept."""
        targets = Targets(*self.active(len(scene.before.motion)))
        return targets if self.follow == "input" else self._seen(targets, scene.before)

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return the rotations that joints have; where the input's are kept, they are no place to go back to."""
        return targets if targets.postures is None else self._seen(targets, after)

    def _seen(self, targets: Targets, sight: Sight) -> Targets:
        return replace(targets, postures=sight.motion.rotations[targets.span, list(self.joints)])

    def task(self, targets: Targets, stage: Stage) -> PostureTask:
        """Return the task of those of the joints that can turn."""
        here = set(map(int, stage.columns.joints))
        joints = [j for j in self.joints if j in here]
        if targets.postures is None:
            rotations = stage.reference.rotations[stage.frames[:, None], np.array(joints, dtype=np.intp)]
        else:
            places = np.array([k for k, j in enumerate(self.joints) if j in here], dtype=np.intp)
            rotations = targets.postures[(stage.frames - targets.first)[:, None], places]
        return PostureTask(stage.columns, np.searchsorted(stage.columns.joints, joints), rotations)

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return the largest angle of any of the joints from what they keep."""
        joints = list(self.joints)
        mine = after.motion.rotations[targets.span, joints]
        theirs = reference.rotations[targets.span, joints] if targets.postures is None else targets.postures
        return ConstraintErrors(targets.first, None, rot.angle_between(mine, theirs).max(axis=1, initial=0.0))

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``posture of Neck, Head``."""
        return f"posture of {', '.join(names[j] for j in self.joints)}"


@dataclass(frozen=True, eq=False)
class PostureTask:
    """Joints keep given local rotations: `places` are their columns, `targets` (N, len(places), 4)."""

    columns: Columns
    places: IntArray
    targets: FloatArray

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = log(q_target q^-1) as world-axis increments, and the identity per joint, as `Task`."""
        joints = self.columns.joints[self.places]
        e = turn_to_local(self.columns.skeleton, poses, local, joints=joints, targets=self.targets[frames])
        rows = np.zeros((3 * len(joints), self.columns.size))
        for i, place in enumerate(self.places):
            rows[3 * i : 3 * i + 3, 3 * place : 3 * place + 3] = METRES_PER_RADIAN * np.eye(3)
        return METRES_PER_RADIAN * e.reshape(len(local), -1), np.broadcast_to(rows, (len(local), *rows.shape))

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver, joint by joint."""
        return tuple(
            CompiledTask("posture", point.recruited, self.targets[:, i], point)
            for i, point in enumerate(map(self._turning, self.columns.joints[self.places]))
        )

    def _turning(self, joint: int) -> Point:
        """Return a joint that nothing but its own turn moves."""
        recruited = Recruited(self.columns.joints == joint, root=False)
        return Point(self.columns, Effector(int(joint), np.zeros(3)), recruited)
