"""What the first solve is drawn to: the input, turned where a body meets what is asked by itself in another way."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.bones import below
from motionedit.core.feet.crouch import crouched
from motionedit.core.priorities.agreeing import overruled
from motionedit.core.priorities.groups import seen_by
from motionedit.core.priorities.kinds.constraint import Scene, Turned
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.gaze import Gaze
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.groups import Asked


def drawn_to(asked: Asked) -> Motion:
    """Return the motion for which all freedom is used that constraints leave.

    It is the input, but for what `Constraint.by_itself` makes of it where nothing overrules the constraint, and for
    legs: where the trunk shall go down on feet that are held they bend. The least change would lean it, back or forth
    as it leans a little already, for straight legs hardly begin to bend.
    """
    changes = [*_by_itself(asked), *_down_on_feet(asked)]
    if not changes:
        return asked.motion
    rotations = asked.motion.rotations.copy()
    for frames, turned in changes:
        rotations[frames[:, None], turned.joints] = turned.rotations
    return replace(asked.motion, rotations=rotations)


def _by_itself(asked: Asked) -> Iterator[tuple[IntArray, Turned]]:
    """Yield frames and what a constraint makes of the body there, of those that nothing overrules."""
    motion, body = asked.motion, asked.body
    for i, (each, targets, recruits) in enumerate(zip(asked.constraints, asked.targets, asked.recruits, strict=True)):
        turned = each.by_itself(targets, recruits, body, partial(seen_by, [each], motion, body))
        if turned is not None:
            without = overruled(asked.constraints, asked.targets, len(motion))[targets.span, i]
            asks = np.flatnonzero(~without)
            yield targets.first + asks, Turned(turned.joints, turned.rotations[asks])


def _down_on_feet(asked: Asked) -> Iterator[tuple[IntArray, Turned]]:
    """Yield the frames at which the trunk shall go down on its feet, and legs bent as far."""
    motion, body = asked.motion, asked.body
    if body.gaze is None or body.mobility is None or not body.legs:
        return
    down = _down(asked, body.gaze)
    frames = np.flatnonzero(down)
    if len(frames):
        low = crouched(motion.at(frames), body.legs, body.bends, down=down[frames], up=body.gaze.up)
        joints = [joint for leg in body.legs for joint in (leg.thigh, leg.knee, leg.ankle)]
        yield frames, Turned(joints, low.rotations[:, joints])


def _down(asked: Asked, gaze: Gaze) -> FloatArray:
    """Return how far the trunk shall go down at each frame, metres, shape (F,), as far as feet are held there."""
    motion, body = asked.motion, asked.body
    down, held = np.zeros(len(motion)), np.zeros(len(motion))
    asks = list(zip(asked.constraints, asked.recruits, strict=True))
    lowers = [each for each, own in asks if each.at is not None and each.at.joint in gaze.trunk and own.root]
    if not lowers:
        return down
    before = seen_by(lowers, motion, body)
    scene = Scene(before, asked.settings.curve, dict, lambda: before)
    for wanted in (each.displacement(scene) for each in lowers):
        if wanted is not None:
            down[wanted.span] = np.maximum(down[wanted.span], -wanted.shift @ gaze.up)
    feet = np.any([below(motion.skeleton, leg.ankle) for leg in body.legs], axis=0)
    for each, targets in zip(asked.constraints, asked.targets, strict=True):
        if each.at is not None and each.places_effector and feet[each.at.joint]:
            held[targets.span] = np.maximum(held, each.share(len(motion)))[targets.span]
    return down * held
