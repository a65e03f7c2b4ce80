"""Lengths over time: how long something shall be at every frame, from a few points in time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core.priorities.trajectories.positions import ControlPoint, active_interval
from motionedit.core.smooth import smooth_step
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray

# A length itself, or what it shall not fall below or rise above.
Bound = Literal["distance", "at_least", "at_most"]

_OF_INPUT: dict[Bound, Callable[[FloatArray, float], FloatArray]] = {"at_least": np.minimum, "at_most": np.maximum}


@dataclass(frozen=True, eq=False)
class LengthPoint(ControlPoint):
    """A control point that may give a `length`, too: what it shall be, or its `bound`; None is the input's own."""

    length: float | None = None
    bound: Bound = "distance"


def length_targets(
    own: FloatArray, points: Sequence[LengthPoint], *, ease_in: float, ease_out: float, since: int = 0
) -> FloatArray:
    """Return the lengths that points ask for, from the first active frame to the last, shape (n,).

    From one point to the next the length goes by a share that starts and ends at rest. It eases from and to the
    input's own; a bound, which asks for nothing where the input keeps it, from and to the nearer of itself and that.

    Parameters
    ----------
    own : shape (F,)
        The input's.
    since : int
        The first frame after a rest pose: no ease reads those before.

    Raises
    ------
    ValueError
        If points overlap or are not in order.
    """
    first, last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(own), since=since)
    targets = own.copy()
    if not points:
        return targets
    before, start = _of_input(points[0], own), first
    for point in points:
        source = _source(point, own)
        _blend(targets, before, source, start, point.start)
        targets[point.span] = source[point.span]
        before, start = source, point.stop
    _blend(targets, before, _of_input(points[-1], own), start, last)
    return targets[first : last + 1]


def _source(point: LengthPoint, own: FloatArray) -> FloatArray:
    """Return the lengths a point would have at every frame, shape (F,)."""
    if point.length is None and point.mode != "hold":
        return own
    return np.full_like(own, own[point.start] if point.length is None else point.length)


def _of_input(point: LengthPoint, own: FloatArray) -> FloatArray:
    """Return what a point eases from and to, shape (F,)."""
    if point.length is None or point.bound == "distance":
        return own
    return _OF_INPUT[point.bound](own, point.length)


def _blend(targets: FloatArray, before: FloatArray, after: FloatArray, start: int, stop: int) -> None:
    """Write what is between two sources from `start` to `stop`, whose own frames are the sources'."""
    t = np.linspace(0.0, 1.0, stop - start + 1)
    span = slice(start, stop + 1)
    targets[span] = before[span] + smooth_step(t) * (after[span] - before[span])
