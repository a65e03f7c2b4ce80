"""The way to what the compiled part reads off the joints of a whole motion, each in one loop over its frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses

Work = Literal["directions", "cones", "bent_back", "carried", "center"]


def read_off(
    what: Work,
    positions: FloatArray | None,
    rotations: FloatArray,
    joints: IntArray,
    *arrays: FloatArray,
    shape: Sequence[int],
    first: int = 0,
) -> FloatArray | None:
    """Return what the compiled part reads off a motion, of a `shape`; None where numpy is to do it.

    Parameters
    ----------
    positions, rotations : shape (F, J, 3), (F, J, 4)
        In the world, or wherever they are wanted.
    joints : shape (n, ...)
        Of which joints.
    arrays
        What else is given, n rows each.
    """
    kernel = compiled()
    if kernel is None:
        return None
    frames, count = rotations.shape[:2]
    out = np.empty(shape)
    places = None if positions is None else np.ascontiguousarray(positions, np.float64)
    given = tuple(np.ascontiguousarray(each, np.float64) for each in arrays)
    turns, which = np.ascontiguousarray(rotations, np.float64), np.ascontiguousarray(joints, np.int64)
    getattr(kernel, what)(places, turns, frames, count, first, which, len(which), given, out)
    return out


def carried(poses: WorldPoses, joints: IntArray, points: FloatArray) -> FloatArray:
    """Return where n points, (n, 3) in the frames of n joints, are in the world at each frame, shape (F, n, 3)."""
    shape = (len(poses.positions), len(joints), 3)
    found = read_off("carried", poses.positions, poses.rotations, joints, points, shape=shape)
    if found is None:
        return poses.positions[:, joints] + rot.rotate(poses.rotations[:, joints], points)
    return found
