"""How well feet stand, measured as others do, at a leg of 0.85 m: skate, sliding in plants, and what is too deep.

The floor is the plane up = 0 of the file.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.plant_frames import frames_of, spans_of
from motionedit.core.compiled import compiled
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant
    from motionedit.core.body.plant_frames import PlantFrames

_NEAR_FLOOR = 0.05  # m: a toe below it should not move (Kimodo)
_SKATES = 0.2  # m/s: a toe near the floor that is faster skates (Kimodo)
_SLIDES = 0.01  # m/s: a planted toe that is faster slides (HoloSoma)
_UNDER = 0.01  # m: deeper is under the floor


@dataclass(frozen=True)
class FootMeasures:
    """What is measured of a motion's feet, in metres at a leg of 0.85 m.

    Attributes
    ----------
    skate_mean : float
        Mean speed on the ground plane of toes below 5 cm, m/s; 0 where none is.
    skate_ratio : float
        Share of such frames in which the toe is faster than 0.2 m/s.
    sliding_share : float
        Share of planted frames in which the point moves on the ground plane by more than 1 cm/s.
    penetration_share : float
        Share of frames in which a heel or toe is below the floor by more than 1 cm.
    penetration_max : float
        How deep the deepest heel or toe is below the floor, m.
    drift_max : float
        How far a planted point is from its mean place at most, m.
    floating_max : float
        How high above the floor the highest plant of a toe stands, m.
    """

    skate_mean: float
    skate_ratio: float
    sliding_share: float
    penetration_share: float
    penetration_max: float
    drift_max: float
    floating_max: float


def foot_measures(
    tracks: FloatArray, plants: Sequence[Plant], anatomy: Anatomy, *, up: FloatArray, first: int, frame_time: float
) -> FootMeasures:
    """Return the measures of feet whose `sole_points` go along tracks, shape (F, P, 3), clip units.

    Parameters
    ----------
    plants
        When they stand; for an edit those of its input. Toes are counted in shares, heels where a foot has no toe.
    first : int
        The first frame after a rest pose; earlier ones are left out.
    """
    points = anatomy.sole_points
    if not points or anatomy.leg_length <= 0.0 or len(tracks) - first < 2:
        return FootMeasures(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    toes, scale, kernel = _toes(anatomy), STANDARD_LEG / anatomy.leg_length, compiled()
    if kernel is not None:
        spans, rules = spans_of(plants), (scale, frame_time, _NEAR_FLOOR, _SKATES, _SLIDES, _UNDER)
        sizes = *tracks.shape[:2], len(spans)
        return FootMeasures(*kernel.foot_figures(np.ascontiguousarray(tracks), up, spans, *sizes, toes, first, rules))
    places, down = tracks * scale, frames_of(plants)
    return _measured(places, down, np.flatnonzero(toes), up=up, first=first, frame_time=frame_time)


@lru_cache(maxsize=8)
def _toes(anatomy: Anatomy) -> BoolArray:
    """Return which sole points count as toes, shape (P,): heels where no foot has one."""
    toes = [point.part == "toe" for point in anatomy.sole_points]
    return frozen(np.array(toes if any(toes) else [True] * len(toes)))


def _measured(
    places: FloatArray, down: PlantFrames | None, toes: IntArray, *, up: FloatArray, first: int, frame_time: float
) -> FootMeasures:
    """Return the measures of feet along `places` (F, P, 3), metres; which of the points are `toes`."""
    heights = places @ up
    level = places - heights[..., None] * up
    speeds = rot.length(np.diff(level, axis=0)) / frame_time
    near = (heights[first:-1, toes] < _NEAR_FLOOR) & (heights[first + 1 :, toes] < _NEAR_FLOOR)
    skating = speeds[first:, toes][near]
    sliding, drift, highest = np.zeros(0), 0.0, 0.0
    if down is not None:
        at = down.of(places)
        # From where each plant begins: what stands still is not off by the rounding of its place.
        ways = at - down.spread(at[down.starts])
        drift = float(rot.length(ways - down.spread(down.means(ways))).max())
        of_toes = np.isin(down.points[down.starts], toes)
        highest = float(down.means(down.of(heights))[of_toes].max(initial=0.0))
        # From each frame of a plant to the next: not from its last.
        steps = down.spread(of_toes)
        steps[down.starts + down.counts - 1] = False
        sliding = speeds[down.frames[steps], down.points[steps]] > _SLIDES
    depth = -heights[first:].min(axis=1)
    return FootMeasures(
        skate_mean=float(skating.mean()) if len(skating) else 0.0,
        skate_ratio=float((skating > _SKATES).mean()) if len(skating) else 0.0,
        sliding_share=float(sliding.mean()) if len(sliding) else 0.0,
        penetration_share=float((depth > _UNDER).mean()),
        penetration_max=max(float(depth.max()), 0.0),
        drift_max=drift,
        floating_max=highest,
    )
