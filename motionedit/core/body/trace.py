"""What metrics need of a motion, taken block by block."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.body.center_of_mass import center_of_mass
from motionedit.core.body.quality import JerkMeter
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.kinematics import WorldPoses


@dataclass(frozen=True, eq=False)
class Trace:
    """What is kept of a motion's F frames.

    Attributes
    ----------
    tracks : shape (F, P, 3), clip units
        World positions of the points that were asked for.
    center : shape (F, 3), clip units, or None
        The path of the center of mass, where masses were given.
    jerk_rms : float
        As `quality.jerk_rms` of all joints.
    jerk_at : (int, int)
        The joint and the frame with the largest.
    """

    tracks: FloatArray
    center: FloatArray | None
    jerk_rms: float
    jerk_at: tuple[int, int]


def trace_of(
    blocks: Iterable[WorldPoses],
    tracked: Callable[[WorldPoses], FloatArray],
    *,
    frame_time: float,
    first: int,
    masses: Masses | None = None,
) -> Trace:
    """Return the trace of a motion whose world transforms come in blocks of frames, in order.

    Parameters
    ----------
    tracked : callable
        Returns the tracks of a block that are kept, shape (F, P, 3).
    first : int
        The first frame after a rest pose; earlier ones have no jerk.
    """
    tracks, centers, jerk = [], [], JerkMeter(first)
    for poses in blocks:
        tracks.append(tracked(poses))
        if masses is not None:
            centers.append(center_of_mass(poses, masses))
        jerk.add(poses.positions)
    center = frozen(np.concatenate(centers)) if centers else None
    return Trace(frozen(np.concatenate(tracks)), center, jerk.rms(frame_time=frame_time), jerk.worst)
