"""Forward kinematics over all frames at once, and the Jacobians of an effector's position and orientation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion


@dataclass(frozen=True, eq=False)
class Effector:
    """A point fixed in a joint's frame: `offset`, shape (3,), in clip units; zero is the joint itself."""

    joint: int
    offset: FloatArray


@dataclass(frozen=True, eq=False)
class WorldPoses:
    """World transforms of every joint: `positions` (F, J, 3) in clip units, `rotations` (F, J, 4) quaternions."""

    positions: FloatArray
    rotations: FloatArray


def local_translations(motion: Motion) -> FloatArray:
    """Return the translation of every joint in its parent's frame, shape (F, J, 3)."""
    skeleton = motion.skeleton
    local = np.repeat(skeleton.offsets[None], len(motion), axis=0)
    local[:, skeleton.translated] = motion.translations
    return local


def forward(motion: Motion) -> WorldPoses:
    """Return the world transforms of all joints at all frames.

    p_j = p_parent + R_parent t_j and R_j = R_parent R_local, level by level from the root.
    """
    skeleton = motion.skeleton
    positions = local_translations(motion)
    rotations = motion.rotations.copy()
    for level in skeleton.levels[1:]:
        parents = skeleton.parents[level]
        q_parent = rotations[:, parents]
        positions[:, level] = positions[:, parents] + rot.rotate(q_parent, positions[:, level])
        rotations[:, level] = rot.multiply(q_parent, rotations[:, level])
    return WorldPoses(positions, rotations)


def forward_of(motion: Motion, joint: int) -> tuple[FloatArray, FloatArray]:
    """Return world positions (F, 3) and rotations (F, 4) of one joint, walking its own chain alone."""
    skeleton = motion.skeleton
    place = {int(j): p for p, j in enumerate(skeleton.translated)}
    positions = np.zeros((len(motion), 3))
    rotations = np.broadcast_to(rot.IDENTITY, (len(motion), 4))
    for j in skeleton.chain(joint):
        local = motion.translations[:, place[int(j)]] if int(j) in place else skeleton.offsets[j]
        positions = positions + rot.rotate(rotations, local)
        rotations = rot.multiply(rotations, motion.rotations[:, j])
    return positions, rotations


def effector_positions(poses: WorldPoses, effector: Effector) -> FloatArray:
    """Return the world positions of an effector, shape (F, 3)."""
    j = effector.joint
    return poses.positions[:, j] + rot.rotate(poses.rotations[:, j], effector.offset)


def position_jacobian(poses: WorldPoses, effector: Effector, *, joints: IntArray) -> FloatArray:
    """Return d(effector position)/d(w) for world-axis increments w of the given ancestors, shape (F, 3, 3 K).

    The joint's rotation becomes exp(w) R in the world, so column a of joint j is e_a x (p_e - p_j), in clip units
    per radian. A joint that is not on the way from the root to the effector has no business here: its columns
    would not be zero.
    """
    levers = effector_positions(poses, effector)[:, None] - poses.positions[:, joints]
    blocks = -rot.skew(levers)
    return np.swapaxes(blocks, 1, 2).reshape(len(levers), 3, 3 * len(joints))


def orientation_jacobian(frames: int, *, joints: IntArray) -> FloatArray:
    """Return d(effector orientation)/d(w), the identity for every ancestor, shape (F, 3, 3 K)."""
    return np.broadcast_to(np.tile(np.eye(3), len(joints)), (frames, 3, 3 * len(joints)))
