"""Calming: where a viewer would see an edit step or jerk, what need not be met gives way further.

Layer by layer from the top: what a layer brings, and is not there without it, that layer is to blame for. What is below
a layer has no say, and the most important one yields to nothing. Where that does not calm a layer it is done again, by
more and along smoother paths.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.continuity.giving_way import down_to, given_way, members_of, with_paths
from motionedit.core.priorities.continuity.smoothing import in_passes
from motionedit.core.priorities.continuity.straight import bent_where_missed
from motionedit.core.priorities.continuity.visible import Seen, seen_of
from motionedit.core.priorities.frames import run_of, solve_from_input
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.priorities.continuity.giving_way import Reached
    from motionedit.core.priorities.frames import Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.settings import Passes

# How far what yields gives way: one after the other, while a viewer would see something.
_FURTHER = (1.0, 2.0, 4.0)
# From so many times the input's jerk on passes are tried with a root that is so much less mobile.
_UNSTEADY, _FIRM = 1.15, 0.4
# Times what was seen before that a layer is to blame for, and of the least that is seen that is seen plainly.
_MORE, _PLAINLY = 1.1, 1.2


def calmed(found: Reached, smoothing: Passes) -> Solved:
    """Return an edit's solution in which what need not be met gives way where a viewer would see something."""
    seen = seen_of(found.run, found.state.motion, steps=found.state.steps)
    layers = _Layers(found.run.asked, found.state, seen)
    calm = _steadied(_calmed(found, layers, smoothing) if seen.much.any() else layers, smoothing)
    calm.state.poses = calm.seen.poses
    return calm.state


def _calmed(found: Reached, last: _Layers, smoothing: Passes) -> _Layers:
    """Return the layers of an edit, `last` being all of them, in which what need not be met gives way."""
    asked = last.asked
    before = np.zeros(len(asked.motion))
    for level in asked.levels:
        here = down_to(level, asked)
        above = asked.only(here)
        # As long as nothing has given way further, layers are what they would be if there were none below them.
        is_as_found = asked is last.asked
        if is_as_found and level == asked.levels[-1]:
            layers = last
        elif is_as_found and level in found.along:
            layers = _smooth(above, found.along[level], smoothing)
        else:
            layers = _solved(above, smoothing)
        if level != asked.levels[0]:
            calm = _calmest(layers, members_of(level, above), before, smoothing)
            asked = asked if calm is layers else with_paths(asked, calm.asked, here)
            layers = calm
        before = np.maximum(before, layers.seen.much)
    return layers


@dataclass(frozen=True, eq=False)
class _Layers:
    """Some layers, the most important ones: what they ask for, their smooth solution, and what a viewer sees of it."""

    asked: Asked
    state: Solved
    seen: Seen

    def beyond(self, before: FloatArray) -> FloatArray:
        """Return how much is seen that was not before, shape (F,)."""
        much = self.seen.much
        return np.where(much > _MORE * before, much, 0.0)


def _steadied(layers: _Layers, smoothing: Passes) -> _Layers:
    """Return the same layers as they are, or passed once more with a root that shifts less, which may jerk less.

    Passes correct little, frame by frame, and what the root corrects all joints do.
    """
    body = layers.asked.body
    if layers.seen.jerk < _UNSTEADY or body.mobility is None:
        return layers
    firm = replace(layers.asked, body=replace(body, root_mobility=_FIRM * body.root_mobility))
    # Passes use up the motion that they are given.
    new = _smooth(firm, replace(layers.state, motion=layers.state.motion.copied()), smoothing)
    is_steadier = new.seen.jerk < layers.seen.jerk and new.seen.much.max() <= layers.seen.much.max()
    return new if is_steadier else layers


def _calmest(layers: _Layers, members: list[int], before: FloatArray, smoothing: Passes) -> _Layers:
    """Return the calmest of some layers whose last one's `members` give way where it is to blame.

    It is not for how much was seen before, without it, shape (F,).
    """
    calmest, least = layers, np.inf
    for further in (*_FURTHER, None):
        new = layers.beyond(before)
        unrest = float(new @ new)
        if unrest < least:
            calmest, least = layers, unrest
        yielding = {k: _yielding(layers.asked, k, new) for k in members}
        if further is None or not any(frames.any() for frames in yielding.values()):
            break
        layers = _smooth(
            *given_way(layers.asked, yielding, smoothing, further=further, start=layers.state.motion), smoothing
        )
    return calmest


def _solved(asked: Asked, smoothing: Passes) -> _Layers:
    run = run_of(asked)
    return _smooth(asked, bent_where_missed(run, solve_from_input(run)), smoothing)


def _smooth(asked: Asked, state: Solved, smoothing: Passes) -> _Layers:
    run = run_of(asked)
    state = in_passes(run, state, smoothing)
    return _Layers(asked, state, seen_of(run, state.motion, steps=state.steps))


def _yielding(asked: Asked, k: int, much: FloatArray) -> BoolArray:
    """Return the frames at which a constraint is not insisted on where so much is seen, shape (F,).

    Nobody counts on it, and that is seen plainly; or it has given way.
    """
    frames, soft, span = np.zeros(len(much), dtype=np.bool_), asked.softness[k], asked.targets[k].span
    if asked.constraints[k].yields:
        frames[span] = much[span] > _PLAINLY
    if soft is not None:
        frames[span] |= (much[span] > 0.0) & (soft[span] > 0.0)
    return frames
