"""How far the joints of a body turn: cones of swing and twist about where a clip has them, from human ranges.

A joint's rotation against its centre, q_rel = q_c^-1 q, is a swing of the bone v, by the angle between v and q_rel v,
after a twist about it, 2 atan2(v . vec(q_rel), w). Rigs disagree about where a joint's zero is; a clip shows it: the
centre is the clip's own mean, of a back, which bends forward farther than back, so much forward of it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.bends import directions_of, mean_direction
from motionedit.core.body.in_one_loop import read_off
from motionedit.core.body.whole import whole_joints
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True)
class Range:
    """Half of a range of motion: how far a bone swings, to its back no farther than `back`, and twists, degrees."""

    swing: float
    twist: float
    back: float | None = None


# Half ranges of regions: D. A. Neumann, Kinesiology of the Musculoskeletal System,
# and the American Academy of Orthopaedic Surgeons' tables, rounded; a forearm's pronation is in its wrist, for elbows
# are hinges.
NECK = Range(65.0, 90.0)
SPINE = Range(90.0, 70.0, back=35.0)
CLAVICLE = Range(45.0, 50.0)
SHOULDER = Range(165.0, 180.0)
HIP = Range(135.0, 80.0)
WRIST = Range(90.0, 120.0)
ANKLE = Range(60.0, 45.0)

_BLOCK_POSES = 1 << 13
_OPPOSITE = 1e-6  # of unit vectors: a sum as short as this has no direction


@dataclass(frozen=True, eq=False)
class Limits:
    """The cones of some joints.

    Attributes
    ----------
    joints : shape (C,)
    centers : shape (C, 4)
        The local rotation in the middle of each.
    along : shape (C, 3)
        The bone, a unit vector in the joint's frame.
    swing, twist : shape (C,)
        Half ranges, rad; never less than what the clip itself has.
    """

    joints: IntArray
    centers: FloatArray
    along: FloatArray
    swing: FloatArray
    twist: FloatArray

    def __len__(self) -> int:
        """How many there are."""
        return len(self.joints)


NO_LIMITS = Limits(np.zeros(0, dtype=np.intp), np.zeros((0, 4)), np.zeros((0, 3)), np.zeros(0), np.zeros(0))


def human_limits(motion: Motion, poses: WorldPoses, anatomy: Anatomy, *, travel: int, first: int) -> Limits:
    """Return the limits of neck, spine, clavicles, shoulders, hips, wrists and ankles that were found."""
    joints, bones, sides, halves = _wanted(motion.skeleton, anatomy, travel)
    found = []
    # A few joints at a time: those of a long motion all at once would take several times its memory.
    together = len(joints) if compiled() else max(_BLOCK_POSES // len(motion), 1)
    for start in range(0, len(joints), max(together, 1)):
        some = slice(start, start + together)
        along, left = (directions_of(poses, ways[some], first=first) for ways in (bones, sides))
        found.append(_limits(motion, joints[some], along, halves[some], first, left=left))
    return _together(found)


@lru_cache(maxsize=8)
def _wanted(skeleton: Skeleton, anatomy: Anatomy, travel: int) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    """Return the n joints that have limits, (n,), and their half ranges, swing, twist, and swing to the back, (n, 3).

    Between them their bones and the ways to the body's left, both as `directions_of`, (n, 3).
    """
    left, right = (leg.thigh for leg in anatomy.left_first(anatomy.legs)) if anatomy.legs else (0, 0)
    wanted: dict[int, tuple[int, int, float, float, float]] = {}
    for region, joints in _regions(skeleton, anatomy, travel):
        # Of a region that n joints share each may do more than its nth part: not all of them are always asked.
        share = math.radians(1.0 / math.sqrt(len(joints)))
        back = region.swing if region.back is None or not anatomy.legs else region.back
        half = share * region.swing, share * region.twist, share * back
        wanted.update({joint: (top, end, *half) for joint, top, end in joints})
    rows = sorted((joint, *its) for joint, its in wanted.items())
    which = np.array([row[0] for row in rows], dtype=np.int64)
    bones = np.array([(top, end, joint) for joint, top, end, *_ in rows], dtype=np.int64).reshape(-1, 3)
    sides = np.array([(right, left, row[0]) for row in rows], dtype=np.int64).reshape(-1, 3)
    return frozen(which), frozen(bones), frozen(sides), frozen(np.array([row[3:] for row in rows]).reshape(-1, 3))


def given_limits(motion: Motion, poses: WorldPoses, given: Mapping[int, Range], *, first: int) -> Limits:
    """Return limits that a user gives by joint; a joint's bone leads to the middle of its children."""
    found = []
    for joint in sorted(given):
        along = _bone(motion.skeleton, poses, joint, first)
        halves = np.radians([[given[joint].swing, given[joint].twist, given[joint].swing]])
        found.append(_limits(motion, np.array([joint]), along[None], halves, first))
    return _together(found)


