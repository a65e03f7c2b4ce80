"""Where a foot stands: its phases, heel and toe down or one of them, and one place for each plant."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled
from motionedit.core.kinematics import effector_positions
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy, Leg, SolePoint
    from motionedit.core.body.contacts import Plant
    from motionedit.core.kinematics import WorldPoses


@dataclass(frozen=True, eq=False)
class Foot:
    """A leg, and the toe on which its foot stands: None where it has none."""

    side: str
    leg: Leg
    toe: SolePoint | None


def feet_of(anatomy: Anatomy) -> list[Foot]:
    """Return the feet, left before right; none where no legs were found."""
    toes = {point.foot: point for point in anatomy.sole_points if point.part == "toe"}
    sides = zip(("left", "right"), anatomy.legs or (), strict=False)
    return [Foot(side, leg, toes.get(side)) for side, leg in sides]


@dataclass(frozen=True, eq=False)
class FootPath:
    """How a foot goes: its ankle (F, 3), its turn (F, 4), and its toe in the ankle's frame (F, 3), in some unit."""

    ankle: FloatArray
    turn: FloatArray
    toe: FloatArray

    @cached_property
    def toe_place(self) -> FloatArray:
        """The toe in the world, shape (F, 3)."""
        return self.ankle + rot.rotate(self.turn, self.toe)


def foot_path(poses: WorldPoses, foot: Foot) -> FootPath:
    """Return how a foot goes in a motion."""
    ankle, turn = poses.positions[:, foot.leg.ankle], poses.rotations[:, foot.leg.ankle]
    if foot.toe is None:
        return FootPath(ankle, turn, np.zeros_like(ankle))
    toe = effector_positions(poses, foot.toe.effector)
    return FootPath(ankle, turn, rot.unrotate(turn, toe - ankle))


@dataclass(frozen=True, eq=False)
class Stance:
    """Where and when a foot stands.

    Attributes
    ----------
    heel, toe : shape (F,)
        Whether that part is down.
    heel_place, toe_place : shape (F, 3)
        Where it stands then.
    turn : shape (F, 4)
        How the foot is turned then.
    whole : shape (F,)
        The number of the stand to which a frame belongs, plants that hang together; -1 in the air.
    """

    heel: BoolArray
    toe: BoolArray
    heel_place: FloatArray
    toe_place: FloatArray
    turn: FloatArray
    whole: IntArray

    @property
    def flat(self) -> BoolArray:
        """Whether heel and toe are down, shape (F,)."""
        return self.heel & self.toe

    @property
    def down(self) -> BoolArray:
        """Whether anything is down, shape (F,)."""
        return self.heel | self.toe


def stance_of(path: FootPath, plants: Sequence[Plant]) -> Stance:
    """Return where a foot stands in a motion, from the plants of its heel and its toe.

    Every plant has one place, and the foot, while heel and toe are down, one turn: the mean of the motion's own.
    Plants that share frames hang together, by the foot between them: they are moved as a whole, and as little as can
    be, so that the mean of their ways from the motion's own places is nothing.
    """
    frames, kernel = len(path.ankle), compiled()
    if kernel is not None:
        return _stance_at_once(kernel.stance, path, plants)
    tracks = {"heel": path.ankle, "toe": path.toe_place}
    number = np.full((2, frames), -1, dtype=np.intp)
    for k, plant in enumerate(plants):
        number[0 if plant.part == "heel" else 1, plant.start : plant.stop + 1] = k
    turn = path.turn.copy()
    links: list[tuple[int, int]] = []
    turns, arms = [], []
    for heel, toe, both in _overlaps(number):
        turn[both] = mean_turn(path.turn[both])
        links.append((heel, toe))
        turns.append(turn[both[0]])
        arms.append(path.toe[both].sum(axis=0) / len(both))
    for heel, toe, at in _meetings(plants):
        links.append((heel, toe))
        turns.append(path.turn[at])
        arms.append(path.toe[at])
    ways = rot.rotate(np.array(turns).reshape(-1, 4), np.array(arms).reshape(-1, 3))
    whole, offsets = _chained(len(plants), links, ways)
    stands: dict[int, list[int]] = {}
    for k, stand in enumerate(whole):
        stands.setdefault(stand, []).append(k)
    places = np.zeros((len(plants) + 1, 3))
    for members in stands.values():
        together = np.concatenate(
            [tracks[plants[k].part][plants[k].start : plants[k].stop + 1] - offsets[k] for k in members]
        )
        places[members] = together.sum(axis=0) / len(together) + offsets[members]
    numbers = np.where(number[0] >= 0, number[0], number[1])
    named = np.array([*whole, -1], dtype=np.intp)
    return Stance(number[0] >= 0, number[1] >= 0, places[number[0]], places[number[1]], turn, named[numbers])


