"""Knees and elbows that an edit bends back further than its input does."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.in_one_loop import read_off
from motionedit.core.body.ranges import Beyond, Limb, product

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.bends import Bend
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# Degrees by which a knee or an elbow bends back from which on it looks wrong.
BACK = 5.0


def bent_back(
    before: Motion, after: Motion, anatomy: Anatomy, bends: Sequence[Bend], *, first: int, touched: BoolArray
) -> list[Beyond]:
    """Return the knees and elbows that an edit bends back further than the input does, by more than `BACK`."""
    axes = {bend.joint: bend.axis for bend in bends}
    asked = [limb for limb in anatomy.limbs if limb[1] in axes and touched[_turning(before.skeleton, limb)].any()]
    found = []
    for limb in _back_at_all(after, tuple(asked), axes, first):
        joint = limb[1]
        taken = _bend(*_bones(after, limb), axes[joint])[first:]
        worst = int(np.argmin(taken))
        if taken[worst] >= -BACK:
            continue
        own = _bend(*_bones(before, limb), axes[joint])[first:]
        degrees = min(0.0, float(own.min())) - float(taken[worst])
        if degrees > BACK:
            found.append(Beyond(joint, None, first + worst, degrees, BACK))
    return found


@lru_cache(maxsize=32)
def _turning(skeleton: Skeleton, limb: Limb) -> IntArray:
    """Return the joints that turn a limb, shape (n,)."""
    top, _, end = limb
    return frozen(np.array([top, *_joints_between(skeleton, top, end)], dtype=np.intp))


def _back_at_all(motion: Motion, limbs: tuple[Limb, ...], axes: dict[int, FloatArray], first: int) -> list[Limb]:
    """Return the limbs that bend back at any frame from `first` on."""
    joints, bones = _fixed_bones(motion.skeleton, limbs)
    given = (bones[0], bones[1], np.array([axes[joint] for joint in joints.tolist()]).reshape(-1, 3))
    found = read_off("bent_back", None, motion.rotations, joints, *given, shape=joints.shape, first=first)
    # What the compiled part does not know is looked at by itself.
    back = {} if found is None else dict(zip(joints.tolist(), found.tolist(), strict=True))
    return [limb for limb in limbs if back.get(limb[1], 1.0) and not _never_back(motion, limb, axes[limb[1]], first)]


def _never_back(motion: Motion, limb: Limb, axis: FloatArray, first: int) -> bool:
    return bool((rot.cross(*_bones(motion, limb))[first:] @ axis >= 0.0).all())


@lru_cache(maxsize=8)
def _fixed_bones(skeleton: Skeleton, limbs: tuple[Limb, ...]) -> tuple[IntArray, FloatArray]:
    """Return the joints of limbs that are two OFFSETs alone, as most are, shape (n,), and these bones, (2, n, 3)."""
    places = skeleton.translation_places
    plain = [
        (joint, end)
        for top, joint, end in limbs
        if skeleton.parents[joint] == top and skeleton.parents[end] == joint and max(places[joint], places[end]) < 0
    ]
    joints = np.array(plain, dtype=np.int64).reshape(-1, 2).T
    return frozen(joints[0].copy()), frozen(skeleton.offsets[joints])


def _bones(motion: Motion, limb: Limb) -> tuple[FloatArray, FloatArray]:
    """Return the upper bone of a limb, shape (F, 3) or (3,), and the lower one, (F, 3), seen by its joint's parent."""
    top, joint, end = limb
    skeleton = motion.skeleton
    frame = int(skeleton.parents[joint])
    upper, lower = _path(motion, frame, joint), _path(motion, joint, end)
    if top != frame:
        # The upper bone comes from further up: seen from the frame that the axis is fixed in.
        turned = product(motion.rotations, _joints_between(skeleton, top, frame))
        upper = upper + rot.unrotate(turned, _path(motion, top, frame))
    return upper, rot.rotate(motion.rotations[:, joint], lower)


def _bend(upper: FloatArray, lower: FloatArray, axis: FloatArray) -> FloatArray:
    """Return how a limb's bones are bent, shape (F,), degrees, positive where they are about an `axis`."""
    side = rot.cross(upper, lower)
    angle = np.arctan2(rot.length(side), rot.dot(upper, lower))
    bend: FloatArray = np.degrees(np.where(side @ axis < 0.0, -angle, angle))
    return bend


@lru_cache(maxsize=64)
def _joints_between(skeleton: Skeleton, top: int, end: int) -> tuple[int, ...]:
    """Return the joints below one and down to another that hangs on it, that one in."""
    return tuple(skeleton.between(top, end))


def _path(motion: Motion, top: int, end: int) -> FloatArray:
    """Return where a joint is in the frame of one above it, shape (F, 3), or (3,) where that is one place for all."""
    skeleton = motion.skeleton
    joints = _joints_between(skeleton, top, end)
    path, turned = np.zeros(3), rot.IDENTITY
    for j in joints:
        place = skeleton.translation_places[j]
        local = motion.translations[:, place] if place >= 0 else skeleton.offsets[j]
        path = local if j == joints[0] else path + rot.rotate(turned, local)
        if j != joints[-1]:
            turned = motion.rotations[:, j] if j == joints[0] else rot.multiply(turned, motion.rotations[:, j])
    return path
