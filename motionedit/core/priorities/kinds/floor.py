"""Nothing of some points of the body goes below a height."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core.kinematics import Effector, effector_positions
from motionedit.core.measure import Measure
from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors, Movable
from motionedit.core.priorities.recruiting import EVERYTHING, RecruitRule, Recruits, recruit_chains, start_of
from motionedit.core.priorities.solver.points import moved_by
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.measure import Level
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Point


@dataclass(frozen=True, eq=False, kw_only=True)
class Floor(Constraint):
    """None of the effectors goes below a height, over the whole clip.

    Attributes
    ----------
    effector : tuple of Effector
        The points that stay above.
    height : Level
    recruit : RecruitRule
    """

    type: ClassVar[str] = "floor"

    effector: tuple[Effector, ...]
    height: Level
    recruit: RecruitRule = EVERYTHING

    @property
    def one_sided(self) -> bool:
        """Above the floor nothing is asked for."""
        return True

    @property
    def least(self) -> Level:
        """The floor."""
        return self.height

    def recruits(self, movable: Movable) -> Recruits:
        """Return the chains of all points, as far as the user lets them."""
        starts = {start_of(movable.skeleton, each.joint, itself=each.is_off) for each in self.effector}
        return recruit_chains(movable.skeleton, self.recruit, starts=sorted(starts), travel=movable.travel)

    def moved_by(self, movable: Movable) -> Recruits:
        """Return the ancestors of all points, and whether the root's translation moves any."""
        skeleton = movable.skeleton
        moved = np.zeros(len(skeleton), dtype=np.bool_)
        for each in self.effector:
            moved |= moved_by(skeleton, each.joint, itself=each.is_off)
        shifted = any(movable.travel in skeleton.chain(each.joint) for each in self.effector)
        return Recruits(frozenset(map(int, np.flatnonzero(moved))), shifted)

    def looked_at(self) -> frozenset[int]:
        """Return the joints of all points."""
        return frozenset(each.joint for each in self.effector)

    def targets(self, scene: Scene) -> Targets:
        """Return the interval: the floor is where it is."""
        return Targets(*self.active(len(scene.before.motion)))

    def task(self, targets: Targets, stage: Stage) -> FloorTask:
        """Return the task of all points."""
        del targets
        return FloorTask(tuple(stage.point(each) for each in self.effector), self.height, len(stage.frames))

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return how far the deepest point is below; its `places` are on the floor, or where it is above."""
        del reference
        poses = after.poses.at(targets.span)
        points = np.stack([effector_positions(poses, each) for each in self.effector], axis=1)
        above = self.height.above(points)
        deepest, frames = np.argmin(above, axis=1), np.arange(len(points))
        below = np.maximum(-above[frames, deepest], 0.0)
        places = points[frames, deepest] + below[:, None] * self.height.up
        return ConstraintErrors(targets.first, below, None, places)

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``floor under LeftFoot, LeftToeBase``."""
        joints = dict.fromkeys(names[each.joint] for each in self.effector)
        return f"floor under {', '.join(joints)}"


@dataclass(frozen=True, eq=False)
class FloorTask:
    """Points stay above a level in so many `frames`: a one-sided row each."""

    points: tuple[Point, ...]
    level: Level
    frames: int

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = h - up p and up dp/d(unknowns), as `Task`."""
        del local, frames
        up = self.level.up
        e = -np.stack([self.level.above(point.position(poses)) for point in self.points], axis=1)
        return e, np.stack([up @ point.position_rows(poses) for point in self.points], axis=1)

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver, point by point: of a place along `up`."""
        measure = Measure(axes=np.tile(self.level.up, (3, 1)), counted=(0,))
        targets = np.full((self.frames, 3), self.level.height)
        return tuple(
            CompiledTask("position", point.recruited, targets, point, measure=measure) for point in self.points
        )
