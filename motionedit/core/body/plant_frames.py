"""The frames of plants one after the other, so that all plants of a motion are measured at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.again import LastFew, Same
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.contacts import Plant


@dataclass(frozen=True, eq=False)
class PlantFrames:
    """The frames of P plants one after the other, so that all are measured at once.

    Attributes
    ----------
    frames, points : shape (N,)
        Each frame, and the point that stands there: N is the sum over the plants.
    starts, counts : shape (P,)
        Where each plant's frames begin among them, and how many there are.
    """

    frames: IntArray
    points: IntArray
    starts: IntArray
    counts: IntArray

    def of(self, values: FloatArray) -> FloatArray:
        """Return a plant's values frame by frame, shape (N, ...), of values by frame and point, (F, points, ...)."""
        return values[self.frames, self.points]

    def means(self, values: FloatArray) -> FloatArray:
        """Return each plant's mean of values frame by frame, shape (P, ...) of (N, ...)."""
        counts = self.counts.reshape(-1, *(1,) * (values.ndim - 1))
        means: FloatArray = np.add.reduceat(values, self.starts, axis=0) / counts
        return means

    def medians(self, values: FloatArray) -> FloatArray:
        """Return each plant's median of values frame by frame, shape (P,) of (N,)."""
        ordered = values[np.lexsort((values, np.repeat(np.arange(len(self.counts)), self.counts)))]
        above = ordered[self.starts + self.counts // 2]
        medians: FloatArray = np.where(
            self.counts % 2 == 1, above, (ordered[self.starts + np.maximum(self.counts // 2 - 1, 0)] + above) / 2.0
        )
        return medians

    def spread(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return a value of each plant at all its frames, shape (N, ...) of (P, ...)."""
        return np.repeat(values, self.counts, axis=0)


def frames_of(plants: Sequence[Plant]) -> PlantFrames | None:
    """Return the frames of plants; None of none."""
    if not plants:
        return None
    if not isinstance(plants, tuple):
        return _frames_of(plants)
    # A clip's own are asked for again and again; to compare them one by one would take longer.
    key = Same(plants)
    return _FRAMES.get(key) or _FRAMES.keep(key, _frames_of(plants))


_FRAMES: LastFew[PlantFrames] = LastFew(2)


def _frames_of(plants: Sequence[Plant]) -> PlantFrames:
    starts, stops, points = np.array([(plant.start, plant.stop, plant.point) for plant in plants], dtype=np.intp).T
    counts = stops - starts + 1
    places = np.cumsum(counts) - counts
    frames = np.arange(int(counts.sum())) + np.repeat(starts - places, counts)
    return PlantFrames(frozen(frames), frozen(np.repeat(points, counts)), frozen(places), frozen(counts))


def spans_of(plants: Sequence[Plant]) -> NDArray[np.int64]:
    """Return plants as the compiled part has them, shape (n, 3): point, first and last frame."""
    if not isinstance(plants, tuple):
        return _spans_of(plants)
    key = Same(plants)
    known = _SPANS.get(key)
    return _SPANS.keep(key, _spans_of(plants)) if known is None else known


_SPANS: LastFew[NDArray[np.int64]] = LastFew(2)


def _spans_of(plants: Sequence[Plant]) -> NDArray[np.int64]:
    rows = [(plant.point, plant.start, plant.stop) for plant in plants]
    return frozen(np.array(rows, dtype=np.int64).reshape(-1, 3))
