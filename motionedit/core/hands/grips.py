"""Where both hands hold one thing: a club, a bat, a sword, each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import median, runs
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses

# Metres at leg length 0.85 m: wrists of hands on one thing are no further apart. A swing's are 0.08 to 0.21.
_TOGETHER = 0.25
# Metres a second, of the one hand as the other sees it, in the middle of a grip: hands that hold a club turn on it and
# slip, in a captured swing at 0.27; those that meet in passing, and fists on guard, go at 0.5 and more.
_SLIPS = 0.4
_SHORTEST = 0.3  # seconds
# Metres at leg length 0.85 m by which hands that hold one thing come apart where a viewer sees it.
SEEN_APART = 0.03


def find_grips(poses: WorldPoses, anatomy: Anatomy, *, frame_time: float, first: int) -> tuple[tuple[int, int], ...]:
    """Return the intervals of frames (both ends in) in which the hands hold one thing; none without arms.

    Parameters
    ----------
    frame_time : float
        Seconds.
    first : int
        Frames before it are a rest pose.
    """
    if anatomy.arms is None or anatomy.leg_length <= 0.0 or len(poses.positions) - first < 2:
        return ()
    left, right = (arm.wrist for arm in anatomy.arms)
    unit = anatomy.leg_length / STANDARD_LEG
    apart = poses.positions[:, left] - poses.positions[:, right]
    near = rot.length(apart) <= _TOGETHER * unit
    near[:first] = False
    spans = [(start, stop) for start, stop in runs(near) if (stop - start) * frame_time >= _SHORTEST]
    if not spans:
        return ()
    hands = [(poses.positions[:, j], poses.rotations[:, j]) for j in (left, right)]
    speeds = np.maximum(*(_speeds(seen_by(a, b), frame_time) for a, b in (hands, hands[::-1])))
    return tuple((start, stop) for start, stop in spans if median(speeds[start : stop + 1]) <= _SLIPS * unit)


def seen_by(hand: tuple[FloatArray, FloatArray], other: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Return where one hand has the other, shape (F, 3), of positions (F, 3) and rotations (F, 4) in the world."""
    return rot.unrotate(hand[1], other[0] - hand[0])


def _speeds(places: FloatArray, frame_time: float) -> FloatArray:
    """Return how fast a point moves, shape (F,)."""
    return rot.length(np.gradient(places, frame_time, axis=0))
