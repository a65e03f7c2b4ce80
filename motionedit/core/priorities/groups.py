"""Groups of frames: where the same constraints are active, frames are one problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.kinds.constraint import Stage
from motionedit.core.priorities.points import Columns
from motionedit.core.priorities.problem import HingeColumns, Problem, WeightedTask, order_of_layers
from motionedit.core.priorities.solver import Prepared, prepare_problem
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import IntArray
    from motionedit.core.body.hinges import Hinge
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Constraint, Targets
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.settings import Body, LayeredSettings


@dataclass(frozen=True, eq=False)
class Asked:
    """All that is asked of a motion: each constraint, what it may move, and where its task shall be."""

    motion: Motion
    constraints: tuple[Constraint, ...]
    recruits: tuple[Recruits, ...]
    targets: tuple[Targets, ...]
    body: Body
    settings: LayeredSettings

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
    prepared : Prepared
        The problem, ready to be solved.
    """

    frames: IntArray
    levels: IntArray
    prepared: Prepared

    @property
    def problem(self) -> Problem:
        """What is solved in its frames."""
        return self.prepared.problem


def groups_of(asked: Asked) -> tuple[Group, ...]:
    """Return the frames at which anything is active, together where the same constraints are."""
    active = np.zeros((len(asked.motion), len(asked.constraints)), dtype=np.bool_)
    for i, each in enumerate(asked.targets):
        active[each.span, i] = True
    together: dict[tuple[bool, ...], list[IntArray]] = {}
    for run in np.split(np.arange(len(active)), np.flatnonzero((active[1:] != active[:-1]).any(axis=1)) + 1):
        together.setdefault(tuple(active[run[0]].tolist()), []).append(run)
    return tuple(
        _group(asked, [i for i, there in enumerate(key) if there], np.concatenate(together[key]))
        for key in sorted(together)
        if any(key)
    )


def part_of(asked: Asked, group: Group, frames: IntArray) -> Group:
    """Return a group of some of a group's frames."""
    if len(frames) == len(group.frames):
        return group
    members = [i for i, each in enumerate(asked.targets) if each.first <= frames[0] <= each.last]
    return _group(asked, members, frames)


def spans_of(frames: IntArray) -> list[IntArray]:
    """Return frames cut where they do not follow each other."""
    return np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1)


def _group(asked: Asked, members: Sequence[int], frames: IntArray) -> Group:
    joints = np.array(sorted(set().union(*(asked.recruits[i].joints for i in members))), dtype=np.intp)
    columns = Columns(asked.motion.skeleton, joints, asked.body.travel)
    priorities = order_of_layers([asked.constraints[i].priority for i in members])
    layers = [
        tuple(_task(asked, i, frames, columns) for i in members if asked.constraints[i].priority == priority)
        for priority in priorities
    ]
    problem = Problem(
        columns=columns,
        moves_root=any(asked.recruits[i].root for i in members),
        layers=tuple(layers),
        hinges=_hinge_columns(asked.body.hinges, joints),
        attraction=asked.settings.attraction,
        max_iterations=asked.settings.max_iterations,
    )
    levels = asked.levels
    return Group(frames, np.array([levels.index(priority) for priority in priorities]), prepare_problem(problem))


def _task(asked: Asked, i: int, frames: IntArray, columns: Columns) -> WeightedTask:
    constraint = asked.constraints[i]
    stage = Stage(frames, columns, asked.recruits[i], asked.body.masses, asked.motion)
    return WeightedTask(constraint.task(asked.targets[i], stage), constraint.weight)


def _hinge_columns(hinges: Sequence[Hinge], joints: IntArray) -> HingeColumns:
    """Return the hinges among the columns, which are `joints`."""
    here = [hinge for hinge in hinges if hinge.joint in set(map(int, joints))]
    return HingeColumns(
        places=np.searchsorted(joints, np.array([hinge.joint for hinge in here], dtype=np.intp)),
        axes=np.array([hinge.axis for hinge in here]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in here]).reshape(-1, 2),
        second=np.array([hinge.is_second for hinge in here], dtype=np.bool_),
    )
