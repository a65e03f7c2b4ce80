"""What constraints look at in a motion: the joints that they name, and the center of mass; not the whole body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.center_of_mass import Masses, center_of_mass
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion
from motionedit.core.trace import frame_blocks
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.priorities.constraints import Constraint


@dataclass(frozen=True, eq=False)
class Sight:
    """World transforms of the joints that were asked for, zeros elsewhere, and the center of mass, shape (F, 3)."""

    poses: WorldPoses
    center: FloatArray


def sight_of(motion: Motion, joints: IntArray, masses: Masses) -> Sight:
    """Return what is seen of a motion, block by block: a long motion's whole transforms are twice its file."""
    frames, count = len(motion), len(motion.skeleton)
    # Joint by joint: what is never written takes no memory.
    positions = np.zeros((count, frames, 3)).transpose(1, 0, 2)
    rotations = np.zeros((count, frames, 4)).transpose(1, 0, 2)
    center = np.empty((frames, 3))
    for block in frame_blocks(frames):
        part = Motion(motion.skeleton, motion.rotations[block], motion.translations[block], motion.frame_time)
        poses = forward(part)
        positions[block, joints] = poses.positions[:, joints]
        rotations[block, joints] = poses.rotations[:, joints]
        center[block] = center_of_mass(poses, masses)
    return Sight(WorldPoses(positions, rotations), center)


def joints_named(constraints: Iterable[Constraint]) -> IntArray:
    """Return the joints whose transforms constraints ask for, growing."""
    named: set[int] = set()
    for constraint in constraints:
        named.update(constraint.support)
        named.update(j for j in (constraint.base, constraint.target) if j is not None)
        if constraint.kind not in {"com", "posture"}:
            named.add(constraint.effector.joint)
    return np.array(sorted(named), dtype=np.intp)
