"""How knees and elbows bend: about which axis, and to which side, also where they are straight."""

from __future__ import annotations

from functools import cache, lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.in_one_loop import read_off
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy, Leg
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

_BENT = float(np.sin(np.radians(2.0)))  # a limb bent by more than this shows to which side it bends
_STRAIGHT = float(np.sin(np.radians(0.2)))  # a limb bent by less than this hardly shortens when it bends

_BLOCK_POSES = 1 << 13


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
    front = cache(lambda: _front(poses, anatomy))

    def backward(leg: Leg) -> FloatArray | None:
        toes = _toes(poses, leg)
        forward = front() if toes is None else toes
        return None if forward is None else -forward

    limbs: list[_Limb] = [((leg.thigh, leg.knee, leg.ankle), partial(backward, leg)) for leg in anatomy.legs or ()]
    limbs += [((arm.shoulder, arm.elbow, arm.wrist), front) for arm in anatomy.arms or ()]
    # A few limbs at a time: those of a long motion all at once would take several times its memory.
    together = max(_BLOCK_POSES // len(poses.positions), 1)
    starts = range(0, len(limbs), together)
    return tuple(bend for i in starts for bend in _bends(skeleton, poses, limbs[i : i + together], first))


# A limb's joints, and what returns the side, shape (F, 3), towards which it bends where no frame shows it.
_Limb = tuple[tuple[int, int, int], "Callable[[], FloatArray | None]"]


def _bends(skeleton: Skeleton, poses: WorldPoses, limbs: Sequence[_Limb], first: int) -> tuple[Bend, ...]:
    tops, joints, ends = which = _limbs_joints(tuple(limb for limb, _ in limbs))
    parents = skeleton.parents[joints]
    sines, axes = _shown(poses, which, parents, first) or _sides(poses, which, parents, limbs, first)
    ways = (np.concatenate(each) for each in ((tops, joints), (joints, ends), (parents, joints)))
    starts, stops, seen_from = ways
    both = mean_directions(poses, starts, stops, seen_from=seen_from, first=first)
    uppers, lowers = both[: len(joints)], both[len(joints) :]
    local = rot.between(poses.rotations[:, parents], poses.rotations[:, joints])
    lengths = np.sqrt([axis.dot(axis) for axis in axes])
    axes /= np.where(lengths > 0.0, lengths, 1.0)[:, None]
    turns = turns_about(axes, uppers, rot.rotate(local, lowers))
    # Limb by limb in memory: those of a limb are looked at together.
    straight, angles = np.ascontiguousarray((sines < _STRAIGHT).T), np.ascontiguousarray(turns[first:].T)
    rows = map(frozen, (axes, straight, uppers, lowers, angles))
    found = [Bend(*each) for each in zip(joints.tolist(), *rows, strict=True)]
    return tuple(bend for bend, length in zip(found, lengths.tolist(), strict=True) if length > 0.0)


@lru_cache(maxsize=32)
def _limbs_joints(limbs: tuple[tuple[int, int, int], ...]) -> IntArray:
    """Return the joints of n limbs, shape (3, n)."""
    return frozen(np.array(limbs, dtype=np.intp).T)


def turns_about(axis: FloatArray, start: FloatArray, stop: FloatArray) -> FloatArray:
    """Return the angle about a unit axis (3,) from one direction to another, shapes (..., 3), in rad, (-pi, pi].

    Or about n axes (n, 3) from n directions, (n, 3), to others, (F, n, 3). It is atan2(a . (u x v), u . v - (a . u)
    (a . v)): what they have along the axis does not count.
    """
    sine = rot.dot(axis, rot.cross(start, stop))
    if axis.ndim == 1:
        along = (start @ axis) * (stop @ axis)
    else:
        own, other = np.matmul(start[:, None], axis[..., None]), np.matmul(stop.swapaxes(0, 1), axis[..., None])
        along = own[:, 0, 0] * other[..., 0].T
    angles: FloatArray = np.arctan2(sine, rot.dot(start, stop) - along)
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
    triples = np.stack((starts, stops, seen_from), axis=1)
    own = read_off("ways", poses.positions, poses.rotations, triples, shape=(len(triples), 3), first=first)
    if own is None:
        ways = poses.positions[first:, stops] - poses.positions[first:, starts]
        own = rot.unrotate(poses.rotations[first:, seen_from], ways).sum(axis=0)
    directions: FloatArray = own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), np.finfo(float).tiny)
    return directions


def _shown(poses: WorldPoses, which: IntArray, parents: IntArray, first: int) -> tuple[FloatArray, FloatArray] | None:
    """Return what `_sides` does in one loop; None where there is no compiler, or a limb that is never bent."""
    kernel, (frames, joints) = compiled(), poses.rotations.shape[:2]
    if kernel is None:
        return None
    count = which.shape[1]
    sines, axes, shown = np.empty((frames, count)), np.empty((count, 3)), np.empty(count, dtype=np.bool_)
    given = np.ascontiguousarray(poses.positions), np.ascontiguousarray(poses.rotations)
    limbs = np.ascontiguousarray(np.vstack((which, parents)).T, dtype=np.int64)
    kernel.bends(*given, frames, joints, first, limbs, count, _BENT, sines, axes, shown)
    return (sines, axes) if shown.all() else None


def _sides(
    poses: WorldPoses, which: IntArray, parents: IntArray, limbs: Sequence[_Limb], first: int
) -> tuple[FloatArray, FloatArray]:
    """Return the sines by which n limbs are bent, shape (F, n), and the sums of the axes about which they are, (n, 3).

    An axis is upper x lower of a limb's unit bones, in the frame of its joint's parent, which has the sine's length.
    """
    tops, joints, ends = which
    upper, lower = (poses.positions[:, b] - poses.positions[:, a] for a, b in ((tops, joints), (joints, ends)))
    lengths = rot.length(upper) * rot.length(lower)
    sides: FloatArray = rot.cross(upper, lower) / np.maximum(lengths, np.finfo(float).tiny)[..., None]
    sines = rot.length(sides)
    bent = sines > _BENT
    bent[:first] = False
    for i in np.flatnonzero(~bent.any(axis=0)).tolist():
        towards = limbs[i][1]()
        if towards is not None:
            sides[:, i], bent[:, i] = rot.cross(lower[:, i], towards), True
    own = rot.unrotate(poses.rotations[:, parents], sides)
    own[~bent] = 0.0
    return sines, own.sum(axis=0)


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
