"""Shape constraints: where an effector shall be at every frame, from a few points in time ([PRIO] section 4.2).

A trajectory is S(T(t)). Between points the displacement from the input is splined, so that the input's detail stays;
where some point gives a position, the path itself is. Inside a hold the target does not move at all.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core.blocks import BLOCK_FRAMES
from motionedit.core.priorities.trajectories.splines import Basis, basis_of, kochanek_bartels
from motionedit.core.smooth import smooth_step
from motionedit.core.timeline import round_half_up
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray

# What the parameter u of a spline S(u) is: time, or the knots' index as in the paper.
Curve = Literal["time", "index"]


@dataclass(frozen=True, eq=False)
class ControlPoint:
    """A point of a trajectory, from frame `start` to frame `stop`, both in (the same for ``at``).

    Attributes
    ----------
    mode
        ``hold`` stands still, ``during`` rides the input's trajectory, ``at`` is one instant.
    position, shift : shape (3,) or None
        Where it is, or how far from the input's place (a hold: from the place at its start). ``during`` has no
        position.
    orientation : shape (4,) or None
        Quaternion; None is the input's own (a hold: as at its start).
    tension, continuity, bias : float
        Of the spline, for ``at``. A hold has tension 1 whatever it says.
    turn : shape (4,) or None
        In place of an orientation: what turns the input's own (a hold: as at its start) further.
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
    turn: FloatArray | None = None

    @property
    def text(self) -> str:
        """How a message names it."""
        return f"at {self.start}" if self.mode == "at" else f"{self.mode} [{self.start}, {self.stop}]"

    @property
    def span(self) -> slice:
        """Its frames."""
        return slice(self.start, self.stop + 1)


def active_interval(
    points: Sequence[ControlPoint], *, ease_in: float, ease_out: float, frames: int, since: int = 0
) -> tuple[int, int]:
    """Return the first and last frame at which points act: eased in and out, cut at the clip's ends.

    No points act over the whole clip. Frames before `since`, a rest pose, are in no ease.

    Raises
    ------
    ValueError
        If points overlap or are not in order.
    """
    for one, other in pairwise(points):
        if other.stop < one.start:
            raise ValueError(f"'{other.text}' comes after '{one.text}'; points stand in the order of their times")
        if other.start <= one.stop:
            raise ValueError(f"'{one.text}' and '{other.text}' share a frame; both ends of an interval are in it")
    if not points:
        return 0, frames - 1
    first, last = eased(points, ease_in=ease_in, ease_out=ease_out)
    return max(first, since if points[0].start >= since else 0), min(last, frames - 1)


def eased(points: Sequence[ControlPoint], *, ease_in: float, ease_out: float) -> tuple[int, int]:
    """Return the frames at which points begin to ease in and have eased out, also where these are beyond the clip.

    Both are rounded to the nearest frame, halves up, as every time is.
    """
    return round_half_up(points[0].start - ease_in), round_half_up(points[-1].stop + ease_out)


def share_of(points: Sequence[ControlPoint], *, ease_in: float, ease_out: float, frames: int) -> FloatArray:
    """Return how far points are eased in at each frame, shape (F,), 0 to 1, with a continuous slope.

    No points: all the way. A ramp that the clip's end cuts is as steep as any: what is left of it is in the clip.
    """
    if not points:
        return np.ones(frames)
    first, last = eased(points, ease_in=ease_in, ease_out=ease_out)
    start, stop = points[0].start, points[-1].stop
    f = np.arange(frames, dtype=np.float64)
    rise = np.ones(frames) if start <= first else np.clip((f - first) / (start - first), 0.0, 1.0)
    fall = np.ones(frames) if stop >= last else np.clip((last - f) / (last - stop), 0.0, 1.0)
    t = rise * fall
    return smooth_step(t)


def position_targets(
    path: FloatArray,
    points: Sequence[ControlPoint],
    *,
    ease_in: float,
    ease_out: float,
    curve: Curve,
    since: int = 0,
) -> tuple[int, FloatArray]:
    """Return the first active frame and the targets from there on, shape (n, 3).

    What is splined is the displacement from the input, or the path itself where some point gives a position. The
    curve leaves and meets the input's trajectory at the input's velocity, and a hold at rest. Points are met exactly;
    a displacement of zero leaves the input's own numbers.

    Parameters
    ----------
    path : shape (F, 3)
        The input's trajectory.
    ease_in, ease_out : float
        Frames. A ramp that the clip's end cuts begins, or ends, beyond it, as if the input went straight on there: the
        curve is as steep as elsewhere, and already displaced where the clip begins.
    curve
        ``time``: S's parameter is time; ``index``: it is the knots' index, and T(t) is piecewise linear, as in the
        paper, whose speed jumps at uneven knots.
    since : int
        The first frame after a rest pose: neither eases nor velocities read those before.

    Raises
    ------
    ValueError
        If points overlap or are not in order.
    """
    first, last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(path), since=since)
    targets = path.copy()
    if not points:
        return first, targets
    velocity = np.zeros(path.shape)
    for start, stop in ((0, since), (since, len(path))):
        if stop - start > 1:
            _write_slope(path[start:stop], velocity[start:stop])
    absolute = any(point.position is not None for point in points)
    # What is splined is the path where a point gives a position, else the displacement from it.
    base, slope = (np.zeros(path.shape), np.zeros(path.shape)) if absolute else (path, velocity)
    ramps = eased(points, ease_in=ease_in, ease_out=ease_out)
    for run in _runs(points, _Input(path, velocity, base, slope), (first, last), ramps):
        start, stop = max(run[0].frame + 1, first), min(run[-1].frame, last + 1)
        if start < stop:
            targets[start:stop] = base[start:stop] + _splined(run, at=(start, stop), curve=curve)
    # Last, and not through the spline: path + (place - path) may differ from place by a rounding.
    for point in points:
        targets[point.span] = _places(point, path)
    return first, targets[first : last + 1]


