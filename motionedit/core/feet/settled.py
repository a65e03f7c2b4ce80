"""Plants cut to when a point has settled: not yet while it comes down, no more once it rolls off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.plant_frames import frames_of
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant
    from motionedit.core.body.plant_frames import PlantFrames

# m/s, at a leg of `STANDARD_LEG`: a point that has settled is no faster than the plant's own median, which is how fast
# the whole foot slides, by more than this;
_FASTER = 0.12
# m: nor farther above the plant's own median height.
_ABOVE = 0.006
_HALF = 0.02  # s: speed is measured over twice that
_FEWEST = 3  # frames: a shorter plant has no ends
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
    down = frames_of(plants)
    if down is None:
        return []
    spans = _calm_spans(down, down.of(tracks) / (anatomy.leg_length / STANDARD_LEG), up, frame_time)
    cut = []
    for plant, (start, stop) in zip(plants, spans.tolist(), strict=True):
        if plant.frames < _FEWEST or start < 0 or (stop - start + 1) * frame_time < _SHORTEST:
            cut.append(plant)
        else:
            cut.append(replace(plant, start=plant.start + start, stop=plant.start + stop))
    return cut


def settling_rules(frame_time: float) -> tuple[int, int, float, float, float]:
    """Return by what the compiled part tells that a point has settled: as `settled`."""
    return _half(frame_time), _FEWEST, _FASTER, _ABOVE, _SHORTEST


def _half(frame_time: float) -> int:
    return max(1, round(_HALF / frame_time))


def _calm_spans(down: PlantFrames, places: FloatArray, up: FloatArray, frame_time: float) -> IntArray:
    """Return each plant's first and last frame that has settled, from its own first on, shape (n, 2); -1 without any.

    `places` (N, 3) are those of the plants' frames, metres.
    """
    half, spans = _half(frame_time), np.full((len(down.counts), 2), -1, dtype=np.intp)
    first = down.spread(down.starts)
    at = np.arange(len(first))
    before, after = np.maximum(at - half, first), np.minimum(at + half, first + down.spread(down.counts) - 1)
    # A plant of one frame, which is too short to be cut, has no speed.
    seconds = np.maximum(after - before, 1) * frame_time
    speed, height = rot.length(places[after] - places[before]) / seconds, places @ up
    above = np.abs(height - down.spread(down.medians(height)))
    calm = np.flatnonzero((speed <= down.spread(down.medians(speed)) + _FASTER) & (above <= _ABOVE))
    begins = np.searchsorted(calm, down.starts)
    ends = np.searchsorted(calm, down.starts + down.counts)
    some = ends > begins
    spans[some, 0], spans[some, 1] = calm[begins[some]], calm[ends[some] - 1]
    spans[some] -= down.starts[some, None]
    return spans
