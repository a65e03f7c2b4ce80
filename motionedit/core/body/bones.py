"""Bones: what stands between a body's joints, and which joint carries them all through the world.

A position channel replaces its axis of OFFSET, so an OFFSET alone is no bone: on a joint that carries the travel it is
where the take began, on a rig of six channels a joint it may be nothing at all.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.arrays import frozen, median
from motionedit.core.body.words import bare_names, hangs_on
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

_TRAVEL_SHARE = 0.05  # of the widest way that any joint is moved: less is jitter of a static root
_COLLAPSED = 1e-3  # of its OFFSET: a bone as short as this is gone
_LEG_JOINTS = 3  # branches with so many joints and like each other are limbs: there the body forks
_LIKE = 2  # joints by which two such branches may differ


def travel_joint(motion: Motion) -> int:
    """Return the joint that carries the travel: of those above the body's first fork the shallowest that moves.

    It may sit below a static root. Where none moves, the one nearest to the fork; the root where none of them has
    position channels, unless only joints below have any.
    """
    skeleton = motion.skeleton
    if not len(skeleton.translated):
        return 0
    above = [j for j in _above_the_fork(skeleton) if skeleton.translation_places[j] >= 0]
    if not above:
        return min(map(int, skeleton.translated), key=lambda j: (len(skeleton.chain(j)), j))
    if len(above) == 1:
        return above[0]
    width = np.linalg.norm(np.ptp(motion.translations[:, skeleton.translation_places[above]], axis=0), axis=-1)
    if not width.any():
        return above[-1]
    return above[int(np.argmax(width >= _TRAVEL_SHARE * width.max()))]


class Bones(NamedTuple):
    """A `skeleton` whose offsets are bones; `heaped` where position channels put most joints onto their parents."""

    skeleton: Skeleton
    heaped: bool


def bones_of(motion: Motion, travel: int) -> Skeleton:
    """Return the skeleton of `find_bones`."""
    return find_bones(motion, travel).skeleton


def find_bones(motion: Motion, travel: int) -> Bones:
    """Return the motion's skeleton with the effective offset of every joint in place of its OFFSET, clip units.

    That is the OFFSET itself, or the median over the frames of the joint's translation where position channels replace
    it. Where they replace most of the bones by nothing they are shifts from OFFSET, as some write them. It is nothing
    at the joint that carries the `travel` and at all that do not hang on it. The same skeleton is returned for the same
    bones, so that what is read off it is read once in a batch.
    """
    skeleton, moved = motion.skeleton, _moved(motion.skeleton, travel)
    if not moved:
        return _as_offset(skeleton, travel)
    offsets = skeleton.offsets.copy()
    joints, bones = skeleton.translated[[*moved]], median(motion.translations[:, [*moved]])
    heaped = _are_shifts(offsets[joints], bones)
    if not heaped:
        offsets[joints] = bones
    return Bones(_with_bones(skeleton, travel, offsets), heaped)


@lru_cache(maxsize=8)
def _moved(skeleton: Skeleton, travel: int) -> tuple[int, ...]:
    """Return the places, among `Skeleton.translated`, of joints with position channels that hang on the `travel`'s."""
    carried = below(skeleton, travel)
    return tuple(p for p, j in enumerate(skeleton.translated.tolist()) if carried[j] and j != travel)


@lru_cache(maxsize=8)
def _as_offset(skeleton: Skeleton, travel: int) -> Bones:
    """Return the bones of a skeleton whose OFFSETs no position channel replaces but the `travel`'s."""
    return Bones(_with_bones(skeleton, travel, skeleton.offsets.copy()), heaped=False)


def _with_bones(skeleton: Skeleton, travel: int, offsets: FloatArray) -> Skeleton:
    """Return a skeleton with other offsets (J, 3), nothing where no bone is: one for all clips that have the same."""
    offsets[~below(skeleton, travel)] = 0.0
    offsets[travel] = 0.0
    return skeleton if np.array_equal(offsets, skeleton.offsets) else _with_offsets(skeleton, offsets.tobytes())


def _are_shifts(offsets: FloatArray, places: FloatArray) -> bool:
    """Tell whether most of some joints that have an OFFSET, shape (P, 3), are put to places of nothing."""
    lengths = np.linalg.norm(offsets, axis=1)
    gone = (np.linalg.norm(places, axis=1) <= _COLLAPSED * lengths) & (lengths > 0.0)
    return 2 * int(np.count_nonzero(gone)) > int(np.count_nonzero(lengths))


@lru_cache(maxsize=8)
def below(skeleton: Skeleton, joint: int) -> BoolArray:
    """Return which joints are a joint or hang on it, shape (J,)."""
    there = np.zeros(len(skeleton), dtype=np.bool_)
    there[joint] = True
    for j in range(joint + 1, len(skeleton)):
        there[j] = there[skeleton.parents[j]]
    return frozen(there)


@lru_cache(maxsize=8)
def hanging(skeleton: Skeleton) -> BoolArray:
    """Return which joints only hang on a body, by what they are called, shape (J,): hair, tails, props, helpers.

    So does what hangs on them. What most of the joints hang on is the body, whatever it is called.
    """
    names, counts = bare_names(skeleton.names), _counts_below(skeleton)
    found = np.zeros(len(skeleton), dtype=np.bool_)
    for j, name in enumerate(names):
        inherited = j > 0 and found[skeleton.parents[j]]
        found[j] = inherited or (2 * counts[j] <= len(skeleton) and hangs_on(name))
    return frozen(found)


def _counts_below(skeleton: Skeleton) -> list[int]:
    """Return how many joints are a joint or hang on it."""
    counts = [1] * len(skeleton)
    for j in range(len(skeleton) - 1, 0, -1):
        counts[skeleton.parents[j]] += counts[j]
    return counts


@lru_cache(maxsize=8)
def _above_the_fork(skeleton: Skeleton) -> tuple[int, ...]:
    """Return the joints from the root down to where limbs part, both in; the root alone of a chain.

    Helpers beside the body, such as the targets of a rig's inverse kinematics, are no fork.
    """
    counts, beside = _counts_below(skeleton), hanging(skeleton)
    branches = [[c for c in children if not beside[c]] for children in skeleton.children]
    forks = [False] * len(skeleton)
    for j in range(len(skeleton) - 1, -1, -1):
        forks[j] = _is_fork([counts[c] for c in branches[j]]) or any(forks[c] for c in branches[j])
    path = [0]
    while children := branches[path[-1]]:
        # Where two branches fork, one has the legs and the other the arms.
        if _is_fork([counts[c] for c in children]) or sum(forks[c] for c in children) > 1:
            return tuple(path)
        path.append(max(children, key=lambda c: (forks[c], counts[c], -c)))
    return (0,)


def _is_fork(sizes: Sequence[int]) -> bool:
    """Tell whether two of some branches, with so many joints, are limbs of one pair."""
    limbs = sorted(size for size in sizes if size >= _LEG_JOINTS)
    return any(other - one <= _LIKE for one, other in pairwise(limbs))


@lru_cache(maxsize=8)
def _with_offsets(skeleton: Skeleton, offsets: bytes) -> Skeleton:
    return replace(skeleton, offsets=frozen(np.frombuffer(offsets).reshape(-1, 3)))
