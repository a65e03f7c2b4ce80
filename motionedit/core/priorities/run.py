"""The frames of a prioritized edit on their way: targets, groups of frames with the same constraints, passes."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.motion import Motion
from motionedit.core.priorities.balance import com_targets, support_points
from motionedit.core.priorities.compiled_solver import Layout
from motionedit.core.priorities.constraint_errors import ConstraintErrors, errors_of
from motionedit.core.priorities.constraints import (
    Constraint,
    Targets,
    aim_targets,
    order_of_layers,
    targets_of,
    task_of,
)
from motionedit.core.priorities.continuity import filtered_root
from motionedit.core.priorities.groups import Group, hinge_columns, spans_of
from motionedit.core.priorities.recruiting import Recruits
from motionedit.core.priorities.sight import Sight, joints_named, sight_of
from motionedit.core.priorities.solver import Problem, Reference, WeightedTask, solve_layers
from motionedit.core.priorities.tasks import Columns
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.priorities.edit import Body, LayeredSettings, PaperFilter


# Kinds of constraints that ask for a place or a turn, and whose targets are found from the input alone.
_PLACED = frozenset({"position", "orientation", "pose"})


@dataclass(frozen=True, eq=False)
class Solved:
    """A motion with every frame solved, and how it went frame by frame."""

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray


@dataclass(frozen=True, eq=False)
class Known:
    """What a solve leaves for the next: frames (F,) that need nothing, and their ranks (F, L)."""

    done: BoolArray
    ranks: IntArray


@dataclass(frozen=True, eq=False)
class Run:
    """One edit on its way: the input, the constraints, what they recruit."""

    motion: Motion
    constraints: tuple[Constraint, ...]
    recruits: tuple[Recruits, ...]
    body: Body
    settings: LayeredSettings

    def _sight(self, motion: Motion) -> Sight:
        """Return what the constraints look at in a motion; not kept, for of a long clip it is large."""
        return sight_of(motion, joints_named(self.constraints), self.body.masses)

    @cached_property
    def targets(self) -> tuple[Targets, ...]:
        """The targets of all constraints, from the input; members of a support without goals are where they end up.

        That is where the other constraints alone put them. Were it where this very edit puts them, a center of mass
        would chase feet that it moves itself.
        """
        sight = self._sight(self.motion)
        curve, found = self.settings.curve, list(self._bound_targets(sight))
        balanced = [i for i, each in enumerate(self.constraints) if each.kind == "com"]
        free = any(self.constraints[i].support and not self._has_goals(self.constraints[i], found) for i in balanced)
        now = self._sight(self._unbalanced()) if free else sight
        for i in balanced:
            found[i] = self._com_targets(self.constraints[i], sight, now, found)
        for i, constraint in enumerate(self.constraints):
            if constraint.kind == "aim":
                found[i] = aim_targets(constraint, sight.poses, curve=curve)
        return tuple(found)

    def _unbalanced(self) -> Motion:
        """Return the motion that all but the centers of mass ask for, solved once."""
        others = [i for i, each in enumerate(self.constraints) if each.kind != "com"]
        if not others:
            return self.motion
        run = replace(
            self,
            constraints=tuple(self.constraints[i] for i in others),
            recruits=tuple(self.recruits[i] for i in others),
        )
        return run.solve(self.motion, reference=self.motion, pull_root=False).motion

    def _bound_targets(self, sight: Sight) -> Iterator[Targets]:
        """Yield the targets of what is bound to the input alone, and intervals for the others."""
        for constraint in self.constraints:
            if constraint.kind in _PLACED:
                yield targets_of(constraint, sight.poses, curve=self.settings.curve)
            else:
                yield Targets(*constraint.active(len(self.motion)))

    def _com_targets(self, constraint: Constraint, before: Sight, now: Sight, targets: Sequence[Targets]) -> Targets:
        """Return the targets of a `com` from the input and from the edited motion so far."""
        support = None
        if constraint.support:
            support = support_points(constraint, now.poses, self._support_goals(constraint, targets))
        return com_targets(constraint, before.poses, before.center, support=support, curve=self.settings.curve)

    def _support_goals(self, constraint: Constraint, targets: Sequence[Targets]) -> dict[int, FloatArray]:
        """Return the goals of members of a support, by joint, shape (F, 3), nan where there is none: they are A'."""
        goals: dict[int, FloatArray] = {}
        for other, each in zip(self.constraints, targets, strict=True):
            whole = other.base is None and other.axes == (0, 1, 2) and not np.any(other.effector.offset)
            places = each.positions if other.kind in _PLACED else None
            if places is not None and whole and other.effector.joint in constraint.support:
                joint = other.effector.joint
                goals.setdefault(joint, np.full((len(self.motion), 3), np.nan))
                goals[joint][each.first : each.last + 1] = places @ other.measure
        return goals

    def _has_goals(self, constraint: Constraint, targets: Sequence[Targets]) -> bool:
        """Return whether every member of a support has a goal wherever the constraint is active."""
        goals, (first, last) = self._support_goals(constraint, targets), constraint.active(len(self.motion))
        return all(
            joint in goals and not np.isnan(goals[joint][first : last + 1]).any() for joint in constraint.support
        )

    @cached_property
    def levels(self) -> list[int]:
        """The distinct priorities, the most important first."""
        return order_of_layers([c.priority for c in self.constraints])

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Frames at which the same constraints are active, together."""
        active = np.zeros((len(self.motion), len(self.constraints)), dtype=np.bool_)
        for i, each in enumerate(self.targets):
            active[each.first : each.last + 1, i] = True
        together: dict[tuple[bool, ...], list[IntArray]] = {}
        for run in np.split(np.arange(len(active)), np.flatnonzero((active[1:] != active[:-1]).any(axis=1)) + 1):
            together.setdefault(tuple(active[run[0]].tolist()), []).append(run)
        return tuple(
            self._group([i for i, there in enumerate(key) if there], np.concatenate(together[key]))
            for key in sorted(together)
            if any(key)
        )

    def _group(self, members: Sequence[int], frames: IntArray) -> Group:
        joints = np.array(sorted(set().union(*(self.recruits[i].joints for i in members))), dtype=np.intp)
        columns = Columns(self.motion.skeleton, joints, self.body.travel)
        priorities = order_of_layers([self.constraints[i].priority for i in members])
        layers = [
            tuple(self._task(i, frames, columns) for i in members if self.constraints[i].priority == priority)
            for priority in priorities
        ]
        problem = Problem(
            columns=columns,
            moves_root=any(self.recruits[i].root for i in members),
            layers=tuple(layers),
            hinges=hinge_columns(self.body.hinges, joints),
            attraction=self.settings.attraction,
            max_iterations=self.settings.max_iterations,
        )
        laid_out = replace(problem, layout=None if compiled() is None else Layout.of(problem))
        levels = np.array([self.levels.index(priority) for priority in priorities])
        return Group(frames, levels, laid_out)

    def _task(self, i: int, frames: IntArray, columns: Columns) -> WeightedTask:
        constraint = self.constraints[i]
        task = task_of(
            constraint,
            self.targets[i],
            frames,
            columns,
            self.recruits[i],
            masses=self.body.masses,
            reference=self.motion,
        )
        return WeightedTask(task, constraint.weight)

    @cached_property
    def place(self) -> int:
        """The root's place among the joints with translations."""
        return int(np.searchsorted(self.motion.skeleton.translated, self.body.travel))

    def untouched(self, start: Motion) -> Solved:
        """Return a motion before anything is solved."""
        motion = Motion(start.skeleton, start.rotations.copy(), start.translations.copy(), start.frame_time)
        count = len(start)
        return Solved(
            motion,
            np.zeros(count, dtype=np.intp),
            np.ones(count, dtype=np.bool_),
            np.zeros((count, len(self.levels)), dtype=np.intp),
        )

    def after(self, previous: Solved, start: Motion) -> Known:
        """Return what a solve from `start` that follows another may leave alone.

        Frames that were left as in the input, and that start from there again, need nothing.
        """
        done = _same(start, self.motion) & _same(previous.motion, self.motion) & previous.converged
        return Known(done, previous.ranks)

    def solve(self, start: Motion, *, reference: Motion, pull_root: bool, known: Known | None = None) -> Solved:
        """Return the motion with every frame solved from `start`, attracted to `reference`.

        Parameters
        ----------
        known : Known, optional
            What is known from the solve before.
        """
        solved = self.untouched(start)
        for group in self.groups:
            done = None if known is None else known.done[group.frames]
            self._solve_frames(solved, group, group.problem, group.frames, reference, done=done, pull_root=pull_root)
        if known is not None:
            solved.ranks[known.done] = known.ranks[known.done]
        return solved

    def _solve_frames(
        self,
        solved: Solved,
        group: Group,
        problem: Problem,
        frames: IntArray,
        reference: Motion,
        *,
        pull_root: bool,
        done: BoolArray | None = None,
        in_order: bool = False,
    ) -> None:
        """Solve frames of `solved` from where they are, in place."""
        root = np.ascontiguousarray(reference.translations[:, self.place]) if pull_root and self._travels else None
        solution = solve_layers(
            problem,
            solved.motion,
            Reference(reference.rotations, root),
            frames,
            done=done,
            in_order=in_order,
            threads=self.settings.threads,
        )
        solved.iterations[frames], solved.converged[frames] = solution.iterations, solution.converged
        solved.ranks[frames[:, None], group.levels] = solution.ranks

    @property
    def _travels(self) -> bool:
        """Whether any joint has translations."""
        return bool(self.motion.translations.shape[1])

    def solve_as_the_paper(self, smoothing: PaperFilter) -> tuple[Solved, IntArray]:
        """Solve frame by frame from eq. (4)'s start states, filter the root, and solve again with the root frozen."""
        state = self._in_order()
        iterations = state.iterations.copy()
        frozen = replace(self, recruits=tuple(Recruits(each.joints, root=False) for each in self.recruits))
        vars(frozen)["targets"] = self.targets  # what is asked for is the same
        for number in range(smoothing.count):
            if number == 0:
                filtered = filtered_root(
                    self.motion, state.motion, self.place, cutoff=smoothing.cutoff, first=self.body.first
                )
                state = replace(state, motion=filtered)
            else:
                known = frozen.after(state, state.motion)
                state = frozen.solve(state.motion, reference=self.motion, pull_root=False, known=known)
        return state, iterations

    def _in_order(self) -> Solved:
        """Solve the frames one after the other: joints that an active constraint controls start where they were."""
        solved = self.untouched(self.motion)
        spans = [(int(span[0]), span, group) for group in self.groups for span in spans_of(group.frames)]
        before = -2
        for first, span, group in sorted(spans, key=itemgetter(0)):
            problem = self._at(group, span)
            if before == first - 1:
                motion, joints = solved.motion, problem.columns.joints
                motion.rotations[first, joints] = motion.rotations[first - 1, joints]
                if problem.moves_root:
                    motion.translations[first, self.place] = motion.translations[first - 1, self.place]
            self._solve_frames(solved, group, problem, span, self.motion, pull_root=False, in_order=True)
            before = first + len(span) - 1
        return solved

    def _at(self, group: Group, frames: IntArray) -> Problem:
        """Return a group's problem at some of its frames."""
        if len(frames) == len(group.frames):
            return group.problem
        members = [i for i, each in enumerate(self.targets) if each.first <= frames[0] <= each.last]
        return self._group(members, frames).problem

    def errors(self, solved: Solved) -> tuple[ConstraintErrors, ...]:
        """Return what is left of every constraint, by forward kinematics."""
        sight = self._sight(solved.motion)
        return tuple(
            errors_of(c, t, sight, solved.motion, reference=self.motion)
            for c, t in zip(self.constraints, self.targets, strict=True)
        )


def _same(one: Motion, other: Motion) -> BoolArray:
    """Return the frames at which two motions are alike to the bit, shape (F,)."""
    turned = (one.rotations == other.rotations).all(axis=(1, 2))
    same: BoolArray = turned & (one.translations == other.translations).all(axis=(1, 2))
    return same
