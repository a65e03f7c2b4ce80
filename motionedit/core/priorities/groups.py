"""Groups of frames: where the same constraints are active, frames are one problem."""

from __future__ import annotations

from functools import cached_property
from itertools import chain
from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.agreeing import overruled
from motionedit.core.priorities.as_one import mean_task, tasks_among
from motionedit.core.priorities.held_columns import held_columns
from motionedit.core.priorities.kinds.constraint import Stage
from motionedit.core.priorities.plans import frames_together, plan_of
from motionedit.core.priorities.sight import sight_of
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.solver.layered import Prepared, prepare_problem
from motionedit.core.priorities.solver.problem import Problem, WeightedTask, order_of_layers
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.settings import Body, LayeredSettings
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Columns
    from motionedit.core.priorities.solver.problem import Task
    from motionedit.core.priorities.task_targets import Targets


@dataclass(frozen=True, eq=False)
class Ramp:
    """A ramp of a constraint.

    Attributes
    ----------
    left : shape (F,)
        How much of it is left at every frame: 1 at its end, 0 within the constraint's points and beyond.
    outside : int
        The frame just outside of it.
    end : Targets
        Where its targets end: of one frame.
    """

    left: FloatArray
    outside: int
    end: Targets


@dataclass(frozen=True, eq=False)
class Asked:
    """All that is asked of a motion: each constraint, what it may move, and where its task shall be.

    `softness` has lambda^2 at every frame, shape (F,), of the constraints that give way: see `Problem`. `arcs` has the
    way round of the targets, shape (n, 3), that turn a joint far: see `far_turns`; `ramps` those of each constraint
    that are led to the edit. `pulls_root`: the root's translation is attracted in every solve, for nothing that is
    asked is a reason to carry the body elsewhere.
    """

    motion: Motion
    constraints: tuple[Constraint, ...]
    recruits: tuple[Recruits, ...]
    targets: tuple[Targets, ...]
    body: Body
    settings: LayeredSettings
    softness: tuple[FloatArray | None, ...]
    arcs: tuple[FloatArray | None, ...]
    ramps: tuple[tuple[Ramp, ...], ...]
    pulls_root: bool = False

    @classmethod
    def of(
        cls,
        motion: Motion,
        constraints: Sequence[Constraint],
        recruits: Sequence[Recruits],
        targets: Sequence[Targets],
        body: Body,
        settings: LayeredSettings,
    ) -> Asked:
        """Return what is asked where nothing gives way, turns far or is led."""
        none, no_ramps = (None,) * len(targets), ((),) * len(targets)
        return cls(motion, tuple(constraints), tuple(recruits), tuple(targets), body, settings, none, none, no_ramps)

    def softness_at(self, i: int, frames: IntArray) -> FloatArray:
        """Return lambda^2 of a constraint at frames, shape (N,): 0 where it does not give way."""
        soft = self.softness[i]
        return np.zeros(len(frames)) if soft is None else soft[frames]

    def only(self, keep: Sequence[int]) -> Asked:
        """Return what some of the constraints ask for."""
        return replace(
            self,
            constraints=tuple(self.constraints[i] for i in keep),
            recruits=tuple(self.recruits[i] for i in keep),
            targets=tuple(self.targets[i] for i in keep),
            softness=tuple(self.softness[i] for i in keep),
            arcs=tuple(self.arcs[i] for i in keep),
            ramps=tuple(self.ramps[i] for i in keep),
        )

    @property
    def levels(self) -> list[int]:
        """The distinct priorities, the most important first."""
        return order_of_layers([constraint.priority for constraint in self.constraints])


@dataclass(frozen=True, eq=False)
class Group:
    """Frames at which the same constraints are active, which are solved together.

    Attributes
    ----------
    frames : shape (n,)
    levels : shape (L,)
        Where the problem's layers stand among those of the whole edit.
    members : tuple of tuples of tuples of int
        The constraints of each task of each layer: several where they are solved as one.
    prepared : Prepared
        The problem, ready to be solved.
    """

    frames: IntArray
    levels: IntArray
    members: tuple[tuple[tuple[int, ...], ...], ...]
    prepared: Prepared

    @cached_property
    def where(self) -> slice | IntArray:
        """Its frames as an index: a slice, which is quicker, where they follow each other."""
        first, count = int(self.frames[0]), len(self.frames)
        return slice(first, first + count) if int(self.frames[-1]) == first + count - 1 else self.frames

    @property
    def constraints(self) -> list[int]:
        """All constraints that are active there, in order."""
        return sorted(chain.from_iterable(chain.from_iterable(self.members)))

    @property
    def problem(self) -> Problem:
        """What is solved in its frames."""
        return self.prepared.problem


def seen_by(constraints: Sequence[Constraint], motion: Motion, body: Body, *, poses: WorldPoses | None = None) -> Sight:
    """Return what some constraints look at in a motion, of which the `poses` may be known."""
    masses = None
    for each in constraints:
        if each.weighs:
            masses = body.masses
            break

    def joints() -> frozenset[int]:
        return frozenset().union(*(each.looked_at() for each in constraints))

    return sight_of(motion, joints, masses, poses=poses)


