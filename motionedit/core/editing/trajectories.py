"""Shape constraints: where an effector shall be at every frame, from a few points in time ([PRIO] section 4.2).

A trajectory is S(T(t)). Between points the displacement from the input is splined, so that the input's detail stays;
where some point gives a position, the path itself is. Inside a hold the target does not move at all.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.editing.splines import kochanek_bartels
from motionedit.core.timeline.warp import round_half_up

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray

Curve = Literal["time", "index"]


@dataclass(frozen=True, eq=False)
class ControlPoint:
    """A point of a trajectory, from frame `start` to frame `stop`, both in (the same for ``at``).

    Attributes
    ----------
    mode
        ``hold`` stands still, ``during`` rides the input's trajectory, ``at`` is one instant.
    position, shift : shape (3,) or None
        Where it is, or how far from the input's place (a hold: from the place at its start).
    orientation : shape (4,) or None
        Quaternion; None is the input's own (a hold: as at its start).
    tension, continuity, bias : float
        Of the spline, for ``at``.
    """

    mode: Literal["hold", "during", "at"]
    start: int
    stop: int
    position: FloatArray | None = None
    shift: FloatArray | None = None
    orientation: FloatArray | None = None
    tension: float = 0.0
    continuity: float = 0.0
    bias: float = 0.0

    @property
    def text(self) -> str:
        """How a message names it."""
        return f"at {self.start}" if self.mode == "at" else f"{self.mode} [{self.start}, {self.stop}]"


def active_interval(points: Sequence[ControlPoint], *, ease_in: float, ease_out: float, frames: int) -> tuple[int, int]:
    """Return the first and last frame at which points act: eased in and out, cut at the clip's ends.

    Raises
    ------
    ValueError
        If points overlap or are not in order.
    """
    for one, other in pairwise(points):
        if other.start <= one.stop:
            raise ValueError(f"{other.text} begins before {one.text} has ended; points follow each other in time")
    if not points:
        return 0, frames - 1
    first = round_half_up(points[0].start - ease_in)
    last = round_half_up(points[-1].stop + ease_out)
    return max(first, 0), min(last, frames - 1)


def position_targets(
    path: FloatArray, points: Sequence[ControlPoint], *, ease_in: float, ease_out: float, curve: Curve
) -> tuple[int, FloatArray]:
    """Return the first active frame and the targets from there on, shape (n, 3).

    Parameters
    ----------
    path : shape (F, 3)
        The input's trajectory.
    curve
        ``time``: S's parameter is time; ``index``: it is the knots' index, and T(t) is piecewise linear, as in the
        paper, whose speed jumps at uneven knots.
    """
    first, last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(path))
    if not points:
        return first, path.copy()
    velocity = np.gradient(path, axis=0) if len(path) > 1 else np.zeros_like(path)
    absolute = any(point.position is not None for point in points)
    # What is splined is the path where a point gives a position, else the displacement from it.
    base, slope = (np.zeros_like(path), np.zeros_like(velocity)) if absolute else (path, velocity)
    targets = path.copy()
    run = _Run(curve)
    if first < points[0].start:
        run.begin(first, path[first] - base[first], velocity[first] - slope[first])
    for point in points:
        places, tangents = _block(point, path, velocity)
        if point.mode == "at":
            run.add(point, places[0] - base[point.start])
            continue
        span = slice(point.start, point.stop + 1)
        run.end(point.start, places[0] - base[point.start], tangents[0] - slope[point.start], targets, base)
        targets[span] = places
        run.begin(point.stop, places[-1] - base[point.stop], tangents[-1] - slope[point.stop])
    if last > points[-1].stop:
        run.end(last, path[last] - base[last], velocity[last] - slope[last], targets, base)
    else:
        run.finish(targets, base)
    return first, targets[first : last + 1]


def _block(point: ControlPoint, path: FloatArray, velocity: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a point's places and speeds over its frames, shape (n, 3) each."""
    span = slice(point.start, point.stop + 1)
    shift = np.zeros(path.shape[1]) if point.shift is None else point.shift
    if point.mode == "during":
        return path[span] + shift, velocity[span]
    place = path[point.start] + shift if point.position is None else point.position
    count = point.stop - point.start + 1
    return np.tile(place, (count, 1)), np.zeros((count, path.shape[1]))


