"""Where constraints switch on and off over others: their ramps lead from and to what the others make of the motion."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.continuity import NO_DISPLACEMENT
from motionedit.core.priorities.frames import run_of
from motionedit.core.priorities.kinds.constraint import Targets, moved
from motionedit.core.priorities.passes import Passed, solve_in_passes
from motionedit.core.priorities.targets import errors_of, reached
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.settings import Passes

# A ramp is led anew to where the edit comes from, so many times, while its end is farther from there than this: what
# begins casts its shadow before it, as passes smooth over its beginning. Metres or radians.
_ROUNDS, _APART = 5, 3e-4
# It goes further than that by so much, for where the edit comes from follows the ramp.
_FURTHER = 2.0


@dataclass(frozen=True, eq=False)
class _Ramp:
    """A ramp of constraint `i`: what is left of it at every frame, shape (F,), the frame just outside, who is there."""

    i: int
    left: FloatArray
    outside: int
    others: tuple[int, ...]


def eased_from_others(asked: Asked, smoothing: Passes) -> Run:
    """Return what is asked, with ramps from and to where the other constraints alone have each one's task.

    In a ramp the motion that a constraint takes over is what the others make of it, not the input.
    """
    motion, calm, ramps = asked.motion, False, []
    alone: dict[tuple[int, ...], Passed] = {}
    eased = asked
    for ramp in _ramps(asked):
        others = asked.only(ramp.others)
        if not _is_moved(others, motion, ramp.left > 0.0):
            continue
        if ramp.others not in alone:
            alone[ramp.others] = solve_in_passes(run_of(others), smoothing)
        passed = alone[ramp.others]
        calm = calm or passed.calmed
        before, after = reached(asked, ramp.i, motion), reached(asked, ramp.i, passed.state.motion)
        eased = _led(eased, ramp, before, after)
        ramps.append((ramp, passed.state.motion))
    return replace(_led_to_the_edit(eased, ramps, smoothing, calm=calm), calm=calm)


def _ramps(asked: Asked) -> Iterator[_Ramp]:
    """Yield the ramps of all constraints over others, each with those that are active where it meets them."""
    frames = np.arange(len(asked.motion))
    for i, (constraint, targets) in enumerate(zip(asked.constraints, asked.targets, strict=True)):
        if not constraint.points:
            continue
        here = (targets.first <= frames) & (frames <= targets.last)
        left = here * (1.0 - constraint.share(len(frames)))
        spans = [(k, span) for k, span in enumerate(asked.targets) if k != i]
        for side, outside in (
            (frames < constraint.points[0].start, targets.first - 1),
            (frames > constraint.points[-1].stop, targets.last + 1),
        ):
            others = tuple(k for k, span in spans if span.first <= outside <= span.last)
            if others and (left * side).any():
                yield _Ramp(i, left * side, outside, others)


def _led(asked: Asked, ramp: _Ramp, before: Targets, after: Targets) -> Asked:
    """Return what is asked with a ramp moved along from where one motion has its task to where another has it."""
    targets = asked.targets[ramp.i]
    led = moved(targets, before, after, ramp.left[targets.span])
    return replace(asked, targets=(*asked.targets[: ramp.i], led, *asked.targets[ramp.i + 1 :]))


def _led_to_the_edit(asked: Asked, ramps: list[tuple[_Ramp, Motion]], smoothing: Passes, *, calm: bool) -> Run:
    """Return what is asked with ramps that end where the edit itself has their tasks just outside of them."""
    ends = [_outside(asked, ramp, there) for ramp, there in ramps]
    run = run_of(asked)
    for _ in range(_ROUNDS if ramps else 0):
        motion = solve_in_passes(replace(run, calm=calm), smoothing).state.motion
        now = [_outside(asked, ramp, motion) for ramp, _ in ramps]
        if max(map(_apart, ends, now)) < _APART:
            break
        wanted = [moved(end, end, there, np.full(1, _FURTHER)) for end, there in zip(ends, now, strict=True)]
        for (ramp, _), end, there in zip(ramps, ends, wanted, strict=True):
            asked = _led(asked, ramp, end, there)
        ends, run = wanted, run_of(asked)
    return run


def _outside(asked: Asked, ramp: _Ramp, motion: Motion) -> Targets:
    """Return where a motion has a ramp's task at the frame just outside of it."""
    own = asked.targets[ramp.i]
    parts = (own.positions, own.rotations, own.lengths)
    probe = Targets(ramp.outside, ramp.outside, *(None if part is None else part[:1] for part in parts))
    targets = (*asked.targets[: ramp.i], probe, *asked.targets[ramp.i + 1 :])
    return reached(replace(asked, targets=targets), ramp.i, motion)


def _apart(one: Targets, other: Targets) -> float:
    """Return how far targets of one frame are apart, metres or the vector part of a turn."""
    parts = zip(
        (one.positions, one.rotations, one.lengths), (other.positions, other.rotations, other.lengths), strict=True
    )
    return max((float(np.abs(a - b).max()) for a, b in parts if a is not None and b is not None), default=0.0)


def _is_moved(asked: Asked, motion: Motion, frames: BoolArray) -> bool:
    """Return whether constraints want anything of some frames that these do not do already."""
    for errors, targets in zip(errors_of(asked, motion), asked.targets, strict=True):
        for left in (errors.positions, errors.angles):
            if left is not None and np.any(left[frames[targets.span]] > NO_DISPLACEMENT):
                return True
    return False
