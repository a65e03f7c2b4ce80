"""Pose coordinates: a motion as rows Theta = [travel position, joint rotation vectors] of eq. (1).

The representative of each rotation vector decides whether a PCA of motions means anything. Rotations are taken
about a reference q_ref per joint, v = log(q_ref^-1 q), unwrapped in time, and each whole track is relabelled to the
database's winding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.rotation_vectors import unwrapped
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.timeline.alignment import Alignment, TravelPath

Representation = Literal["centred", "exponential"]


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
    return unwrapped(rot.log(rot.between(references, q)))


def rotations_of_tracks(v: FloatArray, references: FloatArray) -> FloatArray:
    """Return q = q_ref exp(v), shape (F, K, 4)."""
    return rot.multiply(references, rot.exp(v))


def pose_rows(v: FloatArray, space: PoseSpace, *, path: TravelPath, alignment: Alignment) -> FloatArray:
    """Return the rows Theta, shape (F, n): aligned travel in metres times root_weight, then rotation vectors."""
    travel = alignment.apply(path.positions) * (space.scale * space.root_weight)
    return np.concatenate((travel, v.reshape(len(v), -1)), axis=1)


def split_rows(rows: FloatArray, space: PoseSpace) -> tuple[FloatArray, FloatArray]:
    """Return (travel (F, 3) in clip units of the aligned frame, rotation vectors (F, K, 3)) of rows."""
    travel = rows[:, :3] / (space.scale * space.root_weight)
    return travel, rows[:, 3:].reshape(len(rows), -1, 3)
