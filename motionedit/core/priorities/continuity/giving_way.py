"""Giving way: goals that are out of reach become goals that can be reached, from the most important layer down.

A constraint that is missed asks for what cannot be had: every frame goes as far as it can, and the motion stops dead
where that ends. So there its goal becomes the path on which the edit itself, smoothed, comes near to it, blended into
what was asked for over some time before and after; and it is soft, |e|^2 + lambda^2 |z|^2 being made least instead of
|e|^2 alone. A layer's goals are made so with the layers above it alone: what is below it has no say.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.agreeing import overruled
from motionedit.core.priorities.continuity.shares import shares_of
from motionedit.core.priorities.continuity.smoothing import in_passes
from motionedit.core.priorities.continuity.straight import MISSED, bent_where_missed
from motionedit.core.priorities.frames import Known, run_of, solve_from, solve_from_input
from motionedit.core.priorities.ramps import ending_in
from motionedit.core.priorities.targets import lefts_of, toward
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run, Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.settings import Passes

# lambda^2 of a constraint that gives way, (m/rad)^2.
_SOFTNESS = 0.12**2
# Once its path is found it is kept to it by so much less softness, or what is below it would shift it.
_KEPT = 0.01
# Seconds over which it begins to give way, and ceases to.
_RAMP = 0.3
# Its path is smoother than an edit is, by so much of the passes' sigma.
_SMOOTHER = 1.5


@dataclass(frozen=True, eq=False)
class Reached:
    """An edit whose goals can be reached: how it is solved, and its smooth solution.

    `along` has those of the layers down to each that gave way and has others below it, by priority: before they are
    passed over toward their paths.
    """

    run: Run
    state: Solved
    along: Mapping[int, Solved]


def within_reach(run: Run, state: Solved, smoothing: Passes) -> Reached:
    """Return an edit with goals that can be reached, and its smooth solution, from the solution of what was asked."""
    asked, along = run.asked, {}
    is_met = np.maximum.reduce(state.left, axis=None, initial=0.0) < MISSED
    for place, level in enumerate([] if is_met else asked.levels):
        # A frame in which anything is missed is not solved on with limits: how far those reach shows without it.
        unsure = state.left[:, place if not asked.body.limits else slice(place, None)]
        unsure = np.atleast_2d(unsure.T).max(axis=0) >= MISSED
        if not unsure.any():
            continue
        here = down_to(level, asked)
        above = asked.only(here)
        members = members_of(level, above)
        if level == asked.levels[-1]:
            missed = _missed(asked, [here[k] for k in members], state.motion)
        else:
            # What is below may have led it astray: whether it is out of reach shows without.
            part, known = run_of(above), Known(~unsure, state.ranks[:, : len(above.levels)])
            alone = solve_from_input(part, known)
            missed = _missed(above, members, bent_where_missed(part, alone).motion) & unsure
        if not missed.any():
            continue
        above, along[level] = given_way(above, dict(zip(members, missed, strict=True)), smoothing)
        asked = with_paths(asked, above, here)
        run = run_of(asked)
        if smoothing.count and level == asked.levels[-1]:
            state = along.pop(level)
        else:
            start = along[level].motion
            state = bent_where_missed(run, solve_from(run, start))
    return Reached(run, in_passes(run, state, smoothing), along)


def down_to(level: int, asked: Asked) -> list[int]:
    """Return the constraints of a priority and of those above it."""
    return [i for i, each in enumerate(asked.constraints) if each.priority >= level]


def members_of(level: int, asked: Asked) -> list[int]:
    """Return the constraints of a priority."""
    return [i for i, each in enumerate(asked.constraints) if each.priority == level]


def _missed(asked: Asked, which: list[int], motion: Motion) -> BoolArray:
    """Return where a motion misses some of the constraints that nothing overrules there, shape (len(which), F)."""
    missed = np.array(lefts_of(asked.only(which), motion)) > MISSED
    asks: BoolArray = missed & ~overruled(asked.constraints, asked.targets, len(motion))[:, which].T
    return asks


def given_way(
    above: Asked,
    missed: Mapping[int, BoolArray],
    smoothing: Passes,
    *,
    further: float = 1.0,
    start: Motion | None = None,
) -> tuple[Asked, Solved]:
    """Return what is asked of a motion with paths that can be reached for constraints that are missed at frames (F,).

    These are the last of its layers. The smooth solution that the paths are those of is returned, too.

    Parameters
    ----------
    further : float
        So many times smoother the paths are, and lambda so many times larger.
    """
    motion, original = above.motion, above.targets
    ramp = max(1, round(_RAMP / motion.frame_time))
    shares = {k: shares_of(frames, ramp, _changes(above, k)) for k, frames in missed.items() if frames.any()}
    soft = _unled(_softened(above, shares, _SOFTNESS * further**2), shares)

    def aimed(smooth: Motion) -> Run:
        return run.aimed_at(toward(soft, original, shares, smooth))

    run = run_of(soft)
    state = solve_from_input(run) if start is None else solve_from(run, start)
    state = in_passes(run, state, replace(smoothing, sigma=_SMOOTHER * further * smoothing.sigma), aimed=aimed)
    everywhere = {k: np.ceil(share) for k, share in shares.items()}
    led = ending_in(above, state.ends, shares)
    targets = toward(soft, led.targets, everywhere, state.motion)
    without = {k: share for k, share in shares.items() if targets[k] is led.targets[k]}
    kept = _softened(replace(led, targets=targets), shares, _KEPT * _SOFTNESS)
    return _softened(kept, without, _SOFTNESS), state


def _softened(asked: Asked, shares: Mapping[int, FloatArray], softness: float) -> Asked:
    """Return constraints made soft by their shares, shape (F,), and those that are so already."""
    soft = list(asked.softness)
    for k, share in shares.items():
        now = asked.softness[k]
        soft[k] = softness * share**2 if now is None else np.maximum(now, softness * share**2)
    return replace(asked, softness=tuple(soft))


def _unled(asked: Asked, shares: Mapping[int, FloatArray]) -> Asked:
    """Return what is asked with ramps that are led as far as paths have not taken their place, by shares (F,)."""
    ramps = list(asked.ramps)
    for k, share in shares.items():
        ramps[k] = tuple(replace(ramp, left=ramp.left * (1.0 - share)) for ramp in ramps[k])
    return replace(asked, ramps=tuple(ramps))


def _changes(above: Asked, k: int) -> list[int]:
    """Return the frames at which a constraint, or one that it gives way to, begins or has ended within the clip.

    Nothing was out of reach until then, and what begins there begins where the others are.
    """
    own = above.constraints[k].priority
    spans = [t for c, t in zip(above.constraints, above.targets, strict=True) if c.priority >= own]
    begun = {t.first for t in spans if t.first > above.body.first}
    return sorted(begun | {t.last + 1 for t in spans if t.last + 1 < len(above.motion)})


def with_paths(asked: Asked, above: Asked, here: list[int]) -> Asked:
    """Return what is asked with the targets, softness and ramps of some of its constraints, `here`, replaced."""
    targets, softness, ramps = list(asked.targets), list(asked.softness), list(asked.ramps)
    for k, i in enumerate(here):
        targets[i], softness[i], ramps[i] = above.targets[k], above.softness[k], above.ramps[k]
    return replace(asked, targets=tuple(targets), softness=tuple(softness), ramps=tuple(ramps))
