"""The frames of a prioritized edit on their way: targets, groups of frames with the same constraints, passes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.editing.balance import com_targets, support_points
from motionedit.core.editing.constraint_errors import ConstraintErrors, errors_of
from motionedit.core.editing.constraints import (
    Constraint,
    Targets,
    aim_targets,
    order_of_layers,
    targets_of,
    task_of,
)
from motionedit.core.editing.continuity import filtered_root
from motionedit.core.ik.layered_solver import HingeColumns, Problem, WeightedTask, solve_layers
from motionedit.core.ik.recruiting import Recruits
from motionedit.core.ik.tasks import Columns
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.editing.prioritized_edit import Body, LayeredSettings, PaperFilter
    from motionedit.core.hinges import Hinge


@dataclass(frozen=True, eq=False)
class Solved:
    """A motion with every frame solved, how it went frame by frame, and the targets it was solved for."""

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    targets: list[Targets]


@dataclass(frozen=True, eq=False)
class Run:
    """One edit on its way: the input, the constraints, what they recruit."""

    motion: Motion
    constraints: tuple[Constraint, ...]
    recruits: tuple[Recruits, ...]
    body: Body
    settings: LayeredSettings
    poses: WorldPoses

    def targets(self, current: WorldPoses | None) -> list[Targets]:
        """Return all targets; `current` is the edited motion so far, for supports."""
        curve = self.settings.curve
        fixed: dict[int, Targets] = {
            i: targets_of(c, self.poses, curve=curve)
            for i, c in enumerate(self.constraints)
            if c.kind in {"position", "orientation", "pose"}
        }
        result = []
        for i, constraint in enumerate(self.constraints):
            if i in fixed:
                result.append(fixed[i])
            elif constraint.kind == "com":
                support = self._support(constraint, fixed, current)
                result.append(com_targets(constraint, self.poses, self.body.masses, support=support, curve=curve))
            elif constraint.kind == "aim":
                result.append(aim_targets(constraint, self.poses, curve=curve))
            else:
                result.append(Targets(*constraint.active(len(self.motion))))
        return result

    def _support(
        self, constraint: Constraint, fixed: dict[int, Targets], current: WorldPoses | None
    ) -> FloatArray | None:
        """Return mean(A'): where members of the support have goals the goals, else where they are so far."""
        if not constraint.support:
            return None
        goals: dict[int, FloatArray] = {}
        for i, targets in fixed.items():
            other = self.constraints[i]
            whole = other.base is None and other.axes == (0, 1, 2) and not np.any(other.effector.offset)
            if targets.positions is not None and whole and other.effector.joint in constraint.support:
                joint = other.effector.joint
                goals.setdefault(joint, np.full((len(self.motion), 3), np.nan))
                goals[joint][targets.first : targets.last + 1] = targets.positions @ other.measure
        return support_points(constraint, self.poses if current is None else current, goals)

    def groups(self, targets: Sequence[Targets]) -> list[tuple[tuple[int, ...], IntArray]]:
        """Return (constraints, frames): frames at which the same constraints are active are solved together."""
        active = np.zeros((len(self.motion), len(targets)), dtype=np.bool_)
        for i, each in enumerate(targets):
            active[each.first : each.last + 1, i] = True
        rows, which = np.unique(active, axis=0, return_inverse=True)
        return [
            (tuple(map(int, np.flatnonzero(row))), np.flatnonzero(which.ravel() == i))
            for i, row in enumerate(rows)
            if row.any()
        ]

    def solve(self, start: Motion, *, reference: Motion, pull_root: bool, previous: Motion | None = None) -> Solved:
        """Return the motion with every frame solved from `start`, attracted to `reference`."""
        targets = self.targets(None if previous is None else forward(previous))
        count, levels = len(start), order_of_layers([c.priority for c in self.constraints])
        rotations, translations = start.rotations.copy(), start.translations.copy()
        iterations = np.zeros(count, dtype=np.intp)
        converged = np.ones(count, dtype=np.bool_)
        ranks = np.zeros((count, len(levels)), dtype=np.intp)
        for members, frames in self.groups(targets):
            problem = self._problem(members, frames, targets, reference, pull_root=pull_root)
            part = Motion(start.skeleton, start.rotations[frames], start.translations[frames], start.frame_time)
            solution = solve_layers(problem, part)
            rotations[frames] = solution.motion.rotations
            translations[frames] = solution.motion.translations
            iterations[frames], converged[frames] = solution.iterations, solution.converged
            there = [levels.index(p) for p in order_of_layers([self.constraints[i].priority for i in members])]
            ranks[frames[:, None], there] = solution.ranks
        motion = Motion(start.skeleton, rotations, translations, start.frame_time)
        return Solved(motion, iterations, converged, ranks, targets)

    def _problem(
        self,
        members: Sequence[int],
        frames: IntArray,
        targets: Sequence[Targets],
        reference: Motion,
        *,
        pull_root: bool,
    ) -> Problem:
        joints = np.array(sorted(set().union(*(self.recruits[i].joints for i in members))), dtype=np.intp)
        columns = Columns(self.motion.skeleton, joints, self.body.travel)
        layers = []
        for priority in order_of_layers([self.constraints[i].priority for i in members]):
            tasks = []
            for i in members:
                constraint = self.constraints[i]
                if constraint.priority == priority:
                    task = task_of(
                        constraint,
                        targets[i],
                        frames,
                        columns,
                        self.recruits[i],
                        masses=self.body.masses,
                        reference=self.motion,
                    )
                    tasks.append(WeightedTask(task, constraint.weight))
            layers.append(tuple(tasks))
        place = np.searchsorted(self.motion.skeleton.translated, self.body.travel)
        root = reference.translations[frames, place] if pull_root and reference.translations.shape[1] else None
        return Problem(
            columns=columns,
            moves_root=any(self.recruits[i].root for i in members),
            layers=tuple(layers),
            hinges=_hinge_columns(self.body.hinges, joints),
            reference_rotations=reference.rotations[frames],
            reference_root=root,
            attraction=self.settings.attraction,
            max_iterations=self.settings.max_iterations,
        )

    def solve_as_the_paper(self, smoothing: PaperFilter) -> tuple[Solved, IntArray]:
        """Solve frame by frame from eq. (4)'s start states, filter the root, and solve again with the root frozen."""
        targets = self.targets(None)
        state = self._in_order(targets)
        iterations = state.iterations.copy()
        place = int(np.searchsorted(self.motion.skeleton.translated, self.body.travel))
        frozen = replace(self, recruits=tuple(Recruits(each.joints, root=False) for each in self.recruits))
        for number in range(smoothing.count):
            if number == 0:
                filtered = filtered_root(
                    self.motion, state.motion, place, cutoff=smoothing.cutoff, first=self.body.first
                )
                state = replace(state, motion=filtered)
            else:
                state = frozen.solve(state.motion, reference=self.motion, pull_root=False, previous=state.motion)
        return state, iterations

    def _in_order(self, targets: Sequence[Targets]) -> Solved:
        """Solve the frames one after the other: joints that an active constraint controls start where they were."""
        motion = self.motion
        rotations, translations = motion.rotations.copy(), motion.translations.copy()
        levels = order_of_layers([c.priority for c in self.constraints])
        iterations = np.zeros(len(motion), dtype=np.intp)
        converged = np.ones(len(motion), dtype=np.bool_)
        ranks = np.zeros((len(motion), len(levels)), dtype=np.intp)
        ordered = sorted((int(f), members) for members, frames in self.groups(targets) for f in frames)
        place = int(np.searchsorted(motion.skeleton.translated, self.body.travel))
        before = -2
        for frame, members in ordered:
            controlled = sorted(set().union(*(self.recruits[i].joints for i in members)))
            if before == frame - 1:
                rotations[frame, controlled] = rotations[frame - 1, controlled]
                if any(self.recruits[i].root for i in members):
                    translations[frame, place] = translations[frame - 1, place]
            at = np.array([frame])
            problem = self._problem(members, at, targets, motion, pull_root=False)
            start = Motion(motion.skeleton, rotations[at], translations[at], motion.frame_time)
            solution = solve_layers(problem, start)
            rotations[at], translations[at] = solution.motion.rotations, solution.motion.translations
            iterations[at], converged[at] = solution.iterations, solution.converged
            there = [levels.index(p) for p in order_of_layers([self.constraints[i].priority for i in members])]
            ranks[frame, there] = solution.ranks[0]
            before = frame
        edited = Motion(motion.skeleton, rotations, translations, motion.frame_time)
        return Solved(edited, iterations, converged, ranks, list(targets))

    def errors(self, solved: Solved) -> tuple[ConstraintErrors, ...]:
        """Return what is left of every constraint, against the targets of the last pass, by forward kinematics."""
        poses = forward(solved.motion)
        return tuple(
            errors_of(c, t, poses, solved.motion, masses=self.body.masses, reference=self.motion)
            for c, t in zip(self.constraints, solved.targets, strict=True)
        )


def _hinge_columns(hinges: Sequence[Hinge], joints: IntArray) -> HingeColumns:
    here = [hinge for hinge in hinges if hinge.joint in set(map(int, joints))]
    return HingeColumns(
        places=np.searchsorted(joints, np.array([hinge.joint for hinge in here], dtype=np.intp)),
        axes=np.array([hinge.axis for hinge in here]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in here]).reshape(-1, 2),
    )
