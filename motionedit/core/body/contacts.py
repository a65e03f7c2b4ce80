"""Foot contacts: when the heel and the toe of each foot stand, on the ground, a stair, a box or a slope."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from functools import lru_cache
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen, median, runs
from motionedit.core.body.in_one_loop import carried
from motionedit.core.compiled import compiled
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy, Part
    from motionedit.core.kinematics import WorldPoses

# Lengths and speeds for a leg of `STANDARD_LEG`; a clip's own unit is scaled to it.
_WHILE = 0.04  # s, over which speed is measured: 2 mm of noise at 240 Hz is 0.5 m/s from frame to frame
_ENTERS, _LEAVES = 0.3, 0.45  # m/s: a plant begins and ends at the second, if it gets below the first
_LOW = 0.05  # m above the point's own low while it is slow: a heel that rises slowly stands no more
_LOW_WHILE = 0.25  # s on both sides, in which that low is looked for: the height of a suit of sensors drifts
_LONGEST_GAP = 0.12  # s
_SAME_PLACE = 0.03  # m, within which a gap is no step
_SHORTEST = 0.05  # s: a stance of a run
# A foot held in the air has come up to where it is and goes down from there, by more than this.
_TOP = 0.06  # m
_TOP_WHILE = 0.2  # s
_HELD = 0.6  # s: longer than any jump's top lasts


@dataclass(frozen=True)
class Plant:
    """A point of a foot that stands from frame `start` to frame `stop`, both in.

    Attributes
    ----------
    foot, part : str
        ``left`` or ``right``; ``heel`` or ``toe``.
    joint : int
        Of the point; the ankle for a heel.
    point : int
        Its place among `Anatomy.sole_points`.
    height : float
        How high it stands, the median over the plant, clip units along up: the ground is each plant's own.
    """

    foot: str
    part: Part
    joint: int
    point: int
    start: int
    stop: int
    height: float

    @property
    def frames(self) -> int:
        """How many frames the plant lasts."""
        return self.stop - self.start + 1


@dataclass(frozen=True)
class FootPlant:
    """A foot that stands from frame `start` to frame `stop`, both in, with the plants of its heel and its toe."""

    foot: str
    start: int
    stop: int
    phases: tuple[Plant, ...]


def plants_of(tracks: FloatArray, anatomy: Anatomy, *, up: FloatArray, first: int, frame_time: float) -> list[Plant]:
    """Return the plants of heels and toes, each point by itself, in the order of their first frames.

    A point is planted while its speed over 40 ms is below 0.45 m/s, if it gets below 0.3, and it is no more than 5 cm
    above its own low within a quarter of a second (at a leg of 0.85 m). Gaps below 0.12 s in which it stays within 3 cm
    are closed; what is shorter than 0.05 s is none, and what the point has come up to and goes down from, by more than
    6 cm within 0.2 s, for less than 0.6 s or with the other foot below: the top of a jump, a foot held in the air.

    Parameters
    ----------
    tracks : shape (F, P, 3)
        Those of `sole_tracks`.
    up : shape (3,)
        Signed unit axis.
    first : int
        The first frame after a rest pose; earlier ones are never planted.
    """
    return planted(anatomy, stands_of(tracks, anatomy, up=up, first=first, frame_time=frame_time))


def planted(anatomy: Anatomy, stands: Iterable[Stand]) -> list[Plant]:
    """Return the plants that stands are, in their order."""
    points = anatomy.sole_points
    return [
        Plant(points[p].foot, points[p].part, points[p].joint, p, start, stop, height)
        for p, start, stop, height in stands
    ]


# The point of a plant, its first and last frame, and its height: most are cut before they become a `Plant`.
Stand = tuple[int, int, int, float]


def stands_of(tracks: FloatArray, anatomy: Anatomy, *, up: FloatArray, first: int, frame_time: float) -> list[Stand]:
    """Return the plants of `plants_of` as plain numbers."""
    if not anatomy.sole_points or len(tracks) - first < 2 or anatomy.leg_length <= 0.0:
        return []
    found = _stands_of_all(np.ascontiguousarray(tracks[first:]), anatomy, up, frame_time)
    # A foot's points stand together, left before right.
    return sorted([(p, first + start, first + stop, height) for p, start, stop, height in found], key=itemgetter(1, 0))


def sole_tracks(poses: WorldPoses, anatomy: Anatomy) -> FloatArray:
    """Return the paths of `Anatomy.sole_points` in the world, shape (F, P, 3), clip units."""
    return carried(poses, *anatomy.soles)


def _stands_of_all(tracks: FloatArray, anatomy: Anatomy, up: FloatArray, frame_time: float) -> list[Stand]:
    """Return the stands of all points, point by point, frames of `tracks` (F, P, 3)."""
    points, metre, kernel = anatomy.sole_points, anatomy.leg_length / STANDARD_LEG, compiled()
    if kernel is not None:
        feet, sizes = _feet_of_points(anatomy), tracks.shape[:2]
        stands = kernel.stands(tracks, feet, up, *sizes, metre, _rules(frame_time))
        return [(p, start, stop, metre * height) for p, start, stop, height in stands]
    heights_of_all, found = tracks @ up / metre, []
    for p, point in enumerate(points):
        places, heights = tracks[:, p] / metre, heights_of_all[:, p]
        others = [q for q, other in enumerate(points) if other.foot != point.foot]
        lowest = heights_of_all[:, others].min(axis=1, initial=np.inf)
        found += [
            (p, start, stop, metre * float(median(heights[start : stop + 1])))
            for start, stop in _stands(places, heights, lowest, frame_time)
        ]
    return found


@lru_cache(maxsize=8)
def _feet_of_points(anatomy: Anatomy) -> NDArray[np.int64]:
    """Return to which foot each of the sole points belongs, shape (P,): 0 is the left one."""
    return frozen(np.array([point.foot != "left" for point in anatomy.sole_points], dtype=np.int64))


@lru_cache(maxsize=8)
def _rules(frame_time: float) -> tuple[float, ...]:
    """Return by what the compiled part tells that a point stands."""
    return (
        *(_half(frame_time), round(_LOW_WHILE / frame_time), round(_LONGEST_GAP / frame_time)),
        *(_shortest(frame_time), _top_while(frame_time)),
        *(frame_time, _ENTERS, _LEAVES, _LOW, _SAME_PLACE, _TOP, _HELD / frame_time),
    )


def _half(frame_time: float) -> int:
    return max(1, round(0.5 * _WHILE / frame_time))


def _shortest(frame_time: float) -> int:
    return max(2, round(_SHORTEST / frame_time + 1e-9))


def _top_while(frame_time: float) -> int:
    return max(1, round(_TOP_WHILE / frame_time))


def foot_plants(plants: Sequence[Plant]) -> list[FootPlant]:
    """Return the plants of whole feet, in the order of their first frames: heel and toe plants that overlap or meet."""
    found: list[FootPlant] = []
    for foot in dict.fromkeys(plant.foot for plant in plants):
        phases: list[Plant] = []
        for plant in sorted((p for p in plants if p.foot == foot), key=lambda p: (p.start, p.point)):
            if phases and plant.start > max(p.stop for p in phases) + 1:
                found.append(_foot_plant(phases))
                phases = []
            phases.append(plant)
        found.append(_foot_plant(phases))
    return sorted(found, key=lambda plant: (plant.start, plant.foot))


def _foot_plant(phases: Sequence[Plant]) -> FootPlant:
    return FootPlant(phases[0].foot, phases[0].start, max(p.stop for p in phases), tuple(phases))


def _stands(
    places: FloatArray, heights: FloatArray, lowest: FloatArray, frame_time: float
) -> Iterator[tuple[int, int]]:
    """Yield (first, last) of the stretches in which a point stands.

    `places` (F, 3), `heights` (F,), and those of the `lowest` point of the other foot (F,) are in metres.
    """
    speed = _speeds(places, frame_time)
    slow = _hysteresis(speed < _LEAVES, speed < _ENTERS)
    width = round(_LOW_WHILE / frame_time)
    low = _rolling_minimum(np.where(slow, heights, np.inf), width)
    planted = _hysteresis(slow & (heights < low + _LOW), speed < _ENTERS)
    shortest, around = _shortest(frame_time), _top_while(frame_time)
    slow_runs = runs(slow)
    begins, ends = [first for first, _ in slow_runs], [last for _, last in slow_runs]
    for start, stop in _closed(runs(planted), places, round(_LONGEST_GAP / frame_time)):
        level = float(heights[start : stop + 1].min())
        began, ended = begins[bisect_left(ends, start)], ends[bisect_right(begins, stop) - 1]
        beside = (heights[max(0, began - around) : began], heights[ended + 1 : ended + 1 + around])
        lower = [side.min() < level - _TOP for side in beside if len(side)]
        # Who stands on a box for a while has both feet there, and who holds a foot up stands on the other.
        is_held = median(lowest[start : stop + 1]) < level - _TOP or stop - start + 1 < _HELD / frame_time
        is_top = bool(lower) and all(lower) and is_held
        if stop - start + 1 >= shortest and not is_top:
            yield start, stop


def _speeds(places: FloatArray, frame_time: float) -> FloatArray:
    """Return the speed over 40 ms (two frames at the least) around each frame, shape (F,); the ends have one side."""
    half = _half(frame_time)
    at = np.arange(len(places))
    before, after = np.maximum(at - half, 0), np.minimum(at + half, len(places) - 1)
    way = rot.length(places[after] - places[before])
    return way / ((after - before) * frame_time)


def _hysteresis(wide: BoolArray, narrow: BoolArray) -> BoolArray:
    """Return the runs of `wide` in which `narrow` is anywhere true."""
    kept = np.zeros_like(wide)
    inside = np.flatnonzero(wide & narrow).tolist()
    for start, stop in runs(wide):
        place = bisect_left(inside, start)
        kept[start : stop + 1] = place < len(inside) and inside[place] <= stop
    return kept


def _rolling_minimum(values: FloatArray, width: int) -> FloatArray:
    """Return the least value within `width` frames on both sides of each frame, shape (F,)."""
    padded = np.concatenate((np.full(width, np.inf), values, np.full(width, np.inf)))
    span, window = 1, 2 * width + 1
    while span < window:
        step = min(span, window - span)
        padded = np.minimum(padded[: len(padded) - step], padded[step:])
        span += step
    return padded[: len(values)]


def _closed(parts: Sequence[tuple[int, int]], places: FloatArray, gap: int) -> list[tuple[int, int]]:
    """Return runs of frames, together where fewer than `gap` frames part them and the point stays where it is."""
    joined: list[tuple[int, int]] = []
    for start, stop in parts:
        if joined and start - joined[-1][1] - 1 < gap:
            before = joined[-1]
            way = places[before[1] + 1 : start + 1] - places[before[1]]
            if np.linalg.norm(way, axis=1).max() < _SAME_PLACE:
                joined[-1] = (before[0], stop)
                continue
        joined.append((start, stop))
    return joined