def _write_slope(path: FloatArray, out: FloatArray) -> None:
    """Write the slope per frame of a path, shape (F, 3), F above 1: as `numpy.gradient`, which takes twice as long."""
    np.subtract(path[2:], path[:-2], out=out[1:-1])
    out[1:-1] /= 2.0
    np.subtract(path[1], path[0], out=out[0])
    np.subtract(path[-1], path[-2], out=out[-1])


@dataclass(frozen=True, eq=False)
class _Knot:
    """A knot of a spline over the base: its value, and its slope (per frame), which counts at the ends of a run.

    `shape` holds tension, continuity and bias.
    """

    frame: int
    value: FloatArray
    slope: FloatArray
    shape: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class _Input:
    """The input's path and velocity (per frame), and the base over which is splined with its slope, shapes (F, 3)."""

    path: FloatArray
    velocity: FloatArray
    base: FloatArray
    slope: FloatArray

    def knot(
        self, frame: int, place: FloatArray, velocity: FloatArray, shape: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> _Knot:
        """Return a knot at a place, passed with a velocity."""
        return _Knot(frame, place - self.base[frame], velocity - self.slope[frame], shape)

    def end(self, frame: int, inside: int) -> _Knot:
        """Return the knot at which a ramp meets the input, whose last frame on this side is `inside`."""
        path, velocity = self.path[inside], self.velocity[inside]
        beyond = (frame - inside) * (velocity - self.slope[inside])
        return _Knot(frame, path - self.base[inside] + beyond, velocity - self.slope[inside])


def _places(point: ControlPoint, path: FloatArray) -> FloatArray:
    """Return where a point wants its frames, shape (n, 3), or (3,) where that is one place for all."""
    shift = np.zeros(3) if point.shift is None else point.shift
    if point.mode == "during":
        return path[point.span] + shift
    return path[point.start] + shift if point.position is None else point.position


def _runs(
    points: Sequence[ControlPoint], given: _Input, active: tuple[int, int], ramps: tuple[int, int]
) -> list[list[_Knot]]:
    """Return the knots of each run of spline: from the input, or a block's last frame, to the next block, or the input.

    A hold or a ride is a block. A hold's two equal points of tension 1 cut the paper's one spline just there: no
    tangent passes them.
    """
    runs: list[list[_Knot]] = [[]]
    if ramps[0] < points[0].start:
        runs[-1].append(given.end(ramps[0], active[0]))
    for point in points:
        places = np.broadcast_to(_places(point, given.path), given.path[point.span].shape)
        if point.mode == "at":
            shape = (point.tension, point.continuity, point.bias)
            runs[-1].append(given.knot(point.start, places[0], given.velocity[point.start], shape))
            continue
        moves = 1.0 if point.mode == "during" else 0.0
        runs[-1].append(given.knot(point.start, places[0], moves * given.velocity[point.start]))
        runs.append([given.knot(point.stop, places[-1], moves * given.velocity[point.stop])])
    if ramps[1] > points[-1].stop:
        runs[-1].append(given.end(ramps[1], active[1]))
    return [run for run in runs if len(run) > 1]


def _splined(run: list[_Knot], *, at: tuple[int, int], curve: Curve) -> FloatArray:
    """Return the spline of a run's knots over the base, S(T(t)), at frames from one up to another, shape (N, 3)."""
    values = np.array([knot.value for knot in run])
    tension, continuity, bias = np.array([knot.shape for knot in run]).T
    # A point that ends a run, having no ramp, goes at the input's velocity as far as its tension lets it.
    start, end = ((1.0 - tension[k]) * run[k].slope for k in (0, -1))
    frames = tuple([knot.frame for knot in run])
    if curve == "index":
        # Tangents are per index there.
        start, end = start * float(frames[1] - frames[0]), end * float(frames[-1] - frames[-2])
    find = _basis_again if at[1] - at[0] <= BLOCK_FRAMES else _basis
    knots, basis = find(frames, at, curve)
    return kochanek_bartels(
        knots,
        values,
        tension=tension,
        continuity=continuity,
        bias=bias,
        start_tangent=start,
        end_tangent=end,
        basis=basis,
    )


def _basis(frames: tuple[int, ...], at: tuple[int, int], curve: Curve) -> tuple[FloatArray, Basis]:
    """Return the knots at frames, as the curve has them, and the basis of splines through them, S(T(t))."""
    knots, u = np.array(frames, dtype=np.float64), np.arange(*at, dtype=np.float64)
    if curve == "index":
        # T(t): time to knot index, straight between the knots.
        index = np.arange(len(knots), dtype=np.float64)
        knots, u = index, np.interp(u, knots, index)
    return knots, basis_of(knots, u)


# The clips of a folder mostly share their points.
_basis_again = lru_cache(maxsize=32)(_basis)
