"""Which way is up: three witnesses, the floor, the OFFSETs and the way the body stands, and how sure they are."""

from __future__ import annotations

from functools import lru_cache
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen, median
from motionedit.core.body.bones import below, hanging
from motionedit.core.body.ground import axis_name, axis_vector
from motionedit.core.body.tree import zero_pose
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# What speaks against an axis, most of all first. A floor is worth as much as a stance, an OFFSET pose a little more
# than the stance (it stands where a body may lie), and most programs write y up, some z, hardly any another axis.
_OFFSETS_WEIGHT = 1.2
_PRIOR = {"y": 0.0, "z": 0.1, "x": 0.4, "-y": 0.5, "-z": 0.5, "-x": 0.5}
SIGNED_AXES = ("x", "y", "z", "-x", "-y", "-z")
# Legs by which the lowest points rise and fall: as arms of a lying body do, and where no floor is.
_FLOOR, _NO_FLOOR = 0.1, 0.4
_MOST = 0.7  # of the frames
_CLEAR = 0.9  # of the OFFSET pose's stance along one axis, both legs alike and the trunk not against them
_AGREED = 0.95  # along one axis
_SURE = 0.3  # by which the best axis must be better than the next for no word to be said
_FRAMES = 256  # at most are looked at


@dataclass(frozen=True, eq=False)
class Up:
    """The signed unit axis (3,) that is up, and a line for the user where the witnesses leave it unsure."""

    axis: FloatArray
    warning: str | None = None


