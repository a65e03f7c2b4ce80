"""Where constraints switch on and off over others: their ramps lead from and to what the others make of the motion."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.agreeing import agreed
from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.frames import run_of, solve_from_input
from motionedit.core.priorities.ramps import ramps_of, task_at
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.targets import lefts_of, reached
from motionedit.core.priorities.task_targets import moved
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run
    from motionedit.core.priorities.groups import Asked, Ramp
    from motionedit.core.priorities.settings import Passes

    Members = frozenset[int]
    Ramps = tuple[tuple[Ramp, ...], ...]

# Sets of others that are solved: so many, or two for each constraint. Of many that overlap there are many more.
_SETS = 32
# Of more that are active at once, in sets of more than so many together, frames of ramps alone are solved: passes over
# all frames, set by set, would take a time that grows with the square of their number.
_AT_ONCE, _TOGETHER = 8, 150


def eased_from_others(asked: Asked, smoothing: Passes) -> Run:
    """Return what is asked, with ramps from and to where the other constraints alone have each one's task.

    In a ramp the motion that a constraint takes over is what the others make of it, not the input.
    """
    ramps = tuple(ramps_of(asked, i) for i in range(len(asked.targets)))
    return run_of(_eased(asked, ramps, frozenset(range(len(ramps))), _Alone(asked, ramps, smoothing)))


class _Alone:
    """What constraints alone make of the motion, solved once; ramps of theirs are from and to others, too, of a few."""

    def __init__(self, asked: Asked, ramps: Ramps, smoothing: Passes) -> None:
        self._asked, self._ramps, self._smoothing = asked, ramps, smoothing
        self._beside = [[_beside(asked, i, ramp) for ramp in own] for i, own in enumerate(ramps)]
        self._eased = self._sets_to_ease()
        self._wanted: dict[Members, BoolArray] = {}
        self._found: dict[Members, Motion] = {}
        self._at_ramps: dict[tuple[Members, int, int], Motion] = {}
        self._are_few = sum(map(len, frozenset(chain.from_iterable(self._beside)))) <= _TOGETHER

    def within(self, i: int, k: int, members: Members) -> Motion | None:
        """Return what the others of some constraints make of it in the k-th ramp of one; None where that is nothing."""
        ramp, others = self._ramps[i][k], self._beside[i][k] & members
        if not others:
            return None
        if others not in self._wanted:
            self._wanted[others] = _wanted(self._asked.only(sorted(others)), self._asked.motion)
        if not self._wanted[others][ramp.left > 0.0].any():
            return None
        if len(others) > _AT_ONCE and not self._are_few:
            return self._at_ramp(others, ramp)
        if others not in self._found:
            own = _eased(self._asked, self._ramps, others, self if others in self._eased else None)
            self._found[others] = solve_in_passes(run_of(own), self._smoothing).state.motion
        return self._found[others]

    def _at_ramp(self, others: Members, ramp: Ramp) -> Motion:
        """Return what some constraints make of the frames of a ramp and of the one outside, each by itself."""
        frames = np.flatnonzero(ramp.left > 0.0)
        first, last = int(min(frames[0], ramp.outside)), int(max(frames[-1], ramp.outside))
        if (others, first, last) not in self._at_ramps:
            asked = _during(self._asked.only(sorted(others)), first, last)
            self._at_ramps[others, first, last] = solve_from_input(run_of(asked)).motion
        return self._at_ramps[others, first, last]

    def _sets_to_ease(self) -> set[Members]:
        """Return which sets of constraints are eased from others: all, their others, these ones' others, while few."""
        count = len(self._ramps)
        eased: set[Members] = set()
        level = {frozenset(range(count))}
        while level:
            others = {beside & members for members in level for i in members for beside in self._beside[i]}
            others -= eased | level
            if eased and len(eased) + len(level) + len(others) > max(_SETS, 2 * count):
                break
            eased, level = eased | level, others
        return eased


def _eased(asked: Asked, ramps: Ramps, members: Members, alone: _Alone | None) -> Asked:
    """Return what some constraints ask for, with ramps from and to where the others of them `alone` have each one's.

    Those of the same task agree in their ramps.
    """
    targets, led = list(asked.targets), list(ramps)
    for i in sorted(members):
        own = list(ramps[i])
        for k, ramp in enumerate(own):
            there = None if alone is None else alone.within(i, k, members)
            if there is None:
                continue
            left = ramp.left[targets[i].span]
            targets[i] = moved(targets[i], reached(asked, i, asked.motion), reached(asked, i, there), left)
            own[k] = replace(ramp, end=task_at(asked, i, there, ramp.outside))
        led[i] = tuple(own)
    found = replace(asked, targets=tuple(targets), ramps=tuple(led)).only(sorted(members))
    return replace(found, targets=agreed(found.constraints, found.targets, len(asked.motion)))


def _during(asked: Asked, first: int, last: int) -> Asked:
    """Return what constraints ask for from a frame to another, at some of which each of them is active."""
    spans = [slice(max(each.first, first), min(each.last, last) + 1) for each in asked.targets]
    both = list(zip(asked.targets, spans, strict=True))
    arcs = tuple(
        None if arc is None else arc[span.start - each.first : span.stop - each.first]
        for arc, (each, span) in zip(asked.arcs, both, strict=True)
    )
    return replace(asked, targets=tuple(each.within(span) for each, span in both), arcs=arcs)


def _beside(asked: Asked, i: int, ramp: Ramp) -> Members:
    """Return which constraints beside one are active where a ramp of it ends."""
    active = (k for k, each in enumerate(asked.targets) if each.first <= ramp.outside <= each.last)
    return frozenset(active) - {i}


def _wanted(asked: Asked, motion: Motion) -> BoolArray:
    """Return at which frames constraints want anything that a motion does not do already, shape (F,)."""
    wanted: BoolArray = np.max(lefts_of(asked, motion), axis=0) > NO_DISPLACEMENT
    return wanted
