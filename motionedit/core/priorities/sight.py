"""What constraints look at in a motion: the joints that they name, and the center of mass; not the whole body."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.blocks import BLOCK_FRAMES, frame_blocks
from motionedit.core.body.center_of_mass import Masses, center_of_mass
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion


@dataclass(frozen=True, eq=False)
class Sight:
    """A motion; world transforms of at least the joints, and the CoM, shape (F, 3), that were asked for."""

    motion: Motion
    poses: WorldPoses
    center: FloatArray


def sight_of(
    motion: Motion, joints: Callable[[], Collection[int]], masses: Masses | None, *, poses: WorldPoses | None = None
) -> Sight:
    """Return what is seen of a motion, block by block: a long motion's whole transforms are twice its file.

    Parameters
    ----------
    joints : callable
        Returns the joints; of a short motion all are seen.
    masses : Masses or None
        None where nobody asks for the center of mass.
    poses : WorldPoses, optional
        Of the motion, where they are known.
    """
    if poses is not None:
        return _sight(motion, poses, masses)
    if len(motion) <= BLOCK_FRAMES:
        return _seen_again(motion, masses) if motion.is_fixed else _seen_whole(motion, masses)
    frames, count = len(motion), len(motion.skeleton)
    seen = np.array(sorted(joints()), dtype=np.intp)
    # Joint by joint: what is never written takes no memory.
    positions = np.zeros((count, frames, 3)).transpose(1, 0, 2)
    rotations = np.zeros((count, frames, 4)).transpose(1, 0, 2)
    center = np.zeros((frames, 3))
    for block in frame_blocks(frames):
        part = motion.at(block)
        poses = forward(part)
        positions[block, seen] = poses.positions[:, seen]
        rotations[block, seen] = poses.rotations[:, seen]
        if masses is not None:
            center[block] = center_of_mass(poses, masses)
    return Sight(motion, WorldPoses(positions, rotations), center)


def _seen_whole(motion: Motion, masses: Masses | None) -> Sight:
    """Return what is seen of a short motion, with all its joints: to pick some would take longer."""
    return _sight(motion, poses_again(motion) if motion.is_fixed else forward(motion), masses)


def _sight(motion: Motion, poses: WorldPoses, masses: Masses | None) -> Sight:
    return Sight(motion, poses, np.zeros((len(motion), 3)) if masses is None else center_of_mass(poses, masses))


# The input of an edit, a short one that is fixed, is looked at again and again.
_seen_again = lru_cache(maxsize=2)(_seen_whole)
poses_again = lru_cache(maxsize=2)(forward)
