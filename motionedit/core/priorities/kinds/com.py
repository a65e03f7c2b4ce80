"""The center of mass goes with its support, by default as in the input ([PRIO] section 4.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import Masses, center_of_mass, subtree_centers
from motionedit.core.measure import WORLD, Measure
from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors, Movable, Symbol
from motionedit.core.priorities.recruiting import EVERYTHING, RecruitRule, Recruits, recruit_body
from motionedit.core.priorities.solver.points import lever_rows
from motionedit.core.priorities.solver.problem import CompiledTask
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.positions import position_targets
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Scene, Stage
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Columns, Recruited


@dataclass(frozen=True, eq=False, kw_only=True)
class CenterOfMass(Constraint):
    """The center of mass keeps to its path, carried along by the mean of its support.

    Attributes
    ----------
    support : tuple of int
        The joints of the set A; none: the input's own path.
    relative_to : {"support", "world"}
        ``world`` is the input's own path whatever the support does.
    recruit : RecruitRule
    """

    type: ClassVar[str] = "com"
    waits_for_others: ClassVar[bool] = True
    weighs: ClassVar[bool] = True
    averages: ClassVar[bool] = True
    symbol: ClassVar[Symbol] = "ball"

    support: tuple[int, ...] = ()
    relative_to: Literal["support", "world"] = "support"
    recruit: RecruitRule = EVERYTHING

    @property
    def about(self) -> Hashable:
        """The center of mass, along the axes that count."""
        return self.type, self.measure.key

    @property
    def subjects(self) -> frozenset[Hashable]:
        """The center of mass, along whichever axes."""
        return frozenset((self.type,))

    @property
    def members(self) -> tuple[int, ...]:
        """The support that it goes with."""
        return self.support if self.relative_to == "support" else ()

    def recruits(self, movable: Movable) -> Recruits:
        """Return all that carries mass, or the joints that are listed."""
        return recruit_body(self.recruit, movable.carriers)

    def moved_by(self, movable: Movable) -> Recruits:
        """Return all that carries mass."""
        return Recruits(movable.carriers, root=True)

    def looked_at(self) -> frozenset[int]:
        """Return the support."""
        return frozenset(self.members)

    def targets(self, scene: Scene) -> Targets:
        """Return P' = mean(A') + K (P - mean(A)) with K = 1, and the points' displacement map on it.

        A' is where goals put the support, and where there are none, where the other constraints alone put it. Were
        that where this very edit puts it, a center of mass would chase feet that it moves itself.
        """
        _, positions = position_targets(
            self._path(scene),
            self.points,
            ease_in=self.ease_in,
            ease_out=self.ease_out,
            curve=scene.curve,
            since=self.since,
        )
        return Targets(*self._span(scene), positions)

    def unasked(self, targets: Targets, scene: Scene) -> Targets:
        """Return its path, carried along by its support."""
        return Targets(targets.first, targets.last, self._path(scene)[targets.span])

    def _span(self, scene: Scene) -> tuple[int, int]:
        return self.active(len(scene.before.motion))

    def _path(self, scene: Scene) -> FloatArray:
        """Return P' along the axes of its measure, shape (F, 3)."""
        before = scene.before
        path = before.center
        if self.members:
            goals = scene.goals()
            now = before if self._has_goals(goals, self._span(scene)) else scene.others()
            path = self._mean(now.poses, goals) + path - self._mean(before.poses, {})
        along: FloatArray = path @ self.measure.axes.T
        return along

    def _has_goals(self, goals: Mapping[int, FloatArray], span: tuple[int, int]) -> bool:
        """Return whether every member of the support has a goal wherever the constraint is active."""
        first, last = span
        return all(joint in goals and not np.isnan(goals[joint][first : last + 1]).any() for joint in self.members)

    def _mean(self, poses: WorldPoses, goals: Mapping[int, FloatArray]) -> FloatArray:
        """Return the mean of the support, shape (F, 3): goals stand before poses."""
        places = poses.positions[:, list(self.members)].copy()
        for i, joint in enumerate(self.members):
            if joint in goals:
                places[:, i] = np.where(np.isnan(goals[joint]), places[:, i], goals[joint])
        mean: FloatArray = places.mean(axis=1)
        return mean

    def task(self, targets: Targets, stage: Stage) -> CenterOfMassTask:
        """Return the task of the center of mass."""
        positions = targets.positions_at(stage.frames)
        return CenterOfMassTask(stage.columns, stage.recruited, stage.masses, positions, self.measure)

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return where the center of mass is, along the axes of its measure."""
        return Targets(targets.first, targets.last, after.center[targets.span] @ self.measure.axes.T)

    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return the distance of the center of mass from its targets."""
        del reference
        path = after.center[targets.span] @ self.measure.axes.T
        wanted = self.measure.aimed(path, targets.all_positions)
        distance: FloatArray = rot.length(path - wanted)
        return ConstraintErrors(targets.first, distance, None, wanted @ self.measure.axes)

    def words(self, names: tuple[str, ...]) -> str:
        """Return ``center of mass over LeftFoot, RightFoot``."""
        on = ", ".join(names[j] for j in self.members)
        return f"center of mass{f' over {on}' if on else ''}"

    def warnings(self) -> Iterator[str]:
        """Yield that there is nothing to stand on."""
        if self.relative_to == "support" and not self.support:
            yield "no feet found for the support of 'com': the center of mass keeps to the input's own path"


@dataclass(frozen=True, eq=False)
class CenterOfMassTask:
    """The center of mass follows targets (N, 3) along the axes that count of `measure`."""

    columns: Columns
    recruited: Recruited
    masses: Masses
    targets: FloatArray
    measure: Measure = WORLD

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return e = target - c and (m_sub / M) e_a x (c_sub - p_j), as `Task`."""
        del local
        centers, shares = subtree_centers(poses, self.masses)
        joints = self.columns.joints
        weight = shares[joints] * self.recruited.joints
        J = lever_rows(centers[:, joints] - poses.positions[:, joints], weight, root=self.recruited.root)
        rows = self.measure.rows
        e = self.targets[frames][:, list(self.measure.counted)] - center_of_mass(poses, self.masses) @ rows.T
        return e, rows @ J

    def compiled(self) -> tuple[CompiledTask, ...]:
        """Return its rows for the compiled solver."""
        rows = CompiledTask("center of mass", self.recruited, self.targets, measure=self.measure, masses=self.masses)
        return (rows,)