def _bone(skeleton: Skeleton, poses: WorldPoses, joint: int, first: int) -> FloatArray:
    """Return where a joint's bone leads, a unit vector in its frame, shape (3,): from above where none is below.

    A child that stands where the joint does is passed on to its own children; of children on opposite sides the first
    counts.
    """
    ways, waiting = [], [joint]
    while waiting:
        for child in np.flatnonzero(skeleton.parents == waiting.pop(0)).tolist():
            way = mean_direction(poses, joint, child, seen_from=joint, first=first)
            if way.any():
                ways.append(way)
            else:
                waiting.append(child)
    ways = ways or [mean_direction(poses, int(skeleton.parents[joint]), joint, seen_from=joint, first=first)]
    middle = np.sum(ways, axis=0)
    length = float(np.linalg.norm(middle))
    return middle / length if length > _OPPOSITE else ways[0]


def _limits(
    motion: Motion,
    joints: IntArray,
    along: FloatArray,
    halves: FloatArray,
    first: int,
    *,
    left: FloatArray | None = None,
) -> Limits:
    """Return the limits of n joints about their means in a clip after frame `first`.

    Their bones are `along`, (n, 3); they are no tighter than half ranges, swing, twist and swing to the back, (n, 3),
    rad, and than what the clip does. Unless all swing alike to the back, `left` are the ways there, (n, 3).
    """
    swing, twist, back = halves.T
    bent = np.tile(rot.IDENTITY, (len(joints), 1))
    if left is not None:
        across = left - rot.dot(left, along)[:, None] * along
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(float).tiny)
        bent = rot.exp(((swing - back) / 2.0)[:, None] * across)
    centers, widest = _cones(motion, joints, along, bent, first)
    swing, twist = frozen(np.maximum(((swing + back) / 2.0, twist), widest.T))
    return Limits(joints, frozen(centers), frozen(along), swing, twist)


def _together(parts: Sequence[Limits]) -> Limits:
    if len(parts) < 2:
        return parts[0] if parts else NO_LIMITS
    arrays = zip(*((one.joints, one.centers, one.along, one.swing, one.twist) for one in parts), strict=True)
    return Limits(*(frozen(np.concatenate(each)) for each in arrays))


def swing_and_twist(q: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return by how much rotations (..., 4) swing unit vectors, and how far they twist about them, rad.

    `along` (3,) is one vector for all, or (C, 3) one for each of the last but one axis of q.
    """
    twist = 2.0 * np.arctan2(rot.dot(q[..., 1:], along), q[..., 0])
    twist = (twist + np.pi) % (2.0 * np.pi) - np.pi
    turned = rot.rotate(q, along)
    across = rot.length(rot.cross(along, turned))
    swing: FloatArray = np.arctan2(across, rot.dot(turned, along))
    return swing, twist


def _cones(
    motion: Motion, joints: IntArray, along: FloatArray, bent: FloatArray, first: int
) -> tuple[FloatArray, FloatArray]:
    """Return the centers of n joints' rotations, (n, 4), and how far these swing and twist bones (n, 3) there, (n, 2).

    A center is the mean and then a turn `bent`, (n, 4). A mean is the first eigenvector of sum q q^T, signed as the
    first frame's.
    """
    q = motion.rotations
    cones = read_off("cones", None, q, joints, along, bent, shape=(len(joints), 6), first=first)
    if cones is not None:
        return cones[:, :4], cones[:, 4:]
    means = rot.mean_of_products(np.einsum("fni,fnj->nij", q[first:, joints], q[first:, joints]))
    signs = np.sum(means * q[first, joints], axis=-1, keepdims=True)
    centers = rot.multiply(np.where(signs < 0.0, -means, means), bent)
    swing, twist = swing_and_twist(rot.between(centers, q[first:, joints]), along)
    return centers, np.stack((swing.max(axis=0), np.abs(twist).max(axis=0)), axis=1)


_Joint = tuple[int, int, int]  # a joint, and from where to where its bone is


def _regions(skeleton: Skeleton, anatomy: Anatomy, travel: int) -> Iterator[tuple[Range, list[_Joint]]]:
    """Yield regions with their joints."""
    hips = whole_joints(skeleton, anatomy, travel=travel)[-1]
    chest = hips if anatomy.chest is None else anatomy.chest
    spine = skeleton.between(hips, chest)
    if spine:
        yield SPINE, [(joint, int(skeleton.parents[joint]), joint) for joint in spine]
    neck = [] if anatomy.head is None else skeleton.between(chest, anatomy.head)
    if neck:
        yield NECK, [(joint, int(skeleton.parents[joint]), joint) for joint in neck]
    for arm in anatomy.arms or ():
        clavicles = skeleton.between(chest, arm.shoulder)[:-1]
        if clavicles:
            yield CLAVICLE, [(joint, joint, arm.shoulder) for joint in clavicles]
        yield SHOULDER, [(arm.shoulder, arm.shoulder, arm.elbow)]
        yield WRIST, [(arm.wrist, arm.elbow, arm.wrist)]
    for leg in anatomy.legs or ():
        yield HIP, [(leg.thigh, leg.thigh, leg.knee)]
        end = (leg.knee, leg.ankle) if leg.toe is None else (leg.ankle, leg.toe)
        yield ANKLE, [(leg.ankle, *end)]
