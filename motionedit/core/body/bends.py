"""How knees and elbows bend: about which axis, and to which side, also where they are straight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy, Leg
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

_BENT = float(np.sin(np.radians(2.0)))  # a limb bent by more than this shows to which side it bends
_STRAIGHT = float(np.sin(np.radians(0.2)))  # a limb bent by less than this hardly shortens when it bends


@dataclass(frozen=True, eq=False)
class Bend:
    """A knee or an elbow.

    Attributes
    ----------
    joint : int
    axis : shape (3,)
        Unit axis in the frame of the joint's parent, about which it bends further.
    straight : shape (F,)
        The frames in which the limb is straight.
    upper, lower : shape (3,)
        Unit directions of the limb's bones, in the frames of the joint's parent and of the joint.
    angles : shape (n,), rad
        How far it is bent about the axis, from `upper` to `lower`, after a rest pose; 0 is straight.
    """

    joint: int
    axis: FloatArray
    straight: BoolArray
    upper: FloatArray
    lower: FloatArray
    angles: FloatArray


def find_bends(skeleton: Skeleton, poses: WorldPoses, anatomy: Anatomy, *, first: int) -> tuple[Bend, ...]:
    """Return the bends of knees and elbows, left before right, knees first.

    A limb bends as it does in the clip's own frames from `first` on. One that is always straight bends as bodies do:
    knees to the toes' side, elbows so that the hands come to the front.
    """
    front = _front(poses, anatomy)
    limbs: list[tuple[tuple[int, int, int], FloatArray | None]] = []
    for leg in anatomy.legs or ():
        toes = _toes(poses, leg)
        forward = front if toes is None else toes
        limbs.append(((leg.thigh, leg.knee, leg.ankle), None if forward is None else -forward))
    limbs += [((arm.shoulder, arm.elbow, arm.wrist), front) for arm in anatomy.arms or ()]
    bends = (_bend(skeleton, poses, joints, towards, first=first) for joints, towards in limbs)
    return tuple(bend for bend in bends if bend is not None)


def _bend(
    skeleton: Skeleton,
    poses: WorldPoses,
    limb: tuple[int, int, int],
    towards: FloatArray | None,
    *,
    first: int,
) -> Bend | None:
    """Return the bend of a limb whose end comes `towards` a side, shape (F, 3), where no frame shows it."""
    top, joint, end = limb
    sides = _sides(poses.positions, top, joint, end)
    sines = rot.length(sides)
    bent = sines > _BENT
    bent[:first] = False
    if not bent.any():
        if towards is None:
            return None
        lower = poses.positions[:, end] - poses.positions[:, joint]
        sides, bent = rot.cross(lower, towards), np.ones(len(sides), dtype=np.bool_)
    parents = poses.rotations[bent, skeleton.parents[joint]]
    axis = rot.rotate(rot.conjugate(parents), sides[bent]).sum(axis=0)
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        return None
    upper = mean_direction(poses, top, joint, seen_from=int(skeleton.parents[joint]), first=first)
    lower = mean_direction(poses, joint, end, seen_from=joint, first=first)
    parent = poses.rotations[:, skeleton.parents[joint]]
    local = rot.multiply(rot.conjugate(parent), poses.rotations[:, joint])
    angles = turns_about(axis / length, upper, rot.rotate(local, lower))
    return Bend(
        joint, frozen(axis / length), frozen(sines < _STRAIGHT), frozen(upper), frozen(lower), frozen(angles[first:])
    )


def turns_about(axis: FloatArray, start: FloatArray, stop: FloatArray) -> FloatArray:
    """Return the angle about a unit axis (3,) from one direction to another, shapes (..., 3), in rad, (-pi, pi].

    atan2(a . (u x v), u . v - (a . u) (a . v)): what they have along the axis does not count.
    """
    sine = rot.dot(axis, rot.cross(start, stop))
    angles: FloatArray = np.arctan2(sine, rot.dot(start, stop) - (start @ axis) * (stop @ axis))
    return angles


def mean_direction(poses: WorldPoses, start: int, stop: int, *, seen_from: int, first: int) -> FloatArray:
    """Return the unit direction from one joint to another in the frame of a third, shape (3,), the mean of frames."""
    direction: FloatArray = mean_directions(
        poses, np.array([start]), np.array([stop]), seen_from=np.array([seen_from]), first=first
    )[0]
    return direction


def mean_directions(
    poses: WorldPoses, starts: IntArray, stops: IntArray, *, seen_from: IntArray, first: int
) -> FloatArray:
    """Return `mean_direction` of n pairs of joints, shape (n, 3)."""
    ways = poses.positions[first:, stops] - poses.positions[first:, starts]
    own = rot.rotate(rot.conjugate(poses.rotations[first:, seen_from]), ways).sum(axis=0)
    directions: FloatArray = own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), np.finfo(float).tiny)
    return directions


def _sides(positions: FloatArray, top: int, joint: int, end: int) -> FloatArray:
    """Return upper x lower of a limb's unit bones, shape (F, 3): its axis, times the sine by which it is bent."""
    upper, lower = positions[:, joint] - positions[:, top], positions[:, end] - positions[:, joint]
    lengths = rot.length(upper) * rot.length(lower)
    sides: FloatArray = rot.cross(upper, lower) / np.maximum(lengths, np.finfo(float).tiny)[:, None]
    return sides


def _toes(poses: WorldPoses, leg: Leg) -> FloatArray | None:
    """Return the way from the ankle to the toe, shape (F, 3)."""
    if leg.toe is not None:
        forward: FloatArray = poses.positions[:, leg.toe] - poses.positions[:, leg.ankle]
        return forward
    return None if leg.tip is None else rot.rotate(poses.rotations[:, leg.ankle], np.array(leg.tip))


def _front(poses: WorldPoses, anatomy: Anatomy) -> FloatArray | None:
    """Return where the body's front is, left x up of its trunk, shape (F, 3)."""
    legs, arms = anatomy.legs, anatomy.arms
    if legs is None or arms is None:
        return None
    shoulders = [poses.positions[:, arm.shoulder] for arm in arms]
    hips = [poses.positions[:, leg.thigh] for leg in legs]
    across = shoulders[0] - shoulders[1]
    trunk = shoulders[0] + shoulders[1] - hips[0] - hips[1]
    front: FloatArray = rot.cross(across, trunk)
    return front
