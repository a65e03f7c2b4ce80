"""Where both hands hold one thing: a club, a bat, a sword, each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import median, runs
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses

# Metres at leg length 0.85 m: wrists of hands on one thing are no further apart. A swing's are 0.08 to 0.21.
_TOGETHER = 0.25
# Metres a second, of the one hand as the other sees it, in the middle of a grip: hands that hold a club turn on it and
# slip, in a captured swing at 0.27; those that meet in passing, and fists on guard, go at 0.5 and more.
_SLIPS = 0.4
_SHORTEST = 0.3  # seconds
# Of how far hands go as the chest sees them, the part by which the one goes as the other sees it. What both hold takes
# both along: in a captured swing it is 0.34, of fists on guard, near one another but each by itself, 2.5.
_OWN_WAY = 0.5
_RESTS = 0.01  # metres at leg length 0.85 m: hands that go no further by themselves hold a thing that is at rest
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
    if anatomy.arms is None or anatomy.chest is None or anatomy.leg_length <= 0.0 or len(poses.positions) - first < 2:
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
    seen = [seen_by(a, b) / unit for a, b in (hands, hands[::-1])]
    chest = poses.positions[:, anatomy.chest], poses.rotations[:, anatomy.chest]
    middle = seen_by(chest, ((hands[0][0] + hands[1][0]) / 2.0, chest[1])) / unit
    return tuple(span for span in spans if _go_together(seen, middle, slice(span[0], span[1] + 1), frame_time))


def _go_together(seen: Sequence[FloatArray], middle: FloatArray, span: slice, frame_time: float) -> bool:
    """Return whether hands slip slowly, and go less by themselves than together, in metres at leg length 0.85 m."""
    speeds = np.maximum(*(_speeds(places, frame_time)[span] for places in seen))
    own = max(_spread(places[span]) for places in seen)
    return bool(median(speeds) <= _SLIPS and own <= max(_RESTS, _OWN_WAY * _spread(middle[span])))


def seen_by(hand: tuple[FloatArray, FloatArray], other: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Return where one hand has the other, shape (F, 3), of positions (F, 3) and rotations (F, 4) in the world."""
    return rot.unrotate(hand[1], other[0] - hand[0])


def _spread(places: FloatArray) -> float:
    """Return the root mean square distance of places, shape (F, 3), from their mean."""
    return float(np.sqrt(np.square(places - places.mean(axis=0)).sum(axis=1).mean()))


def _speeds(places: FloatArray, frame_time: float) -> FloatArray:
    """Return how fast a point moves, shape (F,)."""
    return rot.length(np.gradient(places, frame_time, axis=0))