def _stance_at_once(work: Callable[..., None], path: FootPath, plants: Sequence[Plant]) -> Stance:
    """Return the stance as the compiled part finds it: `stance_of` in one call."""
    frames = len(path.ankle)
    spans = _spans_of(plants)
    down = np.empty((2, frames), dtype=np.bool_)
    places, turn, whole = np.empty((2, frames, 3)), np.empty((frames, 4)), np.empty(frames, dtype=np.int64)
    given = (np.ascontiguousarray(each) for each in (path.ankle, path.toe_place, path.turn, path.toe, spans))
    work(*given, *down, *places, turn, whole, frames, len(plants))
    return Stance(down[0], down[1], places[0], places[1], turn, whole.astype(np.intp, copy=False))


def _spans_of(plants: Sequence[Plant]) -> NDArray[np.int64]:
    """Return plants as the compiled part has them, shape (n, 3): whether it is a toe's, first and last frame."""
    spans = [(plant.part == "toe", plant.start, plant.stop) for plant in plants]
    return np.array(spans, dtype=np.int64).reshape(-1, 3)


def _overlaps(number: IntArray) -> list[tuple[int, int, IntArray]]:
    """Return the heels and toes that are down together, by their numbers (2, F), each pair with its frames."""
    at = np.flatnonzero((number >= 0).all(axis=0))
    if not len(at):
        return []
    heels, toes = number[:, at]
    order = np.lexsort((toes, heels))
    at, heels, toes = at[order], heels[order], toes[order]
    edges = np.flatnonzero((np.diff(heels) != 0) | (np.diff(toes) != 0)) + 1
    starts = [0, *edges.tolist()]
    return [
        (int(heels[start]), int(toes[start]), at[start:stop])
        for start, stop in zip(starts, [*starts[1:], len(at)], strict=True)
    ]


def _meetings(plants: Sequence[Plant]) -> list[tuple[int, int, int]]:
    """Return heels and toes of which one comes down as the other goes up, by their numbers, and at which frame."""
    links = []
    from_frame: dict[int, list[int]] = {}
    to_frame: dict[int, list[int]] = {}
    for t, toe in enumerate(plants):
        if toe.part == "toe":
            from_frame.setdefault(toe.start, []).append(t)
            to_frame.setdefault(toe.stop, []).append(t)
    for h, heel in enumerate(plants):
        if heel.part == "heel":
            meeting = sorted({*from_frame.get(heel.stop + 1, ()), *to_frame.get(heel.start - 1, ())})
            links += [(h, t, max(heel.start, plants[t].start)) for t in meeting]
    return links


def mean_turn(turns: FloatArray) -> FloatArray:
    """Return the mean of rotations that are near to each other, quaternions (n, 4), shape (4,)."""
    same = np.where((turns @ turns[0] < 0.0)[:, None], -turns, turns).sum(axis=0)
    mean: FloatArray = same / np.sqrt(same.dot(same))
    return mean


def _chained(count: int, links: Sequence[tuple[int, int]], ways: FloatArray) -> tuple[list[int], FloatArray]:
    """Return to which stand each plant belongs, and its offset (count, 3) within it, from n links and ways (n, 3).

    Heels do not overlap heels, nor toes toes: so links never close a circle, and one way leads to each plant.
    """
    whole, members = list(range(count)), {k: [k] for k in range(count)}
    # Numbers by themselves: few rows of three take longer as arrays.
    offsets = [[0.0, 0.0, 0.0] for _ in range(count)]
    for (heel, toe), way in zip(links, ways.tolist(), strict=True):
        if whole[heel] == whole[toe]:
            continue
        others = members.pop(whole[toe])
        # The toe's side is moved so that toe - heel is the way.
        shift = [a + b - c for a, b, c in zip(offsets[heel], way, offsets[toe], strict=True)]
        for k in others:
            offsets[k] = [a + b for a, b in zip(offsets[k], shift, strict=True)]
            whole[k] = whole[heel]
        members[whole[heel]] += others
    return whole, np.array(offsets).reshape(-1, 3)
