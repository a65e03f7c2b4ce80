"""How readily the joints of a body give: a human's trunk, neck and shoulder girdle less than its limbs."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.body.still import is_at_its_parent
from motionedit.core.body.whole import whole_joints

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy, Leg
    from motionedit.core.skeleton import Skeleton

# Mobility: a joint's share of a change goes with its square. 1 is a shoulder, an elbow, a hip or a knee.
PELVIS = 0.5
SPINE = 0.35
NECK = 0.35
CLAVICLE = 0.4
WRIST_AND_ANKLE = 0.7
# Of a joint that a rig has between the pelvis and one hip: a body has none there, so it turns where nothing else can.
HIP_GIRDLE = 0.05
# Of a joint that a rig has inside of a limb's bone, to share its twist: no thigh bends in its middle.
INSIDE_BONE = 0.05
# Of a joint above the hips that carries the travel: the whole body turns about its hips.
CARRIER = 0.01
# Of the root's shift.
TRAVEL = 0.25


@lru_cache(maxsize=8)
def human_mobility(skeleton: Skeleton, anatomy: Anatomy, *, travel: int) -> FloatArray:
    """Return the mobility of every joint, shape (J,), of a body's parts that were found; 1 elsewhere.

    `travel` is the joint that carries the travel.
    """
    mobility = np.ones(len(skeleton))
    for joint, value in _parts(skeleton, anatomy, travel):
        mobility[joint] = value
    return frozen(mobility)


def _parts(skeleton: Skeleton, anatomy: Anatomy, travel: int) -> Iterator[tuple[int, float]]:
    """Yield joints with their mobility."""
    *above, hips = _turning(skeleton, whole_joints(skeleton, anatomy, travel=travel))
    chest = hips if anatomy.chest is None else anatomy.chest
    if anatomy.head is not None:
        for joint in skeleton.between(chest, anatomy.head):
            yield joint, NECK
    for arm in anatomy.arms or ():
        girdle = skeleton.between(chest, arm.shoulder)
        for joint, lower in pairwise(girdle):
            yield joint, INSIDE_BONE if is_at_its_parent(skeleton, anatomy, lower) else CLAVICLE
        yield from _inside(skeleton, arm.as_leg)
        yield arm.wrist, WRIST_AND_ANKLE
    for leg in anatomy.legs or ():
        yield from _inside(skeleton, leg)
        yield leg.ankle, WRIST_AND_ANKLE
    if anatomy.legs is not None:
        left, right = (set(skeleton.between(hips, leg.thigh)[:-1]) for leg in anatomy.legs)
        yield from ((joint, HIP_GIRDLE) for joint in sorted(left ^ right))
        # One with both legs is the pelvis, too.
        yield from ((joint, PELVIS) for joint in sorted(left & right))
    for joint in skeleton.between(hips, chest):
        yield joint, SPINE
    yield from ((joint, CARRIER) for joint in above)
    yield hips, PELVIS


def _inside(skeleton: Skeleton, limb: Leg) -> Iterator[tuple[int, float]]:
    """Yield the joints inside of a limb's two bones."""
    for top, end in ((limb.thigh, limb.knee), (limb.knee, limb.ankle)):
        for joint in skeleton.between(top, end)[:-1]:
            yield joint, INSIDE_BONE


def _turning(skeleton: Skeleton, whole: tuple[int, ...]) -> tuple[int, ...]:
    """Return the joints of a whole body down to the last that turns about all axes; the first alone where none does."""
    turning = [i for i, joint in enumerate(whole) if skeleton.turns_freely(joint)]
    return whole[: turning[-1] + 1] if turning else whole[:1]
