"""Pose coordinates: a motion as rows Theta = [travel position, joint rotation vectors] of eq. (1).

The representative of each rotation vector decides whether a PCA of motions means anything. Rotations are taken
about a reference q_ref per joint, v = log(q_ref^-1 q), unwrapped in time, and each whole track is relabelled to the
database's winding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.timeline.alignment import Alignment, TravelPath

Representation = Literal["centred", "exponential"]

TURN = 2.0 * np.pi

# Below this length (rad) a rotation vector has no direction to add a turn along.
_NO_DIRECTION = 1e-9


@dataclass(frozen=True, eq=False)
class PoseSpace:
    """What the n columns of Theta mean.

    Attributes
    ----------
    joints : shape (K,)
        The skeleton's joints whose rotations are columns, the travel-carrying joint first; n = 3 + 3 K.
    references : shape (K, 4)
        q_ref of each.
    scale : float
        Metres (at leg length 0.85 m) per clip unit.
    root_weight : float
        Factor on the three columns of the travel.
    """

    joints: IntArray
    references: FloatArray
    scale: float
    root_weight: float

    @property
    def size(self) -> int:
        """Number of columns, n."""
        return 3 + 3 * len(self.joints)


def space_joints(motion: Motion, *, travel: int, excluded: frozenset[int]) -> IntArray:
    """Return the joints that PCA sees: the travel-carrying one first, then all that can turn freely below or beside it.

    Left out: what the user excludes, what stands above the travel, and joints with no or two rotation channels,
    whose turns a displacement could not keep within their channels.
    """
    skeleton = motion.skeleton
    above = {int(j) for j in skeleton.chain(travel)}
    free = [
        j
        for j, axes in enumerate(skeleton.rotation_axes)
        if len(axes) in {1, 3} and j not in above and j not in excluded
    ]
    return np.array([travel, *free], dtype=np.intp)


def rotations_in_space(motion: Motion, joints: IntArray, *, path: TravelPath, alignment: Alignment) -> FloatArray:
    """Return the quaternions behind the columns, shape (F, K, 4): the travel's in the aligned world, others local."""
    q = motion.rotations[:, joints].copy()
    q[:, 0] = rot.multiply(alignment.rotation, path.rotations)
    return q


def rotation_tracks(q: FloatArray, references: FloatArray) -> FloatArray:
    """Return v = log(q_ref^-1 q), unwrapped over frames, shape (F, K, 3)."""
    return unwrapped(rot.log(rot.multiply(rot.conjugate(references), q)))


def rotations_of_tracks(v: FloatArray, references: FloatArray) -> FloatArray:
    """Return q = q_ref exp(v), shape (F, K, 4)."""
    return rot.multiply(references, rot.exp(v))


def unwrapped(v: FloatArray) -> FloatArray:
    """Return rotation vectors v (1 + 2 pi k / |v|) with k such that each is nearest the one before, (F, K, 3)."""
    v = v.copy()
    step = _length(np.diff(v, axis=0))
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
    k = np.round((float(v @ target) / length - length) / TURN)
    near: FloatArray = v * (1.0 + TURN * k / length)
    return near


def relabelled(v: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return tracks moved as wholes by k in {-1, 0, 1} turns to lie nearest the target tracks, and k of shape (K,).

    Parameters
    ----------
    v, target : shape (F, K, 3)
    """
    k = np.zeros(v.shape[1])
    # A turn leads 2 pi away: no track that keeps within half of that of its target comes nearer by one.
    far = np.flatnonzero((_length(v - target) > np.pi).any(axis=0))
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


def _turned(v: FloatArray, length: FloatArray, k: float) -> FloatArray:
    safe = np.where(length < _NO_DIRECTION, 1.0, length)
    turned: FloatArray = v * (1.0 + TURN * k / safe)[..., None]
    return turned


def pose_rows(v: FloatArray, space: PoseSpace, *, path: TravelPath, alignment: Alignment) -> FloatArray:
    """Return the rows Theta, shape (F, n): aligned travel in metres times root_weight, then rotation vectors."""
    travel = alignment.apply(path.positions) * (space.scale * space.root_weight)
    return np.concatenate((travel, v.reshape(len(v), -1)), axis=1)


def split_rows(rows: FloatArray, space: PoseSpace) -> tuple[FloatArray, FloatArray]:
    """Return (travel (F, 3) in clip units of the aligned frame, rotation vectors (F, K, 3)) of rows."""
    travel = rows[:, :3] / (space.scale * space.root_weight)
    return travel, rows[:, 3:].reshape(len(rows), -1, 3)
