"""Two points of the body keep a distance, or stay within one."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from motionedit.core.kinematics import Effector, effector_positions
from motionedit.core.measure import Measure
from motionedit.core.priorities.kinds.constraint import ConstraintErrors
from motionedit.core.priorities.kinds.effector import EffectorConstraint
from motionedit.core.priorities.recruiting import Recruits, recruit_chains, start_of
from motionedit.core.priorities.solver.constants import NO_DIRECTION
from motionedit.core.priorities.solver.points import moved_by
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.lengths import length_targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Hashable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Movable, Scene, Stage
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Point
    from motionedit.core.priorities.trajectories.lengths import Bound, LengthPoint

# One number is measured.
_LENGTH = Measure(counted=(0,))


@dataclass(frozen=True, eq=False, kw_only=True)
class Distance(EffectorConstraint):
    """An effector is as far from another as its points say; all of them bound it alike.

    Attributes
    ----------
    to : Effector
        The other point.
    """

    type: ClassVar[str] = "distance"

    to: Effector
    points: tuple[LengthPoint, ...] = ()

    @property
    def about(self) -> Hashable:
        """Its two ends; a bound on one side agrees with others as it is."""
        ends = [(end.joint, end.offset.tobytes()) for end in self._ends]
        return None if self.one_sided else (self.type, *ends)

    @property
    def bound(self) -> Bound:
        """Whether the distance is asked for, or bounded on one side."""
        return self.points[0].bound if self.points else "distance"

    @property
    def one_sided(self) -> bool:
        """Whether it is bounded on one side."""
        return self.bound != "distance"

    def recruits(self, movable: Movable) -> Recruits:
        """Return the chains of both ends, as far as the user lets them, without what moves both alike."""
        skeleton = movable.skeleton
        starts = [start_of(skeleton, end.joint, itself=end.is_off) for end in self._ends]
        asked = recruit_chains(skeleton, self.recruit, starts=starts, travel=movable.travel)
        moved = self.moved_by(movable)
        return Recruits(asked.joints & moved.joints, asked.root and moved.root)

    def moved_by(self, movable: Movable) -> Recruits:
        """Return the ancestors of one end alone, and whether the root's translation moves one end alone."""
        skeleton = movable.skeleton
        one, other = (moved_by(skeleton, end.joint, itself=end.is_off) for end in self._ends)
        shifted = [movable.travel in skeleton.chain(end.joint) for end in self._ends].count(True) == 1
        return Recruits(frozenset(map(int, np.flatnonzero(one ^ other))), shifted)

    def looked_at(self) -> frozenset[int]:
        """Return the joints of both ends."""
        return frozenset(end.joint for end in self._ends)

    @property
    def _ends(self) -> tuple[Effector, Effector]:
        return self.effector, self.to

    def targets(self, scene: Scene) -> Targets:
        """Return the distances, over the input's own."""
        own = np.linalg.norm(_way(*self._ends, scene.before.poses), axis=1)
        lengths = length_targets(own, self.points, ease_in=self.ease_in, ease_out=self.ease_out, since=self.since)
        return Targets(*self.active(len(own)), lengths=lengths)

    def task(self, targets: Targets, stage: Stage) -> DistanceTask:
        """Return the task of both ends."""
        ends = stage.point(self.effector), stage.point(self.to)
        return DistanceTask(*ends, targets.lengths_at(stage.frames), self.bound)

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return how far apart the ends are."""
        way = _way(*self._ends, after.poses.at(targets.span))
        return Targets(targets.first, targets.last, lengths=np.linalg.norm(way, axis=1))

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return what the distance lacks, or has too much; 0 on the right side of a bound."""
        del reference
        poses = after.poses.at(targets.span)
        way = _way(*self._ends, poses)
        distance, lengths = np.linalg.norm(way, axis=1), targets.all_lengths
        wanted = {"distance": lengths, "at_least": np.maximum(distance, lengths)}
        at = wanted.get(self.bound, np.minimum(distance, lengths))
        places = effector_positions(poses, self.to) + at[:, None] * _direction(way, distance)
        return ConstraintErrors(targets.first, np.abs(at - distance), None, places)

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``distance of LeftHand to RightHand``."""
        return f"{super().words(names)} to {names[self.to.joint]}"


def _way(effector: Effector, to: Effector, poses: WorldPoses) -> FloatArray:
    """Return the way from one point to another, p - p_to, shape (N, 3)."""
    return effector_positions(poses, effector) - effector_positions(poses, to)


def _direction(way: FloatArray, distance: FloatArray) -> FloatArray:
    """Return unit vectors (N, 3); where two points meet, any will do to part them: x."""
    unit = way / np.maximum(distance, NO_DIRECTION)[:, None]
    return np.where(distance[:, None] < NO_DIRECTION, np.array([1.0, 0.0, 0.0]), unit)


@dataclass(frozen=True, eq=False)
class DistanceTask:
    """A point keeps its distance from another: one row, at `lengths` (N,), or within them."""

    point: Point
    to: Point
    lengths: FloatArray
    bound: Bound = "distance"

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = d - |p - p_to| and u (dp - dp_to), u the direction of p - p_to, as `Task`.

        Both change their signs for what the distance may be at most: so that a larger J w is on the right side.
        """
        del local
        way = _way(self.point.effector, self.to.effector, poses)
        distance = np.linalg.norm(way, axis=1)
        sign = -1.0 if self.bound == "at_most" else 1.0
        along = sign * _direction(way, distance)[:, None]
        e = sign * (self.lengths[frames] - distance)
        return e[:, None], along @ (self.point.position_rows(poses) - self.to.position_rows(poses))

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its row for the compiled solver."""
        sign, lengths = -1.0 if self.bound == "at_most" else 1.0, self.lengths[:, None]
        return (
            CompiledTask("distance", self.point.recruited, lengths, self.point, self.to, measure=_LENGTH, sign=sign),
        )