def groups_of(asked: Asked) -> tuple[Group, ...]:
    """Return the frames at which anything is active, together where the same constraints are that nothing overrules."""
    active = np.zeros((len(asked.motion), len(asked.constraints)), dtype=np.int8)
    for i, (targets, softness) in enumerate(zip(asked.targets, asked.softness, strict=True)):
        active[targets.span, i] = 1
        if softness is not None:
            active[targets.span, i] += softness[targets.span] > 0.0
    active[overruled(asked.constraints, asked.targets, len(asked.motion))] = 0
    if asked.body.first:
        active[: asked.body.first][_nothing_is_wanted(asked)] = 0
    together = frames_together(active)
    return tuple([_group(asked, members, frames) for members, frames in together])


def _nothing_is_wanted(asked: Asked) -> BoolArray:
    """Return the frames of a rest pose that do already what is asked, shape (first,).

    They are not solved: limbs that stand straight there, as they never do in the motion, would be bent to their limits.
    """
    first = min(asked.body.first, len(asked.motion))
    wanted = np.zeros(first, dtype=np.bool_)
    if not first:
        return ~wanted
    whole = asked.motion
    rest = whole.at(slice(first))
    for constraint, targets in zip(asked.constraints, asked.targets, strict=True):
        if targets.first >= first:
            continue
        seen = seen_by([constraint], rest, asked.body)
        errors = constraint.errors(
            targets.within(slice(targets.first, min(targets.last + 1, first))), seen, reference=rest
        )
        wanted[targets.first :][: len(errors.largest)] |= errors.largest > NO_DISPLACEMENT
    return ~wanted


def part_of(asked: Asked, group: Group, frames: IntArray) -> Group:
    """Return a group of some of a group's frames."""
    if len(frames) == len(group.frames):
        return group
    return _group(asked, group.constraints, frames)


def spans_of(frames: IntArray) -> list[IntArray]:
    """Return frames cut where they do not follow each other."""
    return np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1)


def _group(asked: Asked, members: Sequence[int], frames: IntArray) -> Group:
    constraints, recruits, body = asked.constraints, asked.recruits, asked.body
    soft = {i: asked.softness_at(i, frames) for i in members if asked.softness[i] is not None}
    shares = [(constraints[i].priority, constraints[i].weight, i in soft and bool(soft[i][0] > 0.0)) for i in members]
    plan = plan_of(
        asked.motion.skeleton,
        body.travel,
        tuple([recruits[i] for i in members]),
        tuple(shares),
        tuple([each.priority for each in constraints]),
    )
    layers = tuple([tuple([members[k] for k in layer]) for layer in plan.layers])
    softness = np.zeros((len(frames), len(layers)))
    for k, layer in enumerate(layers):
        if layer[0] in soft:
            # Whichever stands first in a spec, all are as soft as the softest of them.
            softness[:, k] = np.max([soft[i] for i in layer if i in soft], axis=0)
    hinges, limits, mobility = held_columns(body, plan.columns)
    weights = dict(zip(chain(*layers), chain(*plan.weights), strict=True))
    together = tuple([tasks_among(layer, constraints, recruits) for layer in layers])

    def weighted(which: tuple[int, ...]) -> WeightedTask:
        return _weighted(asked, which, hypot(*[weights[i] for i in which]), frames, plan.columns)

    problem = Problem(
        columns=plan.columns,
        moves_root=plan.moves_root,
        layers=tuple([tuple(map(weighted, tasks)) for tasks in together]),
        hinges=hinges,
        limits=limits,
        attraction=asked.settings.attraction,
        max_iterations=asked.settings.max_iterations,
        mobility=mobility,
        softness=softness,
        ends_early=asked.settings.gives_way,
    )
    return Group(frames, plan.levels, together, prepare_problem(problem))


def retargeted(asked: Asked, group: Group, changed: frozenset[int]) -> Group:
    """Return a group with what is asked now of the same constraints, of which some have `changed`."""
    if changed.isdisjoint(group.constraints):
        return group
    problem = group.problem
    layers = tuple(
        tuple(
            old if changed.isdisjoint(which) else _weighted(asked, which, old.weight, group.frames, problem.columns)
            for which, old in zip(members, tasks, strict=True)
        )
        for members, tasks in zip(group.members, problem.layers, strict=True)
    )
    return replace(group, prepared=group.prepared.with_targets_of(replace(problem, layers=layers)))


def _weighted(asked: Asked, which: tuple[int, ...], weight: float, frames: IntArray, columns: Columns) -> WeightedTask:
    """Return the task of constraints that are solved as one, of a weight in its layer."""
    task, apart = _task(asked, which, frames, columns)
    return WeightedTask(task, weight, asked.constraints[which[0]].one_sided, apart)


def _task(asked: Asked, which: tuple[int, ...], frames: IntArray, columns: Columns) -> tuple[Task, FloatArray | None]:
    """Return the task of constraints that are solved as one, and how far their targets are from its, shape (N,)."""
    tasks = []
    for i in which:
        stage = Stage(frames, columns, asked.recruits[i], asked.body.masses, asked.motion)
        tasks.append(asked.constraints[i].task(asked.targets[i], stage))
    return (tasks[0], None) if len(tasks) == 1 else mean_task(tasks, [asked.constraints[i].weight for i in which])
