"""Forward kinematics over all frames at once."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.compiled import compiled
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Effector:
    """A point fixed in a joint's frame: `offset`, shape (3,), in the motion's unit; zero is the joint itself."""

    joint: int
    offset: FloatArray

    @cached_property
    def is_off(self) -> bool:
        """Whether it is another point than the joint itself."""
        return bool(self.offset.any())


@dataclass(frozen=True, eq=False)
class WorldPoses:
    """World transforms of all joints: `positions` (F, J, 3) in the motion's unit, `rotations` (F, J, 4) quaternions."""

    positions: FloatArray
    rotations: FloatArray

    def at(self, frames: slice | IntArray | BoolArray) -> WorldPoses:
        """Return the transforms at some frames."""
        return WorldPoses(self.positions[frames], self.rotations[frames])


def forward(motion: Motion) -> WorldPoses:
    """Return the world transforms of all joints at all frames.

    p_j = p_parent + R_parent t_j and R_j = R_parent R_local. Only the products of rotations go level by level from the
    root; the offsets are turned all at once, then added up along the levels.
    """
    frames, joints = motion.rotations.shape[:2]
    positions, rotations = np.empty((frames, joints, 3)), np.empty((frames, joints, 4))
    kernel = compiled()
    if kernel is not None:
        skeleton = motion.skeleton
        numbers = [np.ascontiguousarray(a) for a in (skeleton.offsets, motion.rotations, motion.translations)]
        kernel.forward(skeleton.parents, skeleton.translation_places, *numbers, positions, rotations, frames)
        return WorldPoses(positions, rotations)
    # Blocks of frames stay in the processor's cache.
    step = max(_BLOCK_POSES // joints, 1)
    for start in range(0, frames, step):
        _forward_block(motion, slice(start, start + step), positions, rotations)
    return WorldPoses(positions, rotations)


# The product p q of quaternions is sum_a p_a S[a] q[I[a]]: these are I and S.
_TERMS = np.array([[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]])
_SIGNS = np.array([[1, 1, 1, 1], [-1, 1, -1, 1], [-1, 1, 1, -1], [-1, -1, 1, 1]], dtype=np.float64)
_BLOCK_POSES = 1 << 13


def _forward_block(motion: Motion, block: slice, positions: FloatArray, rotations: FloatArray) -> None:
    """Write the world transforms of a block of frames; inside, arrays are laid out (part, joint, frame)."""
    skeleton = motion.skeleton
    walk = skeleton.level_order
    q = np.take(motion.rotations[block].transpose(2, 1, 0), walk.joints, axis=1)
    terms = q[_TERMS] * _SIGNS[:, :, None, None]
    p = np.empty((3, *q.shape[1:]))
    p[:] = skeleton.offsets[walk.joints].T[:, :, None]
    moved = np.flatnonzero(skeleton.translation_places[walk.joints] >= 0)
    p[:, moved] = motion.translations[block, skeleton.translation_places[walk.joints[moved]]].transpose(2, 1, 0)
    for start, stop in walk.levels:
        parents = q[:, walk.parents[start:stop]]
        np.einsum("akf,ackf->ckf", parents, terms[:, :, start:stop], out=q[:, start:stop])
    p[:, 1:] = _turned(q[:, walk.parents[1:]], p[:, 1:])
    for start, stop in walk.levels:
        p[:, start:stop] += p[:, walk.parents[start:stop]]
    positions[block, walk.joints] = p.transpose(2, 1, 0)
    rotations[block, walk.joints] = q.transpose(2, 1, 0)


def _turned(q: FloatArray, v: FloatArray) -> FloatArray:
    """Return vectors (3, ...) turned by quaternions (4, ...)."""
    w, x, y, z = q
    tx, ty, tz = 2.0 * (y * v[2] - z * v[1]), 2.0 * (z * v[0] - x * v[2]), 2.0 * (x * v[1] - y * v[0])
    turned: FloatArray = v + w * np.stack((tx, ty, tz))
    turned += np.stack((y * tz - z * ty, z * tx - x * tz, x * ty - y * tx))
    return turned


def forward_of(motion: Motion, joint: int) -> tuple[FloatArray, FloatArray]:
    """Return world positions (F, 3) and rotations (F, 4) of one joint, walking its own chain alone."""
    skeleton = motion.skeleton
    places = skeleton.translation_places.tolist()
    positions, rotations = np.zeros((len(motion), 3)), motion.rotations[:, 0]
    for j in skeleton.chain(joint).tolist():
        local = motion.translations[:, places[j]] if places[j] >= 0 else skeleton.offsets[j]
        if j == 0:
            positions = positions + local
            continue
        positions = positions + rot.rotate(rotations, local)
        rotations = rot.multiply(rotations, motion.rotations[:, j])
    return positions, rotations


def shifted(motion: Motion, shift: FloatArray, travel: int, *, poses: WorldPoses | None = None) -> Motion:
    """Return a motion whose `travel`, a joint with position channels, is shifted in the world, shape (F, 3).

    Its `poses` may be known.
    """
    skeleton, parent = motion.skeleton, int(motion.skeleton.parents[travel])
    local = shift if parent < 0 else rot.unrotate((poses or forward(motion)).rotations[:, parent], shift)
    translations = motion.translations.copy()
    translations[:, skeleton.translation_places[travel]] += local
    return Motion(skeleton, motion.rotations, frozen(translations), motion.frame_time)


def effector_positions(poses: WorldPoses, effector: Effector) -> FloatArray:
    """Return the world positions of an effector, shape (F, 3)."""
    j = effector.joint
    if not effector.is_off:
        return poses.positions[:, j].copy()
    return poses.positions[:, j] + rot.rotate(poses.rotations[:, j], effector.offset)
