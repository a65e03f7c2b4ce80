"""An axis of a joint looks at a point or at another joint."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import effector_positions
from motionedit.core.measure import Measure
from motionedit.core.priorities.kinds.constraint import ConstraintErrors, Turned
from motionedit.core.priorities.kinds.effector import EffectorConstraint
from motionedit.core.priorities.solver.constants import NO_DIRECTION
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.positions import position_targets
from motionedit.core.units import METRES_PER_RADIAN
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.settings import Body
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Point


@dataclass(frozen=True, eq=False, kw_only=True)
class Aim(EffectorConstraint):
    """An axis fixed in the effector's joint looks at its points' positions, or at a joint.

    Attributes
    ----------
    axis : shape (3,)
        A unit vector, in the joint.
    target : int or None
        The joint that is looked at; the measure has no base then.
    """

    type: ClassVar[str] = "aim"
    turns: ClassVar[bool] = True
    looks: ClassVar[bool] = True

    axis: FloatArray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    target: int | None = None

    @property
    def seen(self) -> Measure:
        """What it is measured in: the frame of the joint that is looked at, where there is one."""
        return self.measure if self.target is None else Measure(base=self.target)

    @property
    def about(self) -> Hashable:
        """The axis that looks, and in whose frame what it looks at is."""
        return self.type, self.effector.joint, self.effector.offset.tobytes(), self.axis.tobytes(), self.base

    @property
    def base(self) -> int | None:
        """The joint in whose frame targets are, and so follow it."""
        return self.seen.base

    @property
    def base_turns_it(self) -> bool:
        """Whether turning the base's own joint moves the task: not where its place is looked at."""
        return self.target is None

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``aim of Head at LeftHand``."""
        at = "" if self.target is None else f" at {names[self.target]}"
        return f"{super().words(names)}{at}"

    def targets(self, scene: Scene) -> Targets:
        """Return the points that are looked at, eased from where it looks in the input.

        They are in the base's frame where there is one, else in the world. What looks at a joint looks at the origin
        of that joint's frame.
        """
        poses = scene.before.poses
        first, last = self.active(len(scene.before.motion))
        origin = self.seen.positions(effector_positions(poses, self.effector), poses)
        look = self.seen.directions(rot.rotate(poses.rotations[:, self.effector.joint], self.axis), poses)
        if self.target is not None:
            gaze = origin + np.linalg.norm(origin, axis=1, keepdims=True) * look
            positions = (gaze * (1.0 - self.share(len(origin)))[:, None])[first : last + 1]
            return Targets(first, last, positions)
        given = next(point.position for point in self.points if point.position is not None)
        gaze = origin + np.linalg.norm(given - origin, axis=1, keepdims=True) * look
        _, positions = position_targets(
            gaze,
            self.points,
            ease_in=self.ease_in,
            ease_out=self.ease_out,
            curve=scene.curve,
            since=self.since,
        )
        return Targets(first, last, positions @ self.measure.axes)

    def task(self, targets: Targets, stage: Stage) -> AimTask:
        """Return the task of the axis."""
        positions = targets.positions_at(stage.frames)
        return AimTask(stage.point(self.effector), self.axis, positions, stage.joint(self.base))

    def by_itself(self, targets: Targets, recruits: Recruits, body: Body, before: Callable[[], Sight]) -> Turned | None:
        """Return how a body turns that looks there with its head; None where it is no head, or all joints are alike."""
        gaze, joint = body.gaze, self.effector.joint
        if gaze is None or body.mobility is None or joint not in gaze.head:
            return None
        poses, chain = before().poses.at(targets.span), before().motion.skeleton.chain(joint).tolist()
        weights = body.mobility[chain] ** 2 * [each in recruits.joints for each in chain]
        looks = rot.rotate(poses.rotations[:, joint], self.axis)
        at = Measure(base=self.base).in_world(targets.all_positions, poses)
        goals = at - effector_positions(poses, self.effector)
        return Turned(chain, gaze.turned(before().motion, targets.span, chain, weights, looks, goals))

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return the points straight ahead, as far away as those that it shall look at."""
        poses, base = after.poses.at(targets.span), Measure(base=self.base)
        eye = effector_positions(poses, self.effector)
        distance = np.linalg.norm(base.in_world(targets.all_positions, poses) - eye, axis=1, keepdims=True)
        ahead = eye + distance * rot.rotate(poses.rotations[:, self.effector.joint], self.axis)
        return Targets(targets.first, targets.last, base.positions(ahead, poses))

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return the angle between the axis and the way to what is looked at, which are the `places`."""
        del reference
        poses = after.poses.at(targets.span)
        at = Measure(base=self.base).in_world(targets.all_positions, poses)
        way = at - effector_positions(poses, self.effector)
        look = rot.rotate(poses.rotations[:, self.effector.joint], self.axis)
        across = np.linalg.norm(rot.cross(look, way), axis=1)
        angle: FloatArray = np.arctan2(across, np.sum(look * way, axis=1))
        return ConstraintErrors(targets.first, None, angle, at)


@dataclass(frozen=True, eq=False)
class AimTask:
    """A direction fixed in a joint, unit (3,), looks at targets (N, 3) in the world, or in a base joint's frame."""

    point: Point
    axis: FloatArray
    targets: FloatArray
    base: Point | None = None

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the turn from d to the target's direction, and (I - d d^T) w + d x (dp_e - dp_t) / r, as `Task`."""
        del local
        d = rot.rotate(self.point.rotation(poses), self.axis)
        at, moved = self._place(poses, frames)
        way = at - self.point.position(poses)
        distance = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), NO_DIRECTION)
        t = way / distance
        turn = rot.cross(d, t)
        sine = np.linalg.norm(turn, axis=1, keepdims=True)
        cosine = np.sum(d * t, axis=1, keepdims=True)
        angle = np.arctan2(sine, cosine)
        # Straight behind, any axis square to d will do.
        side = np.where(sine < NO_DIRECTION, _square_to(d), turn / np.maximum(sine, NO_DIRECTION))
        J = self.point.rotation_rows(poses)
        J = J - d[:, :, None] * (d[:, None, :] @ J)
        swing = self.point.position_rows(poses)
        if moved is not None:
            swing = swing - moved
        J = J + rot.skew(d) @ swing / distance[..., None]
        return METRES_PER_RADIAN * angle * side, METRES_PER_RADIAN * J

    def _place(self, poses: WorldPoses, frames: IntArray) -> tuple[FloatArray, FloatArray | None]:
        """Return what is looked at, p_b + R_b t, and its rows, dp_b - [R_b t]x w_b; None where it stands still."""
        if self.base is None:
            return self.targets[frames], None
        at, rows = self.base.position(poses), self.base.position_rows(poses)
        arm = rot.rotate(self.base.rotation(poses), self.targets[frames])
        return at + arm, rows - rot.skew(arm) @ self.base.rotation_rows(poses)

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver."""
        return (CompiledTask("aim", self.point.recruited, self.targets, self.point, self.base, axis=self.axis),)


def _square_to(d: FloatArray) -> FloatArray:
    helper = np.eye(3)[np.argmin(np.abs(d), axis=1)]
    square = rot.cross(d, helper)
    side: FloatArray = square / np.linalg.norm(square, axis=1, keepdims=True)
    return side
