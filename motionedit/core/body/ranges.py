"""How far an edit takes joints beyond the range that they have in its input."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.again import LastFew, Same
from motionedit.core.arrays import frozen
from motionedit.core.body.bones import below
from motionedit.core.body.whole import whole_joints
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# Degrees beyond its range in the input from which a joint looks wrong: most of them; neck and spine, which are many
# joints that each take a part; shoulders and hips: an arm that hangs in the input may be raised overhead. Knees and
# elbows, which fold, are seen where they bend back (bent_back.py).
MOST, TRUNK, BALL = 45.0, 60.0, 150.0

_BLOCK_POSES = 1 << 13
# Of a cosine: more by far than its rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Region:
    """A joint as it turns against one above it, and from how many degrees beyond its range on that is seen."""

    lower: int
    upper: int
    most: float


@dataclass(frozen=True)
class Beyond:
    """A joint that is taken beyond its range in the input: by how many `degrees`, at which frame, and what is seen.

    `against` is the joint that it is measured against, None for a knee or an elbow that is bent back.
    """

    joint: int
    against: int | None
    frame: int
    degrees: float
    most: float


Limb = tuple[int, int, int]  # its top, the joint that bends, its end


@lru_cache(maxsize=8)
def regions_of(skeleton: Skeleton, anatomy: Anatomy, *, travel: int) -> tuple[Region, ...]:
    """Return what has a range: every joint against its parent, and neck, spine, limbs against what carries them.

    The joints that turn a whole body, from the one that carries the `travel` on, have none, nor have those above and
    beside them; knees and elbows neither.
    """
    whole = whole_joints(skeleton, anatomy, travel=travel)
    carried, bending = below(skeleton, travel), {limb[1] for limb in anatomy.limbs}
    seen = dict.fromkeys(_trunk(skeleton, anatomy), TRUNK) | dict.fromkeys((limb[0] for limb in anatomy.limbs), BALL)
    found = {
        (j, skeleton.parents[j]): seen.get(j, MOST)
        for j in range(len(skeleton))
        if carried[j] and j not in whole and j not in bending
    }
    for lower, upper, most in _wholes(anatomy):
        if lower is not None and upper is not None and lower != upper:
            found[lower, upper] = most
    return tuple(Region(lower, upper, most) for (lower, upper), most in sorted(found.items()))


def beyond_range(
    before: Motion, after: Motion, regions: tuple[Region, ...], *, first: int, touched: BoolArray
) -> list[Beyond]:
    """Return the regions that an edit takes further beyond their range in the input than is not seen.

    The range is the largest angle from the mean rotation of the input, the frames before `first` left out. A region
    with no joint among the `touched`, shape (J,), is left out.
    """
    ways = _with_ways(before.skeleton, regions)
    # Turned by less altogether than is seen at any frame, a region cannot be farther off its mean by more.
    far = ways.moved @ _largest_changes(before, after, first, touched) > ways.most
    asked = [ways.regions[i] for i in np.flatnonzero(far)]
    found = []
    # A few regions at a time: those of a long motion all at once would take several times its memory.
    together = max(_BLOCK_POSES // len(before), 1)
    for start in range(0, len(asked), together):
        some = asked[start : start + together]
        own, taken = (_all_relative(motion.rotations[first:], some) for motion in (before, after))
        means = rot.mean_of_products(np.einsum("fni,fnj->nij", own, own))
        angles = np.degrees(rot.angle_between(means, taken))
        worst = angles.argmax(axis=0)
        degrees = angles.max(axis=0) - np.degrees(rot.angle_between(means, own)).max(axis=0)
        found += [
            Beyond(region.lower, region.upper, first + int(worst[i]), float(degrees[i]), region.most)
            for i, (region, _, _) in enumerate(some)
            if degrees[i] > region.most
        ]
    return found


def _largest_changes(before: Motion, after: Motion, first: int, touched: BoolArray) -> FloatArray:
    """Return by how many degrees each joint is turned at most, shape (J,), rounded up; 0 where it is not touched."""
    cosines = np.ones(len(touched))
    together = max(_BLOCK_POSES // len(touched), 1)
    for start in range(first, len(before), together):
        block = slice(start, start + together)
        np.minimum(cosines, rot.half_cosines(before.rotations[block], after.rotations[block]).min(axis=0), out=cosines)
    largest: FloatArray = np.degrees(2.0 * np.arccos(cosines * (1.0 - _ROUNDING))) * touched
    return largest


def _wholes(anatomy: Anatomy) -> Iterator[tuple[int | None, int | None, float]]:
    """Yield what turns as one by several joints: the lower and the upper joint, and what is seen."""
    yield anatomy.head, anatomy.chest, TRUNK
    yield anatomy.chest, anatomy.pelvis, TRUNK
    for leg in anatomy.legs or ():
        yield leg.thigh, anatomy.pelvis, BALL
        yield leg.ankle, leg.knee, MOST
    for arm in anatomy.arms or ():
        yield arm.clavicle, anatomy.chest, MOST
        yield arm.shoulder, anatomy.chest, BALL
        yield arm.wrist, arm.elbow, MOST


def _trunk(skeleton: Skeleton, anatomy: Anatomy) -> frozenset[int]:
    """Return the joints of neck and spine: those on the way to the head and the chest."""
    ends = (joint for joint in (anatomy.head, anatomy.chest) if joint is not None)
    return frozenset(int(j) for end in ends for j in skeleton.chain(end))


# A region with its `_ways`.
_RegionWays = tuple[Region, tuple[int, ...], tuple[int, ...]]


class _AllWays(NamedTuple):
    """R regions with their ways, which joints turn them, shape (R, J), 1 or 0, and what is seen of each, (R,)."""

    regions: tuple[_RegionWays, ...]
    moved: FloatArray
    most: FloatArray


def _with_ways(skeleton: Skeleton, regions: tuple[Region, ...]) -> _AllWays:
    """Return regions with their ways: once for the clips that share a skeleton."""
    key = skeleton, Same(regions)
    known = _ALL_WAYS.get(key)
    if known is not None:
        return known
    every = tuple((region, *_ways(skeleton, region)) for region in regions)
    moved = np.zeros((len(every), len(skeleton)))
    for row, (_, up, down) in zip(moved, every, strict=True):
        row[[*up, *down]] = 1.0
    return _ALL_WAYS.keep(key, _AllWays(every, frozen(moved), frozen(np.array([each.most for each in regions]))))


_ALL_WAYS: LastFew[_AllWays] = LastFew(8)


def _ways(skeleton: Skeleton, region: Region) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the joints between a region's upper joint and where the ways to both part, and between that and its lower.

    Both from the root outwards.
    """
    upper, lower = (skeleton.chain(joint).tolist() for joint in (region.upper, region.lower))
    shared = sum(one == other for one, other in zip(upper, lower, strict=False))
    return tuple(upper[shared:]), tuple(lower[shared:])


def _all_relative(rotations: FloatArray, asked: Sequence[_RegionWays]) -> FloatArray:
    """Return `_relative` of all regions, shape (F, n, 4)."""
    # Most are a joint against its parent.
    turned = rotations[:, [down[0] if down else 0 for _, _, down in asked]]
    for i, (_, up, down) in enumerate(asked):
        if up or len(down) != 1:
            turned[:, i] = _relative(rotations, up, down)
    return turned


def _relative(rotations: FloatArray, up: Sequence[int], down: Sequence[int]) -> FloatArray:
    """Return the rotation of the lower joint in the frame of the upper one, shape (F, 4)."""
    turned = product(rotations, down)
    return turned if not up else rot.between(product(rotations, up), turned)


def product(rotations: FloatArray, way: Sequence[int]) -> FloatArray:
    """Return the product of the rotations of joints on a way, shape (F, 4)."""
    product = rotations[:, way[0]] if way else np.broadcast_to(rot.IDENTITY, (len(rotations), 4))
    for j in way[1:]:
        product = rot.multiply(product, rotations[:, j])
    return product
