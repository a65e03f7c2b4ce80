"""How knees and elbows bend: about which axis, and to which side, also where they are straight."""

from __future__ import annotations

from functools import cache, lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.in_one_loop import read_off
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy, Leg
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

    # What returns the side, shape (F, 3), towards which a limb bends where no frame shows it.
    _Towards = Callable[[], FloatArray | None]

_BENT = float(np.sin(np.radians(2.0)))  # a limb bent by more than this shows to which side it bends
_CLEAR_ANGLE = float(np.radians(15.0))  # further no elbow and no knee gives way to its other side
_CLEAR = float(np.sin(_CLEAR_ANGLE))
_GLITCH = 2  # so few frames show nothing by themselves
_STRAIGHT = float(np.sin(np.radians(0.2)))  # a limb bent by less than this hardly shortens when it bends
_TOES_SAY = 0.5  # of a shank that goes straight to the toes

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
    bent : (least, most), rad
        The range of those.
    """

    joint: int
    axis: FloatArray
    straight: BoolArray
    upper: FloatArray
    lower: FloatArray
    angles: FloatArray
    bent: tuple[float, float]

    def angles_in(self, rotations: FloatArray) -> FloatArray:
        """Return how far it is bent, shape (n,), rad, from -pi to pi, by local rotations of all joints, (n, J, 4)."""
        return turns_about(self.axis, self.upper, rot.rotate(rotations[:, self.joint], self.lower))


def find_bends(skeleton: Skeleton, poses: WorldPoses, anatomy: Anatomy, *, first: int) -> tuple[Bend, ...]:
    """Return the bends of knees and elbows, left before right, knees first.

    A limb bends as it does in the clip's own frames from `first` on: in all where it is bent at all, but where those
    in which it is clearly bent say otherwise, these count alone. One that is always straight bends as bodies do: knees
    to the toes' side, elbows so that the hands come to the front. So do knees that are never clearly bent, and whose
    toes clearly say otherwise.
    """
    limbs = _limbs_of(skeleton, anatomy)
    found = _bends_at_once(poses, limbs, first) or _bends_by_blocks(poses, anatomy, limbs, first)
    return tuple(_as_toes_say(bend, skeleton, poses, anatomy, first) for bend in found)


def _bends_by_blocks(poses: WorldPoses, anatomy: Anatomy, limbs: NDArray[np.int64], first: int) -> tuple[Bend, ...]:
    front = cache(lambda: _front(poses, anatomy))

    def backward(leg: Leg) -> FloatArray | None:
        toes = way_to_toes(poses, leg)
        forward = front() if toes is None else toes
        return None if forward is None else -forward

    towards = [partial(backward, leg) for leg in anatomy.legs or ()] + [front for _ in anatomy.arms or ()]
    # A few limbs at a time: those of a long motion all at once would take several times its memory.
    together = max(_BLOCK_POSES // len(poses.positions), 1)
    blocks = (slice(i, i + together) for i in range(0, len(limbs), together))
    return tuple(bend for some in blocks for bend in _bends(poses, limbs[some], towards[some], first))


def _as_toes_say(bend: Bend, skeleton: Skeleton, poses: WorldPoses, anatomy: Anatomy, first: int) -> Bend:
    """Return a bend, to its other side where it is a knee, never clearly bent, and would take the shank to the toes."""
    leg = next((leg for leg in anatomy.legs or () if leg.knee == bend.joint), None)
    if leg is None or np.count_nonzero(np.abs(bend.angles) > _CLEAR_ANGLE) > _GLITCH:
        return bend
    after = poses.at(slice(first, None))
    toes = way_to_toes(after, leg)
    if toes is None:
        return bend
    axis = rot.rotate(after.rotations[:, skeleton.parents[leg.knee]], bend.axis)
    moved = rot.cross(axis, after.positions[:, leg.ankle] - after.positions[:, leg.knee])
    size = np.maximum(rot.length(moved) * rot.length(toes), np.finfo(float).tiny)
    if float(np.mean(rot.dot(moved, toes) / size)) < _TOES_SAY:
        return bend
    least, most = bend.bent
    return replace(bend, axis=frozen(-bend.axis), angles=frozen(-bend.angles), bent=(-most, -least))


@lru_cache(maxsize=8)
def _limbs_of(skeleton: Skeleton, anatomy: Anatomy) -> NDArray[np.int64]:
    """Return the joints of n limbs, shape (n, 4): the top, the one that bends, the end, and where the second hangs."""
    parents = [(*limb, skeleton.parents[limb[1]]) for limb in anatomy.limbs]
    return frozen(np.array(parents, dtype=np.int64).reshape(-1, 4))


def _bends_at_once(poses: WorldPoses, limbs: NDArray[np.int64], first: int) -> tuple[Bend, ...] | None:
    """Return what `_bends` does in one loop; None where there is no compiler, or a limb that is never bent."""
    kernel, (frames, joints), count = compiled(), poses.rotations.shape[:2], len(limbs)
    if kernel is None:
        return None
    straight, turns = np.empty((count, frames), dtype=np.bool_), np.empty((2, count, frames))
    axes, bones, lower = np.empty((count, 3)), np.empty((count, 2, 3)), np.empty((frames, count, 3))
    given = np.ascontiguousarray(poses.positions), np.ascontiguousarray(poses.rotations), frames, joints, first
    bounds = _BENT, _CLEAR, _STRAIGHT, _GLITCH
    if not kernel.bends(*given, limbs, count, *bounds, straight, axes, bones, lower, turns):
        return None
    angles = np.arctan2(turns[0], turns[1] - _along(axes, bones[:, 0], lower))
    return _rows_of(limbs[:, 1], axes, straight, bones, angles[:, first:])


def _bends(poses: WorldPoses, limbs: NDArray[np.int64], towards: Sequence[_Towards], first: int) -> tuple[Bend, ...]:
    _, joints, _, parents = limbs.T
    sines, axes = _sides(poses, limbs, towards, first)
    triples = np.concatenate((limbs[:, [0, 1, 3]], limbs[:, [1, 2, 1]]))
    bones = directions_of(poses, triples, first=first).reshape(2, -1, 3)
    uppers, lowers = bones
    local = rot.between(poses.rotations[:, parents], poses.rotations[:, joints])
    lengths = np.sqrt([axis.dot(axis) for axis in axes])
    axes /= np.where(lengths > 0.0, lengths, 1.0)[:, None]
    turns = turns_about(axes, uppers, rot.rotate(local, lowers))
    straight = np.ascontiguousarray((sines < _STRAIGHT).T)
    some = lengths > 0.0
    # Limb by limb in memory: those of a limb are looked at together.
    angles = np.ascontiguousarray(turns[first:, some].T)
    return _rows_of(joints[some], axes[some], straight[some], bones.swapaxes(0, 1)[some], angles)


def _rows_of(
    joints: IntArray, axes: FloatArray, straight: BoolArray, bones: FloatArray, angles: FloatArray
) -> tuple[Bend, ...]:
    """Return n bends of arrays (n, ...), their bones (n, 2, 3)."""
    ranges = zip(angles.min(axis=1).tolist(), angles.max(axis=1).tolist(), strict=True)
    rows = map(frozen, (axes, straight, bones[:, 0], bones[:, 1], angles))
    return tuple(Bend(*each) for each in zip(joints.tolist(), *rows, ranges, strict=True))


def turns_about(axis: FloatArray, start: FloatArray, stop: FloatArray) -> FloatArray:
    """Return the angle about a unit axis (3,) from one direction to another, shapes (..., 3), in rad, (-pi, pi].

    Or about n axes (n, 3) from n directions, (n, 3), to others, (F, n, 3). It is atan2(a . (u x v), u . v - (a . u)
    (a . v)): what they have along the axis does not count.
    """
    sine = rot.dot(axis, rot.cross(start, stop))
    along = (start @ axis) * (stop @ axis) if axis.ndim == 1 else _along(axis, start, stop).T
    angles: FloatArray = np.arctan2(sine, rot.dot(start, stop) - along)
    return angles


def _along(axes: FloatArray, starts: FloatArray, stops: FloatArray) -> FloatArray:
    """Return (a . u) (a . v) of n axes a and directions u, (n, 3), and others v, (F, n, 3), shape (n, F)."""
    own, other = np.matmul(starts[:, None], axes[..., None]), np.matmul(stops.swapaxes(0, 1), axes[..., None])
    along: FloatArray = own[:, 0] * other[..., 0]
    return along


def mean_direction(poses: WorldPoses, start: int, stop: int, *, seen_from: int, first: int) -> FloatArray:
    """Return the unit direction from one joint to another in the frame of a third, shape (3,), the mean of frames."""
    direction: FloatArray = directions_of(poses, np.array([[start, stop, seen_from]]), first=first)[0]
    return direction


def directions_of(poses: WorldPoses, triples: IntArray, *, first: int) -> FloatArray:
    """Return `mean_direction` of n triples of joints, start, stop and the one that they are seen from, shape (n, 3)."""
    found = read_off("directions", poses.positions, poses.rotations, triples, shape=triples.shape, first=first)
    if found is not None:
        return found
    starts, stops, seen_from = triples.T
    ways = poses.positions[first:, stops] - poses.positions[first:, starts]
    own = rot.unrotate(poses.rotations[first:, seen_from], ways).sum(axis=0)
    directions: FloatArray = own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), np.finfo(float).tiny)
    return directions


def way_to_toes(poses: WorldPoses, leg: Leg) -> FloatArray | None:
    """Return the way from the ankle to the toe, shape (F, 3); None where nothing shows it."""
    if leg.toe is not None:
        forward: FloatArray = poses.positions[:, leg.toe] - poses.positions[:, leg.ankle]
        return forward
    return None if leg.tip is None else rot.rotate(poses.rotations[:, leg.ankle], np.array(leg.tip))


def _sides(
    poses: WorldPoses, limbs: NDArray[np.int64], towards: Sequence[_Towards], first: int
) -> tuple[FloatArray, FloatArray]:
    """Return the sines by which n limbs are bent, shape (F, n), and the sums of the axes about which they are, (n, 3).

    An axis is upper x lower of a limb's unit bones, in the frame of its joint's parent, which has the sine's length.
    An elbow that hangs all but straight for long gives way to its other side by a little: however many such frames,
    those in which it is clearly bent go before them.
    """
    tops, joints, ends, parents = limbs.T
    upper, lower = (poses.positions[:, b] - poses.positions[:, a] for a, b in ((tops, joints), (joints, ends)))
    lengths = rot.length(upper) * rot.length(lower)
    sides: FloatArray = rot.cross(upper, lower) / np.maximum(lengths, np.finfo(float).tiny)[..., None]
    sines = rot.length(sides)
    bent = sines > _BENT
    bent[:first] = False
    for i in np.flatnonzero(~bent.any(axis=0)).tolist():
        side = towards[i]()
        if side is not None:
            sides[:, i], bent[:, i] = rot.cross(lower[:, i], side), True
    own = rot.unrotate(poses.rotations[:, parents], sides)
    own[~bent] = 0.0
    sums: FloatArray = own.sum(axis=0)
    clear = sines > _CLEAR
    clear[:first] = False
    own[~clear] = 0.0
    of_clear = own.sum(axis=0)
    other = (clear.sum(axis=0) > _GLITCH) & (rot.dot(of_clear, sums) < 0.0)
    return sines, np.where(other[:, None], of_clear, sums)


def _front(poses: WorldPoses, anatomy: Anatomy) -> FloatArray | None:
    """Return where the body's front is, left x up of its trunk, shape (F, 3)."""
    legs, arms = anatomy.legs, anatomy.arms
    if legs is None or arms is None:
        return None
    shoulders = [poses.positions[:, arm.shoulder] for arm in anatomy.left_first(arms)]
    hips = [poses.positions[:, leg.thigh] for leg in legs]
    across = shoulders[0] - shoulders[1]
    trunk = shoulders[0] + shoulders[1] - hips[0] - hips[1]
    front: FloatArray = rot.cross(across, trunk)
    return front
