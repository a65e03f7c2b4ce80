"""Plants cut to when a point has settled: not yet while it comes down, no more once it rolls off."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import median
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant

# m/s, at a leg of `STANDARD_LEG`: a point that has settled is no faster than the plant's own median, which is how fast
# the whole foot slides, by more than this;
_FASTER = 0.12
# m: nor farther above the plant's own median height.
_ABOVE = 0.006
_HALF = 0.02  # s: speed is measured over twice that
_SHORTEST = 0.05  # s: what is left of a shorter one is the plant as it was


def settled(
    plants: Sequence[Plant], tracks: FloatArray, anatomy: Anatomy, *, up: FloatArray, frame_time: float
) -> list[Plant]:
    """Return plants cut at both ends to the frames in which their point has settled, in the same order.

    Parameters
    ----------
    plants, tracks
        As `plants_of`, shape (F, P, 3), and its plants.
    """
    metre = anatomy.leg_length / STANDARD_LEG
    return [_cut(plant, tracks[plant.start : plant.stop + 1, plant.point] / metre, up, frame_time) for plant in plants]


def _cut(plant: Plant, places: FloatArray, up: FloatArray, frame_time: float) -> Plant:
    if len(places) < 3:
        return plant
    half = max(1, round(_HALF / frame_time))
    at = np.arange(len(places))
    before, after = np.maximum(at - half, 0), np.minimum(at + half, len(places) - 1)
    speed = rot.length(places[after] - places[before]) / ((after - before) * frame_time)
    height = places @ up
    calm = np.flatnonzero((speed <= median(speed) + _FASTER) & (np.abs(height - median(height)) <= _ABOVE))
    if not len(calm) or (calm[-1] - calm[0] + 1) * frame_time < _SHORTEST:
        return plant
    return replace(plant, start=plant.start + int(calm[0]), stop=plant.start + int(calm[-1]))
