"""Limbs as capsules, and how far apart they stay: whether an edit pushes an arm through the chest."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy

# Radii in leg lengths: of a lean body, half way along each limb. Hands and feet are left out: they may touch.
_UPPER_ARM, _FOREARM, _THIGH, _SHIN, _TRUNK = 0.048, 0.036, 0.075, 0.050, 0.11


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` (clip units) of the segment between the joints `start` and `end`."""

    start: int
    end: int
    radius: float


def limb_pairs(anatomy: Anatomy) -> list[tuple[Capsule, Capsule]]:
    """Return the pairs of limbs that must not pass through each other.

    Forearm and upper arm against the other arm's, forearms against the trunk, thighs and shins against the other
    leg's, forearms against thighs. Neighbours at a joint are no pair. Empty where no human limbs were found.
    """
    size = anatomy.leg_length
    arms = [
        (Capsule(arm.shoulder, arm.elbow, _UPPER_ARM * size), Capsule(arm.elbow, arm.wrist, _FOREARM * size))
        for arm in anatomy.arms or ()
    ]
    legs = [
        (Capsule(leg.thigh, leg.knee, _THIGH * size), Capsule(leg.knee, leg.ankle, _SHIN * size))
        for leg in anatomy.legs or ()
    ]
    pairs = [pair for limbs in (arms, legs) if len(limbs) == 2 for pair in product(limbs[0], limbs[1])]
    forearms = [arm[1] for arm in arms]
    if anatomy.pelvis is not None and anatomy.chest is not None:
        trunk = Capsule(anatomy.pelvis, anatomy.chest, _TRUNK * size)
        pairs += [(forearm, trunk) for forearm in forearms]
    return pairs + [(forearm, leg[0]) for forearm in forearms for leg in legs]


def clearances(positions: FloatArray, pairs: Sequence[tuple[Capsule, Capsule]]) -> FloatArray:
    """Return the room between the capsules of each pair, shape (F, len(pairs)), clip units; negative: they overlap.

    `positions` has shape (F, J, 3).
    """
    gaps = [
        segment_distance(*(positions[:, joint] for joint in (a.start, a.end, b.start, b.end))) - a.radius - b.radius
        for a, b in pairs
    ]
    return np.stack(gaps, axis=-1) if gaps else np.zeros((len(positions), 0))


def segment_distance(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Return the distance between the segments ab and cd, shape (...), of ends of shape (..., 3).

    It is that of the lines where these meet inside both segments, else that of an end from the other segment. A
    segment may be a point, and segments may be parallel.
    """
    ends = [_point_distance(p, q, r) for p, q, r in ((a, c, d), (b, c, d), (c, a, b), (d, a, b))]
    nearest = np.min(ends, axis=0)
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = (np.sum(x * y, axis=-1) for x, y in ((u, u), (u, v), (v, v)))
    uw, vw = np.sum(u * w, axis=-1), np.sum(v * w, axis=-1)
    determinant = uu * vv - uv * uv
    # Parallel lines, and points: their ends have said all.
    crossed = determinant > 1e-12 * uu * vv
    safe = np.where(crossed, determinant, 1.0)
    s, t = (uv * vw - vv * uw) / safe, (uu * vw - uv * uw) / safe
    inside = crossed & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    between = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    distance: FloatArray = np.where(inside, np.minimum(between, nearest), nearest)
    return distance


def _point_distance(p: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the distance of points p from the segments ab."""
    u = b - a
    square = np.sum(u * u, axis=-1)
    share = np.clip(np.sum((p - a) * u, axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    distance: FloatArray = np.linalg.norm(p - a - share[..., None] * u, axis=-1)
    return distance
