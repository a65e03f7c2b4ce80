"""The phases of a motion's stances: plants as feet can keep them, from those that each point shows by itself."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.feet.reach import ROUNDING, reach_of, released
from motionedit.core.feet.settled import settled
from motionedit.core.feet.stance import FootPath, feet_of, foot_path, spans_of, stance_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant
    from motionedit.core.kinematics import WorldPoses

_ROUNDS = 6
_SHORTEST = 0.05  # s: what is left of a heel's plant, with its toe down for a part of it, or it is none


def find_phases(
    tracks: FloatArray,
    legs: Sequence[LegPath],
    anatomy: Anatomy,
    plants: Sequence[Plant],
    *,
    up: FloatArray,
    frame_time: float,
) -> list[Plant]:
    """Return plants as they can be held in one place, in the order of their first frames: `settled`, then `kept`.

    Parameters
    ----------
    tracks : shape (F, P, 3)
        Those of `sole_tracks`.
    legs : sequence of LegPath
        Of the feet in the order of `feet_of`, by `leg_paths`.
    """
    calm = settled(plants, tracks, anatomy, up=up, frame_time=frame_time)
    return sorted(kept(calm, legs, anatomy, frame_time), key=lambda plant: (plant.start, plant.foot, plant.point))


class LegPath(NamedTuple):
    """How a leg goes: ankle (F, 3), its turn (F, 4), the toe in its frame (F, 3), hip (F, 3), and `reach_of` (F,)."""

    ankle: FloatArray
    turn: FloatArray
    toe: FloatArray
    hip: FloatArray
    reach: FloatArray


def leg_paths(poses: WorldPoses, anatomy: Anatomy) -> list[LegPath]:
    """Return how the legs of the feet go in a motion, in the order of `feet_of`."""
    found = []
    for foot in feet_of(anatomy):
        path, hip = foot_path(poses, foot), poses.positions[:, foot.leg.thigh]
        found.append(LegPath(path.ankle, path.turn, path.toe, hip, reach_of(poses, foot)))
    return found


def kept(plants: Sequence[Plant], legs: Sequence[LegPath], anatomy: Anatomy, frame_time: float) -> list[Plant]:
    """Return plants whose heels come up once the leg cannot hold them in one place any more (`released`)."""
    found: list[Plant] = []
    shortest, kernel = max(2, round(_SHORTEST / frame_time)), compiled()
    for foot, leg in zip(feet_of(anatomy), legs, strict=True):
        own = [plant for plant in plants if plant.foot == foot.side]
        path, hip, reach = FootPath(leg.ankle, leg.turn, leg.toe), leg.hip, leg.reach
        if kernel is not None:
            found += _kept_at_once(kernel.kept, own, path, shortest, hip=hip, reach=reach)
        else:
            found += _kept_in_rounds(own, path, shortest, hip=hip, reach=reach)
    return found


def _kept_at_once(
    work: Callable[..., None],
    plants: Sequence[Plant],
    path: FootPath,
    shortest: int,
    *,
    hip: FloatArray,
    reach: FloatArray,
) -> list[Plant]:
    """Return the plants of a foot that are left as the compiled part finds them: `_kept_in_rounds` in one call."""
    spans = spans_of(plants)
    given = (path.ankle, path.toe_place, path.turn, path.toe, hip, reach)
    work(*(np.ascontiguousarray(each) for each in given), spans, len(hip), len(plants), shortest, _ROUNDS, ROUNDING)
    stops = spans[:, 2].tolist()
    return [
        plant if stop == plant.stop else replace(plant, stop=stop)
        for plant, stop in zip(plants, stops, strict=True)
        if stop >= 0
    ]


def _kept_in_rounds(
    plants: Sequence[Plant], path: FootPath, shortest: int, *, hip: FloatArray, reach: FloatArray
) -> list[Plant]:
    """Return the plants of a foot that are left, cut until no heel comes up any more."""
    here: list[Plant | None] = [*plants]
    asked = list(range(len(here)))
    for _ in range(_ROUNDS if here else 0):
        before = [plant for plant in (here[i] for i in asked) if plant is not None]
        after = _held(before, path, shortest, hip=hip, reach=reach)
        for i, plant in zip(asked, after, strict=True):
            here[i] = plant
        # What hangs together with none that changed would come out as it is.
        again = _beside_changed(before, after)
        asked = [i for i, changed in zip(asked, again, strict=True) if changed and here[i] is not None]
        if not asked:
            break
    return [plant for plant in here if plant is not None]


def _beside_changed(before: Sequence[Plant], after: Sequence[Plant | None]) -> list[bool]:
    """Return whether each plant of a foot overlaps or meets one that changed, or another that does, and so on."""
    beside = [False] * len(before)
    together: list[int] = []
    stop = -2
    for k in sorted(range(len(before)), key=lambda k: before[k].start):
        if before[k].start > stop + 1:
            together = []
        together.append(k)
        stop = max(stop, before[k].stop)
        if after[k] is not before[k] or beside[together[0]]:
            for other in together if not beside[together[0]] else (k,):
                beside[other] = True
    return beside


def _held(
    plants: Sequence[Plant], path: FootPath, shortest: int, *, hip: FloatArray, reach: FloatArray
) -> list[Plant | None]:
    """Return plants, their heels up where `released` has them up; None where nothing is left of one."""
    stance = stance_of(path, plants)
    heel = released(stance, hip, reach).heel
    found: list[Plant | None] = []
    for plant in plants:
        stop = plant.stop
        while plant.part == "heel" and stop >= plant.start and not heel[stop]:
            stop -= 1
        if stop == plant.stop:
            found.append(plant)
        elif stop - plant.start >= shortest and stance.toe[plant.start : stop + 1].any():
            found.append(replace(plant, stop=stop))
        else:
            found.append(None)
    return found
