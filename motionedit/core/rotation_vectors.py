"""Which of its representatives, whole turns apart, a rotation vector takes: nearest the frame before, or a track.

Shapes are (F, K, 3): F frames of K joints; angles in radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Below this length (rad) a rotation vector has no direction to add a turn along.
_NO_DIRECTION = 1e-9


def unwrapped(v: FloatArray) -> FloatArray:
    """Return rotation vectors v (1 + 2 pi k / |v|) with k such that each is nearest the one before, (F, K, 3)."""
    v = v.copy()
    step = rot.length(v[1:] - v[:-1])
    # The other representative of v is a whole turn from it, so it is nearer the one before only after half a turn.
    joints = np.flatnonzero((step > np.pi).any(axis=0))
    length = _length(v[1:, joints])
    other = _length(_turned(v[1:, joints], length, -1.0) - v[:-1, joints])
    for joint in joints[(other < step[:, joints]).any(axis=0)]:
        track = v[:, joint]
        for f in range(1, len(track)):
            track[f] = _nearest(track[f], track[f - 1])
    return v


def _length(v: FloatArray) -> FloatArray:
    length: FloatArray = np.sqrt(np.einsum("...i,...i->...", v, v))
    return length


def _nearest(v: FloatArray, target: FloatArray) -> FloatArray:
    length = float(np.linalg.norm(v))
    if length < _NO_DIRECTION:
        return v
    # |v (1 + 2 pi k/|v|) - target| is least at the k nearest this projection.
    k = np.round((float(v @ target) / length - length) / rot.TURN)
    near: FloatArray = v * (1.0 + rot.TURN * k / length)
    return near


def relabelled(v: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return tracks moved as wholes by k in {-1, 0, 1} turns to lie nearest the target tracks, and k of shape (K,).

    Parameters
    ----------
    v, target : shape (F, K, 3)
    """
    k = np.zeros(v.shape[1])
    # A turn leads 2 pi away: no track that keeps within half of that of its target comes nearer by one.
    far = np.flatnonzero((rot.length(v - target) > np.pi).any(axis=0))
    if not len(far):
        return v.copy(), k
    v, track = v.copy(), v[:, far]
    length = _length(track)
    choices = np.stack([_turned(track, length, turns) for turns in (0.0, -1.0, 1.0)])
    distance = np.sum((choices - target[:, far]) ** 2, axis=(1, 3))
    # A track through zero has no direction to be turned along there.
    distance[1:, length.min(axis=0) < _NO_DIRECTION] = np.inf
    best = np.argmin(distance, axis=0)
    v[:, far] = np.swapaxes(np.moveaxis(choices, 2, 1)[best, np.arange(len(far))], 0, 1)
    k[far] = np.array([0.0, -1.0, 1.0])[best]
    return v, k


def least_turned(v: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the rotations of a track, (F, 3), by vectors that follow each other, the longest by its weight the least.

    Of the ways round, whole turns apart, one is right for all frames.
    """
    heaviest = int(np.argmax(weights))
    down, up = unwrapped(v[heaviest::-1, None])[::-1, 0], unwrapped(v[heaviest:, None])[:, 0]
    track = np.concatenate((down[:-1], up))
    ways = [track, *(_turned(track, _length(track), turns) for turns in (-1.0, 1.0))]
    return min(ways, key=lambda way: float((weights * _length(way)).max()))


def _turned(v: FloatArray, length: FloatArray, k: float) -> FloatArray:
    safe = np.where(length < _NO_DIRECTION, 1.0, length)
    turned: FloatArray = v * (1.0 + rot.TURN * k / safe)[..., None]
    return turned
