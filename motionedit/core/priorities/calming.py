"""Calming: where a viewer would see an edit step or jerk, what need not be met gives way further.

Layer by layer from the top: what a layer brings, and is not there without it, that layer is to blame for. What is below
a layer has no say, and the most important one yields to nothing. Where that does not calm a layer it is done again, by
more and along smoother paths.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.frames import run_of, solve_from_input
from motionedit.core.priorities.giving_way import down_to, given_way, members_of, with_paths
from motionedit.core.priorities.smoothing import in_passes
from motionedit.core.priorities.straight import bent_where_missed
from motionedit.core.priorities.visible import Seen, seen_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray
    from motionedit.core.priorities.frames import Solved
    from motionedit.core.priorities.giving_way import Reached
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.settings import Passes

# How far what yields gives way: one after the other, while a viewer would see something.
_FURTHER = (1.0, 2.0, 4.0)


def calmed(found: Reached, smoothing: Passes) -> Solved:
    """Return an edit's solution in which what need not be met gives way where a viewer would see something."""
    seen = seen_of(found.run, found.state.motion)
    if not seen.anything:
        return found.state
    last, asked = _Layers(found.run.asked, found.state, seen), found.run.asked
    before = np.zeros(len(asked.motion), dtype=np.bool_)
    for level in asked.levels:
        here = down_to(level, asked)
        above = asked.only(here)
        is_last = asked is last.asked and level == asked.levels[-1]
        layers = last if is_last else _solved(above, smoothing)
        if level != asked.levels[0]:
            calm = _calmest(layers, members_of(level, above), before, smoothing)
            asked = asked if calm is layers else with_paths(asked, calm.asked, here)
            layers = calm
        before |= layers.seen.frames
    return layers.state


@dataclass(frozen=True, eq=False)
class _Layers:
    """Some layers, the most important ones: what they ask for, their smooth solution, and what a viewer sees of it."""

    asked: Asked
    state: Solved
    seen: Seen


def _calmest(layers: _Layers, members: list[int], before: BoolArray, smoothing: Passes) -> _Layers:
    """Return the calmest of some layers whose last one's `members` give way where it is to blame.

    It is not for what is seen of those above it at the frames `before`, shape (F,).
    """
    calmest = layers
    for further in _FURTHER:
        new = layers.seen.frames & ~before
        yielding = {k: new & _may_yield(layers.asked, k) for k in members}
        if not any(frames.any() for frames in yielding.values()):
            break
        layers = _solved(given_way(layers.asked, yielding, smoothing, further=further), smoothing)
        if layers.seen.most(~before) < calmest.seen.most(~before):
            calmest = layers
    return calmest


def _solved(asked: Asked, smoothing: Passes) -> _Layers:
    run = run_of(asked)
    state = in_passes(run, bent_where_missed(run, solve_from_input(run)), smoothing)
    return _Layers(asked, state, seen_of(run, state.motion))


def _may_yield(asked: Asked, k: int) -> BoolArray:
    """Return the frames at which a constraint need not be met: nobody counts on it, or it has given way, shape (F,)."""
    frames, soft = np.zeros(len(asked.motion), dtype=np.bool_), asked.softness[k]
    span = asked.targets[k].span
    if asked.constraints[k].yields:
        frames[span] = True
    elif soft is not None:
        frames[span] = soft[span] > 0.0
    return frames
