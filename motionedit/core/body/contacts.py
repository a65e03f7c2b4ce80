"""Foot contacts: the frames in which an ankle or a toe is planted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import percentile
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion

# For a leg of `STANDARD_LEG`; a clip's own unit is scaled to it.
_SLOW = 0.35  # m/s
_LOW = 0.06  # m above the low percentile of the point's height
_LOW_PERCENTILE = 2.0
_LONGEST_GAP = 2  # frames
_SHORTEST = 0.1  # s


@dataclass(frozen=True)
class Plant:
    """A point of a foot that stands from frame `start` to frame `stop`, both in; `foot` is ``left`` or ``right``."""

    foot: str
    joint: int
    start: int
    stop: int

    @property
    def frames(self) -> int:
        """How many frames the plant lasts."""
        return self.stop - self.start + 1


def find_plants(motion: Motion, poses: WorldPoses, anatomy: Anatomy, *, up: FloatArray, first: int) -> list[Plant]:
    """Return the plants of ankles and toes, each point by itself, in the order of their first frames.

    A point is planted while it is slower than 0.35 m/s and lower than its 2nd percentile of height + 0.06 m (at a leg
    of 0.85 m); gaps of up to two frames are closed, then what is shorter than 0.1 s is dropped.

    Parameters
    ----------
    up : shape (3,)
        Signed unit axis.
    first : int
        The first frame after a rest pose; earlier ones are never planted.
    """
    tracks = poses.positions[:, [joint for _, joint in anatomy.foot_points]]
    return plants_of(tracks, anatomy, up=up, first=first, frame_time=motion.frame_time)


def plants_of(tracks: FloatArray, anatomy: Anatomy, *, up: FloatArray, first: int, frame_time: float) -> list[Plant]:
    """Return the plants of ankles and toes as `find_plants`; `tracks` (F, P, 3) are those of `anatomy.foot_points`."""
    points = anatomy.foot_points
    if not points or len(tracks) - first < 2:
        return []
    metre = anatomy.leg_length / STANDARD_LEG
    places = tracks[first:]
    speed = np.linalg.norm(np.gradient(places, frame_time, axis=0), axis=-1)
    height = places @ up
    low = percentile(height, _LOW_PERCENTILE) + _LOW * metre
    planted = (speed < _SLOW * metre) & (height < low)
    plants = [
        Plant(side, joint, first + start, first + stop)
        for (side, joint), frames in zip(points, planted.T, strict=True)
        for start, stop in _runs(frames)
        if (stop - start + 1) * frame_time >= _SHORTEST - 1e-9
    ]
    return sorted(plants, key=lambda plant: (plant.start, plant.foot, plant.joint))


def _runs(planted: BoolArray) -> list[tuple[int, int]]:
    """Return (first, last) of the runs of True, shape (F,), gaps of up to `_LONGEST_GAP` frames closed."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], planted.astype(np.int8), [0]))))
    starts, stops = edges[::2], edges[1::2]
    wide = np.flatnonzero(starts[1:] - stops[:-1] > _LONGEST_GAP)
    keep_starts = np.concatenate((starts[:1], starts[1:][wide]))
    keep_stops = np.concatenate((stops[:-1][wide], stops[-1:]))
    return [(int(a), int(b) - 1) for a, b in zip(keep_starts, keep_stops, strict=True)]
