"""A solution smoothed and solved again, pass by pass: the default's continuity in time ([PRIO] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.displacement import smoothed_displacement
from motionedit.core.priorities.continuity.shares import shares_of
from motionedit.core.priorities.continuity.visible import steps_at
from motionedit.core.priorities.frames import Known, known_again, left_alone, solve_frames
from motionedit.core.priorities.ramps import ends_in, led_frames, led_to
from motionedit.core.priorities.targets import toward
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.frames import Run, Solved
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.ramps import Ends
    from motionedit.core.priorities.settings import Passes

# A change that steps gets more passes, this many at most, around its frames, blended in over so many seconds,
_MORE_PASSES, _RAMP = 8, 0.6
# this many where what is solved is a way to a path alone: more of them lead it astray,
_MORE_ON_THE_WAY = 3
# and no more once so many of them have hardly helped.
_PATIENCE, _PROGRESS = 3, 0.95
# lambda^2 of a goal that is half eased in them, (m/rad)^2.
_HARDLY_SOFT = 1e-3


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
        alone = left_alone(run, state) if aimed is None else None
        # Of a long motion no more copies are kept than are needed, not by those who called, either.
        before, state.motion = state.motion, motion
        smooth = smoothed_displacement(motion, before, sigma=smoothing.sigma, first=first, hinges=hinges, use_up=True)
        del before
        known = None if alone is None else known_again(run, alone, smooth)
        now = run if aimed is None else aimed(smooth)
        # Smoothing rounds off where a ramp ends, until the last pass.
        state = _solved(now, smooth, known) if left else _led(now, smooth, known)
        del smooth
    found, share = [np.inf] * _PATIENCE, np.ones(len(motion))
    most = _MORE_PASSES if aimed is None else _MORE_ON_THE_WAY
    for more in range(most + 1 if smoothing.count else 0):
        steps = steps_at(run, state.motion, within=share)
        state.steps = None if more else steps  # of all frames
        largest = float(steps.max(initial=0.0))
        if largest == 0.0 or more == most or largest > _PROGRESS * found[-_PATIENCE]:
            break
        found.append(largest)
        share = shares_of(steps > 0.0, max(1, round(_RAMP / motion.frame_time)))
        smooth = smoothed_displacement(motion, state.motion, sigma=smoothing.sigma, first=first, hinges=hinges)
        smooth = _between(state.motion, smooth, share)
        known = Known(share == 0.0, state.ranks)
        state = _led(
            run if aimed is None else aimed(smooth), smooth, known, PassedBefore(state.ends, state.motion, share)
        )
    return state


def _solved(run: Run, smooth: Motion, known: Known | None) -> Solved:
    return solve_frames(run, smooth, reference=smooth, pull_root=True, known=known, in_place=True)


@dataclass(frozen=True, eq=False)
class PassedBefore:
    """A solution that is solved on: where its ramps ended, its motion, and how much of each frame is, shape (F,)."""

    ends: Ends | None
    motion: Motion
    share: FloatArray

    def eased(self, run: Run) -> Run:
        """Return an edit whose soft goals are where the motion has them as far as the share, shape (F,), is not 1.

        Each solve goes on toward soft goals: a frame solved once more would be off one beside it that is not. Goals
        that are hardly soft are kept, or what is below them would take them along.
        """
        softness = enumerate(run.asked.softness)
        much = {k: soft**2 / (soft**2 + _HARDLY_SOFT**2) for k, soft in softness if soft is not None}
        shares = {k: (1.0 - self.share) * each for k, each in much.items()}
        return run.aimed_at(toward(run.asked, run.asked.targets, shares, self.motion))


def _led(run: Run, smooth: Motion, known: Known | None, before: PassedBefore | None = None) -> Solved:
    """Return a smoothed solution solved again, the frames outside of ramps first, and ramps led to them.

    Frames that are known need something all the same where ramps do not end where they did `before`.
    """
    asked, ends, led = run.asked, None, run
    outside = sorted({ramp.outside for ramps in asked.ramps for ramp in ramps})
    alone = Known(np.ones(len(smooth), dtype=np.bool_), np.zeros((len(smooth), len(asked.levels)), dtype=np.intp))
    alone.done[outside] = False
    # Where one begins within the ramp of another, that is led first.
    for _ in range(2 if _are_chained(asked, outside) else min(len(outside), 1)):
        kept = smooth.rotations[outside], smooth.translations[outside]
        ends = ends_in(asked, _solved(led if before is None else before.eased(led), smooth, alone).motion)
        smooth.rotations[outside], smooth.translations[outside] = kept
        led = run.aimed_at(led_to(asked, ends))
    if before is not None and before.ends is not None and known is not None and ends is not None:
        known = Known(known.done & ~led_frames(asked, before.ends, ends), known.ranks)
    state = _solved(led if before is None else before.eased(led), smooth, known)
    state.ends = ends
    return state


def _are_chained(asked: Asked, outside: list[int]) -> bool:
    return any(ramp.left[outside].any() for ramps in asked.ramps for ramp in ramps)


def _between(one: Motion, other: Motion, share: FloatArray) -> Motion:
    """Return a motion on the way from one to another, so much of it at every frame, shape (F,)."""
    rotations, frames = one.rotations.copy(), np.flatnonzero(share)
    mine, theirs, part = one.rotations[frames], other.rotations[frames], share[frames, None, None]
    turn = rot.log(rot.multiply(theirs, rot.conjugate(mine)))
    rotations[frames] = rot.multiply(rot.exp(part * turn), mine)
    translations = one.translations + share[:, None, None] * (other.translations - one.translations)
    return Motion(one.skeleton, rotations, translations, one.frame_time)
