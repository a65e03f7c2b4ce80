"""The segments of a human body, their masses and centres, and how they lie on a skeleton's joints."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy, Arm, Leg
    from motionedit.core.skeleton import Skeleton


class Part(NamedTuple):
    """A stretch of a path, from `start` to `stop` of its length, with its mass (percent of the body's).

    `center` is the place of its centre of mass, as a share of the stretch from its start; between 1/3 and 2/3, so
    that a density linear along the stretch has it.
    """

    start: float
    stop: float
    mass: float
    center: float


# P. de Leva, Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters, J. Biomechanics 29 (1996), table 4:
# the mean of its values for women and for men, since a clip does not say. Limbs from the joint nearer to the trunk.
UPPER_ARM = (Part(0.0, 1.0, 0.5 * (2.55 + 2.71), 0.5 * (0.5754 + 0.5772)),)
FOREARM = (Part(0.0, 1.0, 0.5 * (1.38 + 1.62), 0.5 * (0.4559 + 0.4574)),)
THIGH = (Part(0.0, 1.0, 0.5 * (14.78 + 14.16), 0.5 * (0.3612 + 0.4095)),)
SHANK = (Part(0.0, 1.0, 0.5 * (4.81 + 4.33), 0.5 * (0.4352 + 0.4395)),)
# From the middle of the hips up to the seventh cervical vertebra; the borders are navel and lower end of the sternum.
_NAVEL, _STERNUM = 163.6 / 609.05, 374.0 / 609.05
TRUNK = (
    Part(0.0, _NAVEL, 0.5 * (12.47 + 11.17), 1.0 - 0.5 * (0.4920 + 0.6115)),
    Part(_NAVEL, _STERNUM, 0.5 * (14.65 + 16.33), 1.0 - 0.5 * (0.4512 + 0.4502)),
    Part(_STERNUM, 1.0, 0.5 * (15.45 + 15.96), 1.0 - 0.5 * (0.5050 + 0.5066)),
)
HEAD_MASS = 0.5 * (6.68 + 6.94)
HAND_MASS = 0.5 * (0.56 + 0.61)
FOOT_MASS = 0.5 * (1.29 + 1.37)

# Ends of a skeleton are where its author liked, so these are the table's own lengths, in leg lengths (834.8 mm).
_HEAD_CENTER = 0.5 * (0.4841 * 243.7 + 0.5002 * 242.9) / 834.8  # down from the crown
_HEAD_LENGTH = 243.3 / 834.8  # from the neck's base to the crown
_NECK_LENGTH = 100.0 / 834.8  # from its base to the joint below the skull, about 143 mm under the crown
_HAND_CENTER = 0.5 * (0.3427 * 170.1 + 0.3624 * 187.9) / 834.8  # from the wrist to the tip of the middle finger
# The foot's centre stands at 42 % from heel to tip. The ankle is over 24 % of it, the toe joint over 70 %, so:
_FOOT_CENTER_TO_TOE = 0.4
_FOOT_CENTER_TO_TIP = 0.24

# A body of other proportions is not a human's: a dog's trunk is 1.4 hind legs, a human's 0.7, CMU's shortest 0.5.
_TRUNK_TO_LEG = (0.25, 1.15)
_ARM_TO_LEG = (0.25, 1.15)


@dataclass(frozen=True, eq=False)
class Laid:
    """Masses laid on J joints: `mass` (J,), any unit, and `points` (J, 3), their centres in the joints' frames."""

    mass: FloatArray
    points: FloatArray


class Pose(NamedTuple):
    """A body in one pose: the `places` of its J joints and of its skeleton's end sites, each shape (3,), clip units."""

    skeleton: Skeleton
    places: Sequence[FloatArray]
    ends: Sequence[FloatArray]

    def ends_below(self, joint: int) -> list[FloatArray]:
        """Return the places of a joint's children and end sites."""
        sites = zip(self.skeleton.end_sites, self.ends, strict=True)
        return [self.places[c] for c in self.skeleton.children[joint]] + [e for site, e in sites if site.joint == joint]


class Carrier(NamedTuple):
    """A straight piece of a path that moves with a joint: from `entry` to `leave`, shape (3,), in the world."""

    joint: int
    entry: FloatArray
    leave: FloatArray


class Lump(NamedTuple):
    """A mass that moves with a joint, any unit, with its centre, shape (3,)."""

    joint: int
    mass: float
    point: FloatArray


def lay_human(pose: Pose, anatomy: Anatomy) -> Laid | None:
    """Return the body's segments laid on a human in a pose, in percent, centres in the world; None where it is none.

    Where a segment has several joints (twist joints, a spine), each carries the part between it and the next one.
    """
    trunk = _trunk(pose, anatomy)
    if anatomy.legs is None or anatomy.arms is None or trunk is None or not _is_human(pose, anatomy, trunk):
        return None
    lumps = _lumps(TRUNK, trunk)
    lumps.append(_head(pose, anatomy, trunk))
    for leg in anatomy.legs:
        lumps += _lumps(THIGH, _limb(pose, leg.thigh, leg.knee))
        lumps += _lumps(SHANK, _limb(pose, leg.knee, leg.ankle))
        lumps.append(_foot(pose, leg))
    for arm in anatomy.arms:
        lumps += _lumps(UPPER_ARM, _limb(pose, arm.shoulder, arm.elbow))
        lumps += _lumps(FOREARM, _limb(pose, arm.elbow, arm.wrist))
        lumps.append(_hand(pose, arm, anatomy.leg_length))
    return _gathered(len(pose.skeleton), lumps)


def lay_by_length(skeleton: Skeleton) -> Laid:
    """Return masses as long as the bones: each joint carries those to its children and ends, at their middles.

    A bone that position channels move has no length of its own. A skeleton without any length weighs at its root.
    """
    moved = set(skeleton.translated.tolist())
    bones = [(int(skeleton.parents[j]), skeleton.offsets[j]) for j in range(1, len(skeleton)) if j not in moved]
    bones += [(site.joint, site.offset) for site in skeleton.end_sites]
    lumps = [Lump(joint, float(np.linalg.norm(offset)), 0.5 * offset) for joint, offset in bones]
    if sum(lump.mass for lump in lumps) <= 0.0:
        lumps = [Lump(0, 1.0, np.zeros(3))]
    return _gathered(len(skeleton), lumps)


def lay_given(laid: Laid, given: Mapping[int, float], *, elsewhere: Laid) -> Laid:
    """Return given masses (by joint), at the centres of `laid`, or of `elsewhere` where `laid` has no mass."""
    mass = np.zeros_like(laid.mass)
    mass[list(given)] = list(given.values())
    points = np.where(laid.mass[:, None] > 0.0, laid.points, elsewhere.points)
    return Laid(frozen(mass), frozen(points))


def _gathered(joints: int, lumps: Sequence[Lump]) -> Laid:
    """Return the masses of joints that carry lumps, with the centre of each joint's; 0 where it carries none."""
    carriers, weights, points = (np.array(column) for column in zip(*lumps, strict=True))
    mass, moments = np.zeros(joints), np.zeros((joints, 3))
    np.add.at(mass, carriers, weights)
    np.add.at(moments, carriers, weights[:, None] * points)
    centers = np.divide(moments, mass[:, None], out=np.zeros_like(moments), where=mass[:, None] > 0.0)
    return Laid(frozen(mass), frozen(centers))


def _lumps(parts: tuple[Part, ...], path: Sequence[Carrier]) -> list[Lump]:
    """Return a segment's parts spread along a path by length."""
    ends = [0.0, 1.0]
    if len(path) > 1:
        lengths = np.array([math.dist(piece.entry, piece.leave) for piece in path])
        ends = (np.concatenate(([0.0], np.cumsum(lengths))) / lengths.sum()).tolist()
    return [
        Lump(piece.joint, mass, piece.entry + share * (piece.leave - piece.entry))
        for piece, (start, stop) in zip(path, pairwise(ends), strict=True)
        for mass, share in _spread(parts, start, stop)
    ]


@lru_cache(maxsize=64)
def _spread(parts: tuple[Part, ...], start: float, stop: float) -> tuple[tuple[float, float], ...]:
    """Return the masses of parts between two shares of their path, each with its centre as a share of the way there."""
    found = []
    for part in parts:
        low, high = max(start, part.start), min(stop, part.stop)
        if high > low:
            mass, place = _slice(part, low, high)
            found.append((mass, (place - start) / (stop - start)))
    return tuple(found)


def _slice(part: Part, low: float, high: float) -> tuple[float, float]:
    """Return mass and centre of the slice of a part between two places, all as shares of the path.

    The density over the part, s from 0 to 1, is 1 + k (2 s - 1), whose centre is 1/2 + k/6.
    """
    k, width = 6.0 * part.center - 3.0, part.stop - part.start
    mass, moment = 0.0, 0.0
    for place, sign in ((low, -1.0), (high, 1.0)):
        s = (place - part.start) / width
        mass += sign * (s + k * (s**2 - s))
        moment += sign * (0.5 * s**2 + k * (2.0 / 3.0 * s**3 - 0.5 * s**2))
    return part.mass * mass, part.start + width * moment / mass


def _limb(pose: Pose, top: int, end: int) -> list[Carrier]:
    """Return the path from one joint of a limb down to another."""
    way = pairwise((top, *pose.skeleton.between(top, end)))
    return [Carrier(joint, pose.places[joint], pose.places[below]) for joint, below in way]


def _trunk(pose: Pose, anatomy: Anatomy) -> list[Carrier] | None:
    """Return the path from the middle of the hips to the base of the neck, whichever way the tree goes."""
    if anatomy.pelvis is None or anatomy.chest is None or anatomy.legs is None or anatomy.arms is None:
        return None
    entry = _middle(pose, [leg.thigh for leg in anatomy.legs])
    last, neck = _neck_base(pose, anatomy, anatomy.chest)
    up = pose.skeleton.chain(anatomy.pelvis).tolist()
    down = pose.skeleton.chain(last).tolist()
    fork = max(j for j in up if j in set(down))
    rising = up[up.index(fork) + 1 :][::-1]
    falling = down[down.index(fork) :]
    joints, leaves = rising + falling, [pose.places[joint] for joint in rising + falling[1:]] + [neck]
    return list(map(Carrier, joints, [entry, *leaves], leaves))


def _neck_base(pose: Pose, anatomy: Anatomy, chest: int) -> tuple[int, FloatArray]:
    """Return the joint that carries the base of the neck, and where that is.

    Of the joints between chest and head the one that is a neck's length from the head; where there is none, a point
    beside the shoulders on the way to the head.
    """
    skeleton, places = pose.skeleton, pose.places
    beside = _middle(pose, [arm.shoulder for arm in anatomy.arms or ()])
    if anatomy.head is None or chest not in skeleton.chain(anatomy.head):
        return chest, beside
    between = skeleton.between(chest, anatomy.head)[:-1]
    if between:
        lengths = [_length(_limb(pose, joint, anatomy.head)) for joint in between]
        errors = np.abs(np.array(lengths) - _NECK_LENGTH * anatomy.leg_length)
        base = between[int(np.argmin(errors))]
        return int(skeleton.parents[base]), places[base]
    head = places[anatomy.head] - places[chest]
    along = float((beside - places[chest]) @ head) / max(float(head @ head), np.finfo(float).tiny)
    return chest, places[chest] + min(max(along, 0.0), 1.0) * head


def _head(pose: Pose, anatomy: Anatomy, trunk: Sequence[Carrier]) -> Lump:
    """Return the head with the neck: a lump on the head's joint, on the chest where there is none."""
    last, entry, neck = trunk[-1]
    center = (_HEAD_LENGTH - _HEAD_CENTER) * anatomy.leg_length
    if anatomy.head is None or last not in pose.skeleton.chain(anatomy.head):
        return Lump(last, HEAD_MASS, neck + center * _unit(neck - entry))
    head = pose.places[anatomy.head]
    beyond = max(center - math.dist(neck, head), 0.0)
    return Lump(anatomy.head, HEAD_MASS, head + beyond * _unit(head - neck))


def _hand(pose: Pose, arm: Arm, leg_length: float) -> Lump:
    """Return the hand: on the wrist, towards the mean direction of what hangs there, else as the forearm goes."""
    wrist = pose.places[arm.wrist]
    ahead = sum((_unit(end - wrist) for end in pose.ends_below(arm.wrist)), np.zeros(3))
    if not np.any(ahead):
        ahead = wrist - pose.places[arm.elbow]
    return Lump(arm.wrist, HAND_MASS, wrist + _HAND_CENTER * leg_length * _unit(ahead))


def _foot(pose: Pose, leg: Leg) -> Lump:
    """Return the foot: on the ankle, on the way to the toe joint, else to the farthest end, else at the ankle."""
    ankle = pose.places[leg.ankle]
    if leg.toe is not None:
        tip, share = pose.places[leg.toe], _FOOT_CENTER_TO_TOE
    else:
        ends = pose.ends_below(leg.ankle)
        tip, share = max(ends, key=lambda end: math.dist(ankle, end), default=ankle), _FOOT_CENTER_TO_TIP
    return Lump(leg.ankle, FOOT_MASS, ankle + share * (tip - ankle))


def _middle(pose: Pose, joints: Sequence[int]) -> FloatArray:
    """Return the mean place of some joints."""
    middle: FloatArray = np.mean([pose.places[joint] for joint in joints], axis=0)
    return middle


def _unit(vector: FloatArray) -> FloatArray:
    length = math.hypot(*vector)
    return vector / length if length > 0.0 else np.zeros(3)


def _is_human(pose: Pose, anatomy: Anatomy, trunk: Sequence[Carrier]) -> bool:
    arms = [_length(_limb(pose, arm.shoulder, arm.wrist)) for arm in anatomy.arms or ()]
    ratios = ((_length(trunk), _TRUNK_TO_LEG), (sum(arms) / 2.0, _ARM_TO_LEG))
    return all(low * anatomy.leg_length <= length <= high * anatomy.leg_length for length, (low, high) in ratios)


def _length(path: Sequence[Carrier]) -> float:
    return sum(math.dist(piece.entry, piece.leave) for piece in path)
