"""What the first solve is drawn to: the input, turned where a body meets what is asked by itself in another way."""

from __future__ import annotations

from functools import lru_cache, partial
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.again import once
from motionedit.core.blocks import frame_blocks
from motionedit.core.body.bones import below
from motionedit.core.feet.drawn_up import drawn_up
from motionedit.core.priorities.agreeing import overruled
from motionedit.core.priorities.groups import seen_by
from motionedit.core.priorities.kinds.constraint import Scene, Turned
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.gaze import Gaze
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.skeleton import Skeleton

# Metres: a foot that shall be higher by so much is so by the body as much as by its leg, as where plants are put right.
_LITTLE = 0.03


def drawn_to(asked: Asked) -> tuple[tuple[IntArray, Turned], ...]:
    """Return where the motion for which all freedom is used that constraints leave is another than the input.

    At frames, shape (n,), that is what `Constraint.by_itself` makes of it where nothing overrules the constraint, then
    legs: they bend where the trunk shall go down on feet that are held, or a foot up. The least change would lean the
    body, back or forth as it leans a little already, or carry it up with its foot: straight legs hardly begin to bend.
    """
    return tuple(part for part in chain(_by_itself(asked), _with_legs(asked)) if len(part[0]))


def turned_at(motion: Motion, parts: Sequence[tuple[IntArray, Turned]]) -> Motion:
    """Return a motion whose joints are turned as given at some frames; where there are none, the motion itself."""
    if not parts:
        return motion
    rotations = motion.rotations.copy()
    for frames, turned in parts:
        rotations[frames[:, None], turned.joints] = turned.rotations
    return replace(motion, rotations=rotations)


def _by_itself(asked: Asked) -> Iterator[tuple[IntArray, Turned]]:
    """Yield frames and what a constraint makes of the body there, of those that nothing overrules."""
    motion, body = asked.motion, asked.body
    without = once(lambda: overruled(asked.constraints, asked.targets, len(motion)))
    for i, (each, targets, recruits) in enumerate(zip(asked.constraints, asked.targets, asked.recruits, strict=True)):
        turned = each.by_itself(targets, recruits, body, partial(seen_by, [each], motion, body))
        if turned is not None:
            asks = np.flatnonzero(~without()[targets.span, i])
            yield targets.first + asks, Turned(turned.joints, turned.rotations[asks])


def _with_legs(asked: Asked) -> Iterator[tuple[IntArray, Turned]]:
    """Yield the frames at which legs draw up, and how they do."""
    motion, body, gaze = asked.motion, asked.body, asked.body.gaze
    if gaze is None or body.mobility is None or not body.legs:
        return
    feet = _feet(motion.skeleton, body.legs)
    if not any(_moves(each, joints) for each in asked.constraints for joints in (gaze.trunk, *feet)):
        return
    by = _down(asked, gaze, feet)[:, None] + _up(asked, gaze, feet)
    there = np.flatnonzero(by.any(axis=1))
    joints = [joint for leg in body.legs for joint in leg.joints]
    for block in frame_blocks(len(there)):
        frames = there[block]
        drawn = drawn_up(motion.at(frames), body.legs, body.bends, by=by[frames], up=gaze.up)
        yield frames, Turned(joints, drawn.rotations[:, joints])


@lru_cache(maxsize=8)
def _feet(skeleton: Skeleton, legs: tuple[Leg, ...]) -> tuple[frozenset[int], ...]:
    """Return the joints of each leg's foot."""
    return tuple(frozenset(np.flatnonzero(below(skeleton, leg.ankle)).tolist()) for leg in legs)


def _down(asked: Asked, gaze: Gaze, feet: Sequence[frozenset[int]]) -> FloatArray:
    """Return how far the trunk shall go down at each frame, metres, shape (F,), as far as feet are held there."""
    asks = list(zip(asked.constraints, asked.recruits, strict=True))
    lowers = [each for each, own in asks if own.root and _moves(each, gaze.trunk)]
    down, held = -_heights(asked, lowers, gaze, np.minimum), np.zeros(len(asked.motion))
    if not down.any():
        return down
    for each, targets in zip(asked.constraints, asked.targets, strict=True):
        if each.at is not None and each.places_effector and any(each.at.joint in foot for foot in feet):
            held[targets.span] = np.maximum(held, each.share(len(held)))[targets.span]
    return down * held


def _up(asked: Asked, gaze: Gaze, feet: Sequence[frozenset[int]]) -> FloatArray:
    """Return how much higher each foot shall be than it is, and than the lowest shall, metres, shape (F, L)."""
    lifts = [[each for each in asked.constraints if _moves(each, foot)] for foot in feet]
    rise = np.stack([_heights(asked, lift, gaze, np.maximum) for lift in lifts], axis=1)
    rise -= rise.min(axis=1, keepdims=True)
    return rise**2 / (rise + _LITTLE)


def _moves(constraint: Constraint, joints: frozenset[int]) -> bool:
    """Return whether a constraint's points may want one of the joints elsewhere."""
    return bool(constraint.points) and constraint.at is not None and constraint.at.joint in joints


def _heights(asked: Asked, constraints: Sequence[Constraint], gaze: Gaze, most: np.ufunc) -> FloatArray:
    """Return the most that constraints want their effectors higher, or lower, than they are, metres, shape (F,)."""
    heights = np.zeros(len(asked.motion))
    if constraints:
        scene = Scene.of_input(seen_by(constraints, asked.motion, asked.body), asked.settings.curve)
        for wanted in (each.displacement(scene) for each in constraints):
            if wanted is not None:
                heights[wanted.span] = most(heights[wanted.span], wanted.shift @ gaze.up)
    return heights