class _Run:
    """The knots of one stretch of spline, from the end of one block to the start of the next."""

    def __init__(self, curve: Curve) -> None:
        self.curve = curve
        self.clear()

    def clear(self) -> None:
        self.times: list[int] = []
        self.values: list[FloatArray] = []
        self.shape: list[tuple[float, float, float]] = []
        self.start_tangent: FloatArray | None = None

    def begin(self, time: int, value: FloatArray, tangent: FloatArray) -> None:
        self.clear()
        self._knot(time, value, (0.0, 0.0, 0.0))
        self.start_tangent = tangent

    def add(self, point: ControlPoint, value: FloatArray) -> None:
        self._knot(point.start, value, (point.tension, point.continuity, point.bias))

    def end(self, time: int, value: FloatArray, tangent: FloatArray, targets: FloatArray, base: FloatArray) -> None:
        """Add the last knot, and write the stretch's frames, base plus spline, into the targets."""
        if self.times and time > self.times[0]:
            self._knot(time, value, (0.0, 0.0, 0.0))
            self._write(tangent, targets, base)
        self.clear()

    def finish(self, targets: FloatArray, base: FloatArray) -> None:
        """Write a stretch that ends in its last knot at the clip's end."""
        if len(self.times) > 1:
            self._write(np.zeros_like(self.values[-1]), targets, base)
        elif self.times:
            targets[self.times[0]] = base[self.times[0]] + self.values[0]
        self.clear()

    def _knot(self, time: int, value: FloatArray, shape: tuple[float, float, float]) -> None:
        self.times.append(time)
        self.values.append(value)
        self.shape.append(shape)

    def _write(self, tangent: FloatArray, targets: FloatArray, base: FloatArray) -> None:
        times, values = np.array(self.times, dtype=np.float64), np.array(self.values)
        start = np.zeros_like(tangent) if self.start_tangent is None else self.start_tangent
        at = np.arange(self.times[0], self.times[-1] + 1, dtype=np.float64)
        tension, continuity, bias = np.array(self.shape).T
        if self.curve == "index":
            # T(t): time to knot index, straight between the knots; tangents are per index there.
            index = np.arange(len(times), dtype=np.float64)
            start, tangent = start * (times[1] - times[0]), tangent * (times[-1] - times[-2])
            at, times = np.interp(at, times, index), index
        span = slice(self.times[0], self.times[-1] + 1)
        targets[span] = base[span] + kochanek_bartels(
            times,
            values,
            tension=tension,
            continuity=continuity,
            bias=bias,
            start_tangent=start,
            end_tangent=tangent,
            at=at,
        )


def rotation_targets(
    rotations: FloatArray, points: Sequence[ControlPoint], *, ease_in: float, ease_out: float
) -> tuple[int, FloatArray]:
    """Return the first active frame and the target rotations from there on, shape (n, 4).

    From one point to the next the target is the slerp between what each would have it be at that frame (a hold: its
    constant, all others: turned with the input), by a share that starts and ends at rest, so its speed is continuous.

    Parameters
    ----------
    rotations : shape (F, 4)
        The input's.
    """
    first, last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(rotations))
    if not points:
        return first, rotations.copy()
    targets = rotations.copy()
    before: FloatArray | None = rotations if first < points[0].start else None
    since = first
    for point in points:
        source = _source(point, rotations)
        if before is not None:
            _blend(targets, before, source, since, point.start)
        targets[point.start : point.stop + 1] = source[point.start : point.stop + 1]
        before, since = source, point.stop
    if before is not None and last > since:
        _blend(targets, before, rotations, since, last)
    return first, targets[first : last + 1]


def _source(point: ControlPoint, rotations: FloatArray) -> FloatArray:
    """Return the rotations a point would have at every frame, shape (F, 4)."""
    own = rotations[point.start]
    wanted = own if point.orientation is None else point.orientation
    if point.mode == "hold":
        return np.broadcast_to(wanted, rotations.shape)
    if point.orientation is None:
        return rotations
    return rot.multiply(rot.multiply(wanted, rot.conjugate(own)), rotations)


def _blend(targets: FloatArray, before: FloatArray, after: FloatArray, start: int, stop: int) -> None:
    """Write the slerp from one source to another over the frames between start and stop."""
    if stop <= start:
        return
    frames = np.arange(start, stop + 1)
    t = (frames - start) / (stop - start)
    span = slice(start, stop + 1)
    targets[span] = rot.slerp(before[span], after[span], t * t * (3.0 - 2.0 * t))
