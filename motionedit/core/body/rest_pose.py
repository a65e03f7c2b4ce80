"""The frames of a rest pose, such as a T-pose, in front of a take."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen, percentile

if TYPE_CHECKING:
    from motionedit.core.arrays import IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.motion import Motion

_STEP = 0.6  # rad between two frames, at the least
_COSINE = float(np.cos(0.5 * _STEP)) + 1e-6  # of half the step; more by far than rounding
_LONGEST = 3  # frames
# A jump is an outlier: so many times the joint's step right after it, and its own steps over the clip but the fastest.
_ABOVE_NEXT = 3.0
_ABOVE_USUAL = 2.0
_USUAL = 95.0  # percentile
_SAMPLES = 512  # steps of the clip that are looked at


def rest_pose_frames(motion: Motion, anatomy: Anatomy) -> int:
    """Return how many frames in front of the take (0 to 3) are a rest pose, such as a T-pose.

    A true (geodesic) rotation step above 0.6 rad within the first frames ends it, at a joint that is no wrist, hand,
    finger or toe, and that never steps so otherwise: a fast arm at a low frame rate goes on as fast.
    A clip of two frames has none: either could be the take.
    """
    count = len(motion)
    joints = _seen(anatomy, len(motion.skeleton))
    q = motion.rotations[: _LONGEST + 2, joints]
    # A cosine of half the step costs less than the step, and nearly all clips are let off by it.
    if len(q) < 2 or rot.half_cosines(q[:-1], q[1:]).min(initial=1.0) > _COSINE:
        return 0
    steps = rot.angle_between(q[:-1], q[1:])
    jumps = np.argwhere(steps[:_LONGEST] > _STEP)
    if not len(jumps) or count < 3:
        return 0
    at = np.unique(np.linspace(_LONGEST, count - 2, _SAMPLES).astype(np.intp)) if count > _LONGEST + 1 else None
    found = 0
    for frame, place in jumps.tolist():
        jump = steps[frame, place]
        after = steps[frame + 1, place] if frame + 1 < len(steps) else 0.0
        usual = 0.0
        if at is not None:
            turns = motion.rotations[:, joints[place]]
            usual = float(percentile(rot.angle_between(turns[at], turns[at + 1]), _USUAL))
        if jump > _ABOVE_NEXT * after and jump > _ABOVE_USUAL * usual:
            found = max(found, frame + 1)
    return found


@lru_cache(maxsize=4)
def _seen(anatomy: Anatomy, joints: int) -> IntArray:
    """Return which of so many joints make a rest pose, shape (n,)."""
    return frozen(np.array([j for j in range(joints) if j not in anatomy.digits], dtype=np.intp))
