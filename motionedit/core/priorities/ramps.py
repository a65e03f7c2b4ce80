"""Ramps: where constraints ease in and out, and where the edit has their tasks just outside of them.

Passes smooth over a ramp's end: what begins casts its shadow before it. A ramp that came from the input all the same
would begin with a jump of some millimetres, so in the last pass ramps are led to where the smoothed edit has them.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.blocks import BLOCK_FRAMES
from motionedit.core.priorities.agreeing import agreed
from motionedit.core.priorities.groups import Ramp, seen_by
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.task_targets import Targets, moved
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.sight import Sight

# Where each ramp of each constraint ends.
Ends = tuple[tuple[Targets, ...], ...]


def ramps_of(asked: Asked, i: int) -> tuple[Ramp, ...]:
    """Return the ramps of a constraint that end within the clip: where the input has its task."""
    constraint = asked.constraints[i]
    if not constraint.points:
        return ()
    targets, count = asked.targets[i], len(asked.motion)
    find = _sides_again if count <= BLOCK_FRAMES else _sides
    return tuple(
        Ramp(left, outside, task_at(asked, i, asked.motion, outside))
        for left, outside in find(constraint, targets.first, targets.last, count)
        if asked.body.first <= outside < count
    )


def _sides(constraint: Constraint, first: int, last: int, count: int) -> tuple[tuple[FloatArray, int], ...]:
    """Return how much of a constraint is left at every frame of its ramps, (F,), and the frame outside of each."""
    frames = np.arange(count)
    left = ((first <= frames) & (frames <= last)) * (1.0 - constraint.share(count))
    sides = (
        (left * (frames < constraint.points[0].start), first - 1),
        (left * (frames > constraint.points[-1].stop), last + 1),
    )
    return tuple((frozen(side), outside) for side, outside in sides if side.any())


# The clips of a folder that share a skeleton mostly share their constraints, too.
_sides_again = lru_cache(maxsize=32)(_sides)


def task_at(asked: Asked, i: int, motion: Motion, frame: int) -> Targets:
    """Return where a motion has a constraint's task at a frame, as targets of one frame."""
    if motion.is_fixed and len(motion) <= BLOCK_FRAMES:
        # It is seen already, as a whole.
        return _task(asked, i, frame, seen_by([asked.constraints[i]], motion, asked.body), frame)
    return _task(asked, i, frame, _seen(asked, [i], motion, [frame]), 0)


def _seen(asked: Asked, which: Collection[int], motion: Motion, frames: Sequence[int]) -> Sight:
    """Return what some constraints see of frames of a motion."""
    part = motion.at(frames)
    return seen_by([asked.constraints[i] for i in which], part, asked.body)


def _task(asked: Asked, i: int, outside: int, seen: Sight, frame: int) -> Targets:
    """Return where a constraint's task is just outside of a ramp, which is one frame of what is seen."""
    targets = asked.targets[i]
    nearest = slice(None, 1) if outside < targets.first else slice(-1, None)
    parts = (None if part is None else part[nearest] for part in targets.parts)
    return asked.constraints[i].reached(Targets(frame, frame, *parts), seen)


def ends_in(asked: Asked, motion: Motion) -> Ends:
    """Return where a motion has the tasks of all ramps just outside of them."""
    frames = sorted({ramp.outside for ramps in asked.ramps for ramp in ramps})
    seen = _seen(asked, range(len(asked.targets)), motion, frames)
    return tuple(
        tuple(_task(asked, i, ramp.outside, seen, frames.index(ramp.outside)) for ramp in ramps)
        for i, ramps in enumerate(asked.ramps)
    )


def led_to(asked: Asked, ends: Ends) -> tuple[Targets, ...]:
    """Return the targets of all constraints, ramps moved along so that they end there: T + left (end' - end).

    Those of the same task agree as before.
    """
    targets = list(asked.targets)
    for i, (ramps, places) in enumerate(zip(asked.ramps, ends, strict=True)):
        for ramp, place in zip(ramps, places, strict=True):
            if apart(ramp.end, place) > NO_DISPLACEMENT:
                targets[i] = moved(targets[i], ramp.end, place, ramp.left[targets[i].span])
    return agreed(asked.constraints, targets, len(asked.motion))


def led_frames(asked: Asked, one: Ends, other: Ends) -> BoolArray:
    """Return at which frames ramps are led otherwise to some ends than to others, shape (F,)."""
    frames = np.zeros(len(asked.motion), dtype=np.bool_)
    for ramps, here, there in zip(asked.ramps, one, other, strict=True):
        for ramp, a, b in zip(ramps, here, there, strict=True):
            if apart(a, b) > NO_DISPLACEMENT:
                frames |= ramp.left > 0.0
    return frames


def ending_in(asked: Asked, ends: Ends | None, which: Collection[int]) -> Asked:
    """Return what is asked, some constraints' ramps led to where they ended and led on from there."""
    if ends is None:
        return asked
    led, targets, ramps = led_to(asked, ends), list(asked.targets), list(asked.ramps)
    for i in which:
        targets[i] = led[i]
        ramps[i] = tuple(replace(ramp, end=end) for ramp, end in zip(ramps[i], ends[i], strict=True))
    return replace(asked, targets=tuple(targets), ramps=tuple(ramps))


def apart(one: Targets, other: Targets) -> float:
    """Return how far targets of one frame are apart, metres or the vector part of a turn."""
    pairs = zip(one.parts, other.parts, strict=True)
    return max((float(np.abs(a - b).max()) for a, b in pairs if a is not None and b is not None), default=0.0)
