"""A solution smoothed and solved again, pass by pass: the default's continuity in time ([PRIO] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity import smoothed_displacement
from motionedit.core.priorities.frames import Known, known_after, solve_frames
from motionedit.core.priorities.ramps import ends_in, led_frames, led_to
from motionedit.core.priorities.shares import shares_of
from motionedit.core.trace import frame_blocks

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.frames import Run, Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.ramps import Ends
    from motionedit.core.priorities.settings import Passes

# Radians a frame at 60 frames a second: a viewer sees 10 degrees. A change that steps further gets more passes,
_STEP, _RATE = float(np.radians(8.0)), 60.0
# this many at most, around its frames, blended in over so many seconds.
_MORE_PASSES, _RAMP = 8, 0.6
# and no more once so many of them have hardly helped.
_PATIENCE, _PROGRESS = 3, 0.95


def in_passes(run: Run, state: Solved, smoothing: Passes, *, aimed: Callable[[Motion], Run] | None = None) -> Solved:
    """Return a solution smoothed and solved again in all passes, and in more around frames whose change steps.

    The solution that is given is used up: it lets go of its motion.

    Parameters
    ----------
    aimed : callable, optional
        Returns what is solved in a pass from its smoothed motion; default: the run itself.
    """
    motion, first, hinges = run.motion, run.asked.body.first, run.asked.body.hinges
    for left in reversed(range(smoothing.count)):
        smooth = smoothed_displacement(motion, state.motion, sigma=smoothing.sigma, first=first, hinges=hinges)
        known = known_after(run, state, smooth) if aimed is None else None
        state.motion = motion  # of a long one no more copies are kept than are needed, not by those who called, too
        now = run if aimed is None else aimed(smooth)
        # Smoothing rounds off where a ramp ends, until the last pass.
        state = _solved(now, smooth, known) if left else _led(now, smooth, known)
        del smooth
    found, share = [np.inf] * _PATIENCE, np.ones(len(motion))
    for more in range(_MORE_PASSES + 1 if smoothing.count else 0):
        steps = steps_at(run, state.motion, within=share)
        largest = float(steps.max(initial=0.0))
        state.steps = largest > 0.0
        if largest == 0.0 or more == _MORE_PASSES or largest > _PROGRESS * found[-_PATIENCE]:
            break
        found.append(largest)
        share = shares_of(steps > 0.0, max(1, round(_RAMP / motion.frame_time)))
        smooth = smoothed_displacement(motion, state.motion, sigma=smoothing.sigma, first=first, hinges=hinges)
        smooth = _between(state.motion, smooth, share)
        known = Known(share == 0.0, state.ranks)
        state = _led(run if aimed is None else aimed(smooth), smooth, known, state.ends)
    return state


def _solved(run: Run, smooth: Motion, known: Known | None) -> Solved:
    return solve_frames(run, smooth, reference=smooth, pull_root=True, known=known)


def _led(run: Run, smooth: Motion, known: Known | None, before: Ends | None = None) -> Solved:
    """Return a smoothed solution solved again, the frames outside of ramps first, and ramps led to them.

    Frames that are known need something all the same where ramps do not end where they did `before`.
    """
    asked, ends = run.asked, None
    outside = sorted({ramp.outside for ramps in asked.ramps for ramp in ramps})
    alone = Known(np.ones(len(smooth), dtype=np.bool_), np.zeros((len(smooth), len(asked.levels)), dtype=np.intp))
    alone.done[outside] = False
    # Where one begins within the ramp of another, that is led first.
    for _ in range(2 if _are_chained(asked, outside) else min(len(outside), 1)):
        ends = ends_in(asked, _solved(run, smooth, alone).motion)
        run = run.aimed_at(led_to(asked, ends))
    if known is not None and ends is not None and before is not None:
        known = Known(known.done & ~led_frames(asked, before, ends), known.ranks)
    state = _solved(run, smooth, known)
    state.ends = ends
    return state


def _are_chained(asked: Asked, outside: list[int]) -> bool:
    return any(ramp.left[outside].any() for ramps in asked.ramps for ramp in ramps)


def steps_at(run: Run, after: Motion, *, within: FloatArray | None = None) -> FloatArray:
    """Return the largest step of a joint's change into or out of each frame, rad, shape (F,).

    0 where none is larger than is allowed, and than the joint's own largest step in the input.

    Parameters
    ----------
    within : shape (F,), optional
        Only steps among the frames at which it is not 0 are looked for.
    """
    before, first = run.motion, run.asked.body.first
    limit = _STEP * before.frame_time * _RATE
    found = np.zeros(len(before))
    looked = np.arange(first, len(before)) if within is None else first + np.flatnonzero(within[first:])
    start, stop = (int(looked[0]), int(looked[-1]) + 1) if len(looked) else (0, 0)
    for block in frame_blocks(stop - start):
        frames = slice(start + block.start, min(start + block.stop + 1, stop))
        # All joints: to pick some would cost more than what is known of the others.
        change = rot.multiply(rot.conjugate(before.rotations[frames]), after.rotations[frames])
        # A cosine of half the step costs less than the step, and nearly all are let off by it.
        far = np.abs(np.einsum("fji,fji->fj", change[:-1], change[1:])) < np.cos(0.5 * limit)
        for joint in np.flatnonzero(far.any(axis=0)):
            steps = rot.angle_between(change[:-1, joint], change[1:, joint])
            q = before.rotations[first:, joint]
            steps[steps <= max(limit, float(rot.angle_between(q[:-1], q[1:]).max()))] = 0.0
            for side in (slice(frames.start, frames.stop - 1), slice(frames.start + 1, frames.stop)):
                found[side] = np.maximum(found[side], steps)
    return found


def _between(one: Motion, other: Motion, share: FloatArray) -> Motion:
    """Return a motion on the way from one to another, so much of it at every frame, shape (F,)."""
    rotations, frames = one.rotations.copy(), np.flatnonzero(share)
    mine, theirs, part = one.rotations[frames], other.rotations[frames], share[frames, None, None]
    turn = rot.log(rot.multiply(theirs, rot.conjugate(mine)))
    rotations[frames] = rot.multiply(rot.exp(part * turn), mine)
    translations = one.translations + share[:, None, None] * (other.translations - one.translations)
    return Motion(one.skeleton, rotations, translations, one.frame_time)
