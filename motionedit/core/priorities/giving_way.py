"""Giving way: goals that are out of reach become goals that can be reached, from the most important layer down.

A constraint that is missed asks for what cannot be had: every frame goes as far as it can, and the motion stops dead
where that ends. So there its goal becomes the path on which the edit itself, smoothed, comes near to it, blended into
what was asked for over some time before and after; and it is soft, |e|^2 + lambda^2 |z|^2 being made least instead of
|e|^2 alone. A layer's goals are made so with the layers above it alone: what is below it has no say.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.frames import Known, run_of, solve_from_input
from motionedit.core.priorities.kinds.constraint import between
from motionedit.core.priorities.shares import shares_of
from motionedit.core.priorities.smoothing import in_passes, steps_at
from motionedit.core.priorities.straight import bent_where_missed
from motionedit.core.priorities.targets import lefts_of, reached_within
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run, Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import Targets
    from motionedit.core.priorities.settings import Passes

# Metres or radians: what is farther from its goal is missed.
MISSED = 1e-4
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
    """An edit whose goals can be reached: how it is solved, and its smooth solution."""

    run: Run
    state: Solved


def within_reach(run: Run, state: Solved, smoothing: Passes) -> Reached:
    """Return an edit with goals that can be reached, and its smooth solution, from the solution of what was asked."""
    asked = run.asked
    for level in asked.levels:
        if state.left[:, asked.levels.index(level)].max(initial=0.0) < MISSED:
            continue
        here = _down_to(level, asked)
        above = asked.only(here)
        members = _members(level, above)
        missed = _missed(asked, [here[k] for k in members], state.motion)
        if missed.any() and level != asked.levels[-1]:
            # What is below may have led it astray: whether it is out of reach shows without.
            part, known = run_of(above), Known(~np.any(missed, axis=0), state.ranks[:, : len(above.levels)])
            alone = solve_from_input(part, known)
            missed &= _missed(above, members, bent_where_missed(part, alone).motion)
        if not missed.any():
            continue
        above = _given_way(above, dict(zip(members, missed, strict=True)), smoothing)
        asked = _with_paths(asked, above, here)
        run = run_of(asked)
        state = bent_where_missed(run, solve_from_input(run))
    return Reached(run, in_passes(run, state, smoothing))


def without_steps(found: Reached, smoothing: Passes) -> Solved:
    """Return a solution in which constraints that yield do so where meeting them makes the motion step.

    Layer by layer from the top: what steps with a layer, and does not without it, that layer is to blame for. The most
    important one yields to nothing. What is below a layer has no say here either.
    """
    run, asked = found.run, found.run.asked
    before = np.zeros(len(run.motion), dtype=np.bool_)
    for level in asked.levels:
        here = _down_to(level, asked)
        above = asked.only(here)
        unchanged = asked is run.asked and level == asked.levels[-1]
        steps = steps_at(run, (found.state if unchanged else _solved(run_of(above), smoothing)).motion) > 0.0
        new, before = steps & ~before, steps
        members = [k for k in _members(level, above) if above.constraints[k].yields and level != asked.levels[0]]
        stepping = {k: _within(new, above.targets[k]) for k in members}
        if any(frames.any() for frames in stepping.values()):
            asked = _with_paths(asked, _given_way(above, stepping, smoothing), here)
    return found.state if asked is run.asked else _solved(run_of(asked), smoothing)


def _down_to(level: int, asked: Asked) -> list[int]:
    """Return the constraints of a priority and of those above it."""
    return [i for i, each in enumerate(asked.constraints) if each.priority >= level]


def _members(level: int, asked: Asked) -> list[int]:
    """Return the constraints of a priority."""
    return [i for i, each in enumerate(asked.constraints) if each.priority == level]


def _within(frames: BoolArray, targets: Targets) -> BoolArray:
    there = np.zeros_like(frames)
    there[targets.span] = frames[targets.span]
    return there


def _solved(run: Run, smoothing: Passes) -> Solved:
    """Return the smooth solution of an edit."""
    return in_passes(run, bent_where_missed(run, solve_from_input(run)), smoothing)


def _missed(asked: Asked, which: list[int], motion: Motion) -> BoolArray:
    """Return where a motion misses some of the constraints, shape (len(which), F)."""
    missed: BoolArray = np.array(lefts_of(asked.only(which), motion)) > MISSED
    return missed


def _given_way(above: Asked, missed: Mapping[int, BoolArray], smoothing: Passes) -> Asked:
    """Return what is asked of a motion with paths that can be reached for constraints that are missed at frames (F,).

    These are the last of its layers.
    """
    motion, original = above.motion, above.targets
    ramp = max(1, round(_RAMP / motion.frame_time))
    shares = {k: shares_of(frames, ramp, _changes(above, k)) for k, frames in missed.items() if frames.any()}
    soft = _softened(above, shares, _SOFTNESS)

    def aimed(smooth: Motion) -> Run:
        return run.aimed_at(_toward(soft, original, shares, smooth))

    run = run_of(soft)
    state = solve_from_input(run)
    smoother = replace(smoothing, sigma=_SMOOTHER * smoothing.sigma)
    state = in_passes(run, state, smoother, aimed=aimed)
    everywhere = {k: np.ceil(share) for k, share in shares.items()}
    targets = _toward(soft, original, everywhere, state.motion)
    without = {k: share for k, share in shares.items() if targets[k] is original[k]}
    kept = _softened(replace(above, targets=targets), shares, _KEPT * _SOFTNESS)
    return _softened(kept, without, _SOFTNESS)


def _softened(asked: Asked, shares: Mapping[int, FloatArray], softness: float) -> Asked:
    """Return constraints made soft by their shares, shape (F,), and those that are so already."""
    soft = list(asked.softness)
    for k, share in shares.items():
        now = asked.softness[k]
        soft[k] = softness * share**2 if now is None else np.maximum(now, softness * share**2)
    return replace(asked, softness=tuple(soft))


def _toward(
    asked: Asked, original: tuple[Targets, ...], shares: Mapping[int, FloatArray], motion: Motion
) -> tuple[Targets, ...]:
    """Return targets on the way from the original ones to where a motion has them, so much of it each, shape (F,)."""
    found = list(original)
    for k, share in shares.items():
        span = original[k].span
        inside = np.flatnonzero(share[span])
        if not len(inside):
            continue
        frames = slice(int(span.start + inside[0]), int(span.start + inside[-1] + 1))
        there = reached_within(asked, k, motion, frames)
        if there is not None:
            found[k] = original[k].with_part(between(original[k].within(frames), there, share[frames]))
    return tuple(found)


def _changes(above: Asked, k: int) -> list[int]:
    """Return the frames at which a constraint, or one that it gives way to, begins or has ended within the clip.

    Nothing was out of reach until then, and what begins there begins where the others are.
    """
    own = above.constraints[k].priority
    spans = [t for c, t in zip(above.constraints, above.targets, strict=True) if c.priority >= own]
    begun = {t.first for t in spans if t.first > above.body.first}
    return sorted(begun | {t.last + 1 for t in spans if t.last + 1 < len(above.motion)})


def _with_paths(asked: Asked, above: Asked, here: list[int]) -> Asked:
    """Return what is asked with the targets and softness of some of its constraints, `here`, replaced."""
    targets, softness = list(asked.targets), list(asked.softness)
    for k, i in enumerate(here):
        targets[i], softness[i] = above.targets[k], above.softness[k]
    return replace(asked, targets=tuple(targets), softness=tuple(softness))