def find_up(motion: Motion, bones: Skeleton, poses: WorldPoses, anatomy: Anatomy, *, first: int, travel: int = 0) -> Up:
    """Return which way is up; y where there is no body.

    An axis is the worse the more its lowest points come and go (the floor), the less the skeleton's OFFSETs stand along
    it where they clearly stand at all, and the less the body stands along it in the median frame.

    Parameters
    ----------
    bones : Skeleton
        As `bones_of` returns it.
    first : int
        The first frame after a rest pose.
    travel : int
        The joint that carries the travel: what does not hang on it stands on no floor.
    """
    shown = poses.positions[first :: max(1, -(-(len(motion) - first) // _FRAMES))]
    stands = _stance(anatomy, shown)
    if stands is None:
        return Up(axis_vector("y"))
    offsets = _clear_offsets(bones, anatomy)
    if offsets is not None and min(float(offsets.max()), float(stands[offsets.argmax()])) > _AGREED:
        # Where both say so no floor could say otherwise.
        return Up(axis_vector("xyz"[int(offsets.argmax())]))
    against = {name: 1.0 - along for name, along in _along(stands).items()}
    said = {"the body mostly stands": axis_name(stands)}
    if offsets is not None:
        against = {name: against[name] + _OFFSETS_WEIGHT * (1.0 - along) for name, along in _along(offsets).items()}
        said = {"the OFFSETs stand": axis_name(offsets), **said}
    best, _, lead = _best(against, dict.fromkeys(_PRIOR, 0.0))
    if lead > 1.0 + _SURE and set(said.values()) == {best}:
        # No floor is worth more than 1: here, too, none could say otherwise.
        return Up(axis_vector(best))
    # Joint by joint in memory: numpy takes the least of many rows much faster than that of many columns.
    joint_by_joint = np.take(shown, _body(bones, travel), axis=1).swapaxes(0, 1)
    floors = _floors(np.ascontiguousarray(joint_by_joint), size=anatomy.leg_length)
    best, next_best, lead = _best(against, floors)
    others = {words: axis for words, axis in said.items() if axis != best}
    settled = all(floors[best] < floors[axis] - _SURE for axis in others.values())
    if lead >= _SURE and settled:
        return Up(axis_vector(best))
    why = ", ".join(f"{words} along {axis}" for words, axis in others.items()) or f"{next_best} is nearly as likely"
    return Up(
        axis_vector(best), f"up is taken to be {best}, but {why}; 'up' in a spec, --up elsewhere, says which it is"
    )


def _best(against: Mapping[str, float], floors: Mapping[str, float]) -> tuple[str, str, float]:
    """Return the axis that least speaks against, the next, and by how much that is worse."""
    costs = {name: against[name] + floors[name] + prior for name, prior in _PRIOR.items()}
    best, next_best = sorted(costs, key=lambda name: costs[name])[:2]
    return best, next_best, costs[next_best] - costs[best]


@lru_cache(maxsize=4)
def _body(bones: Skeleton, travel: int) -> IntArray:
    """Return the joints that may stand on a floor: those of the body, but no hair, tail or prop."""
    return frozen(np.flatnonzero(below(bones, travel) & ~hanging(bones)))


def _floors(positions: FloatArray, *, size: float) -> dict[str, float]:
    """Return for each signed axis how little its lowest points, of positions (J, F, 3), are a floor, 0 to 1.

    A floor is equally low in most frames; a jump leaves it, and so does a fall.
    """
    if size <= 0.0:
        return dict.fromkeys(_PRIOR, 0.0)
    lowest = np.concatenate((positions.min(axis=0), -positions.max(axis=0)), axis=1)
    ordered = np.sort(lowest, axis=0)
    most = int(_MOST * (len(ordered) - 1))
    spread = (ordered[most:] - ordered[: len(ordered) - most]).min(axis=0) / size
    floors = np.clip((spread - _FLOOR) / (_NO_FLOOR - _FLOOR), 0.0, 1.0)
    return dict(zip(SIGNED_AXES, floors.tolist(), strict=True))


def _along(way: FloatArray) -> dict[str, float]:
    """Return how much of a vector, shape (3,), is along each signed axis."""
    return dict(zip(SIGNED_AXES, [*way.tolist(), *(-way).tolist()], strict=True))


def _stance(anatomy: Anatomy, positions: FloatArray) -> FloatArray | None:
    """Return the way a body stands: the mean of hips over feet and head over hips, each of length 1, shape (3,)."""
    ways = [_unit(way) for way in _ways_up(anatomy, positions)]
    stance: FloatArray = sum(ways[1:], ways[0]) / len(ways) if ways else np.zeros(3)
    return stance if stance.any() else None


@lru_cache(maxsize=4)
def _clear_offsets(bones: Skeleton, anatomy: Anatomy) -> FloatArray | None:
    """Return the way the OFFSETs stand, shape (3,); None where they only fold bones away, each along its own axis."""
    places = zero_pose(bones)
    ways = [_unit(way) for way in _ways_up(anatomy, places[None])]
    if not ways:
        return None
    if anatomy.legs is not None:
        left, right = (_unit(places[leg.thigh] - places[leg.ankle]) for leg in anatomy.legs)
        if left @ right < _CLEAR or (len(ways) > 1 and ways[0] @ ways[1] < -0.1):
            return None
    clear = np.abs(ways[0]).max() >= _CLEAR
    return ways[0] if clear else None


def _ways_up(anatomy: Anatomy, positions: FloatArray) -> FloatArray:
    """Return the median ways from what is below to what stands over it, shape (n, 3), of positions (F, J, 3)."""
    joints, kernel = _one_over_another(anatomy), compiled()
    if kernel is not None:
        ways = np.empty((len(joints), 3))
        kernel.median_ways(np.ascontiguousarray(positions), *positions.shape[:2], joints, len(joints), ways)
        return ways
    low, top = (positions[:, one] + positions[:, other] for one, other in (joints.T[:2], joints.T[2:]))
    return median(top / 2.0 - low / 2.0)


@lru_cache(maxsize=4)
def _one_over_another(anatomy: Anatomy) -> NDArray[np.int64]:
    """Return two joints, and two whose middle is over theirs, shape (n, 4): feet and hips, then hips and head."""
    top = anatomy.head if anatomy.head is not None else anatomy.chest
    found: list[tuple[int, int, int, int]] = []
    if anatomy.legs is not None:
        left, right = anatomy.legs
        hips = left.thigh, right.thigh
        found.append((left.ankle, right.ankle, *hips))
        if top is not None and top != anatomy.pelvis:
            found.append((*hips, top, top))
    elif top is not None and anatomy.chest is not None and top != anatomy.chest:
        found.append((anatomy.chest, anatomy.chest, top, top))
    return frozen(np.array(found, dtype=np.int64).reshape(-1, 4))


def _unit(vector: FloatArray) -> FloatArray:
    length = sqrt(vector.dot(vector))
    return vector / length if length > 0.0 else np.zeros(3)
