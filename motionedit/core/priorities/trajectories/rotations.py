"""Where a joint's rotation shall be at every frame, from a few points in time ([PRIO] section 4.2)."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.trajectories.positions import active_interval, eased, share_of
from motionedit.core.rotation_vectors import least_turned
from motionedit.core.smooth import smooth_step

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.trajectories.positions import ControlPoint


def rotation_targets(
    rotations: FloatArray, points: Sequence[ControlPoint], *, ease_in: float, ease_out: float, since: int = 0
) -> tuple[int, FloatArray]:
    """Return the first active frame and the target rotations from there on, shape (n, 4).

    From one point to the next the target is the slerp between what each would have it be at that frame (a hold: its
    constant, all others: turned with the input), by a share that starts and ends at rest, so its speed is continuous.

    Parameters
    ----------
    rotations : shape (F, 4)
        The input's.
    since : int
        The first frame after a rest pose: no ease reads those before.

    Raises
    ------
    ValueError
        If points overlap or are not in order.
    """
    first, last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(rotations), since=since)
    targets = rotations.copy()
    if not points:
        return first, targets
    begin, end = eased(points, ease_in=ease_in, ease_out=ease_out)
    share = share_of(points, ease_in=ease_in, ease_out=ease_out, frames=len(rotations))
    sources = [rotations, *(_source(point, rotations) for point in points), rotations]
    starts = [first, *(point.start for point in points), end]
    stops = [begin, *(point.stop for point in points), last]
    for k, (before, after) in enumerate(pairwise(sources)):
        ramp = (stops[k], starts[k + 1])
        if 0 < k < len(points):
            span = slice(stops[k], starts[k + 1] + 1)
            t = np.linspace(0.0, 1.0, span.stop - span.start)
            weights = np.minimum(t, 1.0 - t)
        else:
            # To the input and from it the same way round, over all that one point does.
            span = slice(first if k < 2 else starts[k], (last if k > len(points) - 2 else stops[k + 1]) + 1)
            weights = share[span]
        _blend(targets, before, after, ramp, span, weights)
    for point, source in zip(points, sources[1:-1], strict=True):
        targets[point.span] = source[point.span]
    return first, targets[first : last + 1]


def _source(point: ControlPoint, rotations: FloatArray) -> FloatArray:
    """Return the rotations a point would have at every frame, shape (F, 4)."""
    if point.turn is not None:
        rotations = rot.multiply(point.turn, rotations)
    own = rotations[point.start]
    wanted = own if point.orientation is None else point.orientation
    if point.mode == "hold":
        return np.broadcast_to(wanted, rotations.shape)
    if point.orientation is None:
        return rotations
    source = rot.multiply(rot.multiply(wanted, rot.conjugate(own)), rotations)
    source[point.start] = wanted
    return source


def _blend(
    targets: FloatArray, before: FloatArray, after: FloatArray, ramp: tuple[int, int], span: slice, weights: FloatArray
) -> None:
    """Write the slerp from one source to another over the frames between a ramp's ends.

    Parameters
    ----------
    span, weights : slice, shape (n,)
        Frames at which the arcs are looked at, and how much each is felt.
    """
    start, stop = ramp
    inside = np.arange(max(start + 1, span.start), min(stop, span.stop))
    if before is after or not len(inside):
        return
    arc = _arcs(before[span], after[span], weights)[inside - span.start]
    t = ((inside - start) / (stop - start))[:, None]
    targets[inside] = rot.multiply(before[inside], rot.exp(smooth_step(t) * arc))


def _arcs(before: FloatArray, after: FloatArray, weights: FloatArray) -> FloatArray:
    """Return rotation vectors from one source to another that follow each other in time, shape (n, 3).

    A shorter arc at every frame would change to the other side, and the target jump, where the input turns past half a
    turn from its goal. Of the ways round that one is taken whose longest arc, by its weight (n,), is the least: a joint
    that is never farther than half a turn from the input is never asked to come back from the other side.
    """
    return least_turned(rot.log(rot.between(before, after)), weights)
