"""Calming: where a viewer would see an edit step or jerk, what need not be met gives way further.

Layer by layer from the top: what a layer brings, and is not there without it, that layer is to blame for. What is below
a layer has no say, and the most important one yields to nothing. Where that does not calm the edit it is done again, by
more and along smoother paths.
"""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.frames import run_of, solve_from_input
from motionedit.core.priorities.giving_way import Reached, down_to, given_way, members_of, with_paths
from motionedit.core.priorities.smoothing import in_passes
from motionedit.core.priorities.straight import bent_where_missed
from motionedit.core.priorities.visible import is_seen_at, unrest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray
    from motionedit.core.priorities.frames import Run, Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.settings import Passes

# How far what yields gives way: one after the other, while a viewer would see something.
_FURTHER = (1.0, 2.0, 4.0)


def calmed(found: Reached, smoothing: Passes) -> Solved:
    """Return the calmest of an edit's solutions, in which what need not be met gives way where a viewer sees it."""
    best, looks = found.state, _Looks(smoothing)
    least = unrest(found.run, best.motion)
    for further in _FURTHER:
        if not any(least):
            break
        looks.add(found)
        asked = _yielding(found.run.asked, looks, further)
        if asked is found.run.asked:
            break
        run = run_of(asked)
        found = Reached(run, _solved(run, smoothing))
        seen = unrest(run, found.state.motion)
        if seen < least:
            best, least = found.state, seen
    return best


class _Looks:
    """At which frames a viewer sees the solutions of what was asked, each of which is found and looked at once."""

    def __init__(self, smoothing: Passes) -> None:
        self.smoothing = smoothing
        self._seen: list[tuple[Asked, BoolArray]] = []

    def add(self, found: Reached) -> BoolArray:
        """Look at a solution, shape (F,)."""
        seen = is_seen_at(found.run, found.state.motion)
        self._seen.append((found.run.asked, seen))
        return seen

    def at(self, asked: Asked) -> BoolArray:
        """Return the frames at which something is seen of what is asked, shape (F,)."""
        for known, seen in self._seen:
            if _is_same(known.targets, asked.targets) and _is_same(known.softness, asked.softness):
                return seen
        run = run_of(asked)
        return self.add(Reached(run, _solved(run, self.smoothing)))


def _is_same(one: Sequence[object], other: Sequence[object]) -> bool:
    return len(one) == len(other) and all(map(operator.is_, one, other))


def _yielding(asked: Asked, looks: _Looks, further: float) -> Asked:
    """Return what is asked with paths where it is to blame, for what yields and for what is missed anyway."""
    before = np.zeros(len(asked.motion), dtype=np.bool_)
    for level in asked.levels:
        here = down_to(level, asked)
        above = asked.only(here)
        seen = looks.at(above)
        new, before = seen & ~before, seen
        if level == asked.levels[0]:
            continue
        yielding = {k: new & _may_yield(above, k) for k in members_of(level, above)}
        if any(frames.any() for frames in yielding.values()):
            asked = with_paths(asked, given_way(above, yielding, looks.smoothing, further=further), here)
    return asked


def _solved(run: Run, smoothing: Passes) -> Solved:
    """Return the smooth solution of an edit."""
    return in_passes(run, bent_where_missed(run, solve_from_input(run)), smoothing)


def _may_yield(asked: Asked, k: int) -> BoolArray:
    """Return the frames at which a constraint need not be met: nobody counts on it, or it has given way, shape (F,)."""
    frames, soft = np.zeros(len(asked.motion), dtype=np.bool_), asked.softness[k]
    span = asked.targets[k].span
    if asked.constraints[k].yields:
        frames[span] = True
    elif soft is not None:
        frames[span] = soft[span] > 0.0
    return frames
