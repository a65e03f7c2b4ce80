"""Groups and nulls of a rig: joints that stand where a limb's joint does, and never turn, are not that joint."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import tip_of
from motionedit.core.body.head import SAME_PLACE
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy, Arm, GivenBody, Leg
    from motionedit.core.skeleton import Skeleton

# Rad: less is the rounding of a file.
_TURNS = 1e-3


def as_it_turns(skeleton: Skeleton, anatomy: Anatomy, rotations: FloatArray, *, given: GivenBody) -> Anatomy:
    """Return an anatomy whose joints turn, where others at their places do: the nearest below them.

    What the user says of limbs holds.

    Parameters
    ----------
    rotations : shape (F, J, 4)
        Local ones.
    """
    heaps = _heaps(skeleton, anatomy, given)
    moved = {joint: _first_turning(heap, rotations) for joint, heap in heaps.items()}
    return _with(anatomy, skeleton, moved) if any(joint != other for joint, other in moved.items()) else anatomy


def is_at_its_parent(skeleton: Skeleton, anatomy: Anatomy, joint: int) -> bool:
    """Return whether a joint stands where its parent does."""
    return float(np.linalg.norm(skeleton.offsets[joint])) < SAME_PLACE * anatomy.height


def _first_turning(heap: tuple[int, ...], rotations: FloatArray) -> int:
    """Return the first of some joints that turns, of none the first."""
    for joint in heap:
        if float(rot.angle_between(rotations[0, joint], rotations[:, joint]).max()) > _TURNS:
            return joint
    return heap[0]


@lru_cache(maxsize=8)
def _heaps(skeleton: Skeleton, anatomy: Anatomy, given: GivenBody) -> dict[int, tuple[int, ...]]:
    """Return the joints that stand where one of the anatomy's does and carry all that hangs on it, that one first."""
    joints: set[int] = set()
    if given.legs is None:
        joints |= {joint for leg in anatomy.legs or () for joint in leg.joints}
    if given.arms is None:
        joints |= {joint for arm in anatomy.arms or () for joint in arm.joints}
    if given.head is None and anatomy.head is not None:
        joints.add(anatomy.head)
    heaps = {}
    for joint in sorted(joints):
        heap, below = [joint], skeleton.children[joint]
        while len(below) == 1 and is_at_its_parent(skeleton, anatomy, below[0]):
            heap.append(below[0])
            below = skeleton.children[below[0]]
        if len(heap) > 1:
            heaps[joint] = tuple(heap)
    return heaps


def _with(anatomy: Anatomy, skeleton: Skeleton, moved: Mapping[int, int]) -> Anatomy:
    """Return an anatomy with other joints for some of its own."""

    def of(joint: int) -> int:
        return moved.get(joint, joint)

    def leg_of(leg: Leg) -> Leg:
        found = replace(leg, thigh=of(leg.thigh), knee=of(leg.knee), ankle=of(leg.ankle))
        # A foot below a group had been taken for its toe.
        return found if leg.toe != found.ankle else replace(found, toe=None, tip=tip_of(skeleton, found.ankle))

    def arm_of(arm: Arm) -> Arm:
        return replace(arm, shoulder=of(arm.shoulder), elbow=of(arm.elbow), wrist=of(arm.wrist))

    legs, arms = anatomy.legs, anatomy.arms
    return replace(
        anatomy,
        legs=None if legs is None else (leg_of(legs[0]), leg_of(legs[1])),
        arms=None if arms is None else (arm_of(arms[0]), arm_of(arms[1])),
        head=None if anatomy.head is None else of(anatomy.head),
    )
