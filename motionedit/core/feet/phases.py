"""The phases of a motion's stances: plants as feet can keep them, from those that each point shows by itself."""

from __future__ import annotations

from functools import lru_cache
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.body.contacts import planted
from motionedit.core.compiled import compiled
from motionedit.core.feet.reach import REACH, ROUNDING, reach_of, released
from motionedit.core.feet.settled import settled, settling_rules
from motionedit.core.feet.stance import FootPath, feet_of, foot_path, stance_of
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant, Stand
    from motionedit.core.kinematics import WorldPoses

_ROUNDS = 6
_SHORTEST = 0.05  # s: what is left of a heel's plant, with its toe down for a part of it, or it is none


def find_phases(
    tracks: FloatArray,
    legs: FloatArray,
    anatomy: Anatomy,
    stands: Sequence[Stand],
    *,
    up: FloatArray,
    frame_time: float,
) -> list[Plant]:
    """Return plants as they can be held in one place, in the order of their first frames: `settled`, then `kept`.

    Parameters
    ----------
    tracks : shape (F, P, 3)
        Those of `sole_tracks`.
    legs : shape (F, n, 14)
        Of the feet in the order of `feet_of`, by `leg_paths`.
    stands : sequence of Stand
        Those of `stands_of`.
    """
    kernel = compiled()
    if stands and kernel is not None:
        parts = _parts_of(anatomy)
        spans = np.array([(*parts[p], p, start, stop) for p, start, stop, _ in stands], dtype=np.int64)
        sizes, metre = (*tracks.shape[:2], legs.shape[1], len(stands)), anatomy.leg_length / STANDARD_LEG
        rules = settling_rules(frame_time), (_shortest(frame_time), _ROUNDS, ROUNDING)
        # Both in one call; of a stand that is none any more the last frame is -1.
        kernel.phases(np.ascontiguousarray(tracks), up, legs, spans, *sizes, metre, frame_time, *rules)
        cut = zip(stands, spans[:, 3:].tolist(), strict=True)
        left = [(p, start, stop, height) for (p, _, _, height), (start, stop) in cut if stop >= 0]
        return planted(anatomy, sorted(left, key=itemgetter(1, 0)))
    calm = settled(planted(anatomy, stands), tracks, anatomy, up=up, frame_time=frame_time)
    found = kept(calm, legs, anatomy, frame_time)
    return sorted(found, key=lambda plant: (plant.start, plant.foot, plant.point))


def leg_paths(poses: WorldPoses, anatomy: Anatomy) -> FloatArray:
    """Return how the legs of n feet go in a motion, in the order of `feet_of`, shape (F, n, 14).

    That is at each frame: the ankle, its turn, the toe in its frame, the hip, and `reach_of`.
    """
    kernel, (frames, joints) = compiled(), poses.rotations.shape[:2]
    if kernel is not None:
        legs, toes = _legs_of(anatomy)
        paths = np.empty((frames, len(legs), 14))
        given = np.ascontiguousarray(poses.positions), np.ascontiguousarray(poses.rotations), frames, joints
        kernel.leg_paths(*given, legs, toes, len(legs), REACH, paths)
        return paths
    found = []
    for foot in feet_of(anatomy):
        path, hip, reach = foot_path(poses, foot), poses.positions[:, foot.leg.thigh], reach_of(poses, foot)
        found.append(np.concatenate((path.ankle, path.turn, path.toe, hip, reach[:, None]), axis=1))
    return np.stack(found, axis=1) if found else np.empty((frames, 0, 14))


@lru_cache(maxsize=8)
def _legs_of(anatomy: Anatomy) -> tuple[NDArray[np.int64], FloatArray]:
    """Return the joints of n legs, thigh, knee, ankle and the toe's, -1 without one, (n, 4), and toes in its frame."""
    joints, toes = [], []
    for foot in feet_of(anatomy):
        joint, offset = (-1, (0.0, 0.0, 0.0)) if foot.toe is None else (foot.toe.joint, foot.toe.offset)
        joints.append((*foot.leg.joints, joint))
        toes.append(offset)
    return frozen(np.array(joints, np.int64).reshape(-1, 4)), frozen(np.array(toes, np.float64).reshape(-1, 3))


@lru_cache(maxsize=8)
def _parts_of(anatomy: Anatomy) -> tuple[tuple[int, bool], ...]:
    """Return the foot of each of the sole points, by its place, and whether it is a toe."""
    places = {"left": 0, "right": 1}
    return tuple((places[point.foot], point.part == "toe") for point in anatomy.sole_points)


def kept(plants: Sequence[Plant], legs: FloatArray, anatomy: Anatomy, frame_time: float) -> list[Plant]:
    """Return plants whose heels come up once the leg cannot hold them in one place any more (`released`)."""
    found: list[Plant] = []
    for foot, leg in zip(feet_of(anatomy), legs.swapaxes(0, 1), strict=True):
        own = [plant for plant in plants if plant.foot == foot.side]
        path = FootPath(leg[:, :3], leg[:, 3:7], leg[:, 7:10])
        found += _kept_in_rounds(own, path, _shortest(frame_time), hip=leg[:, 10:13], reach=leg[:, 13])
    return found


def _shortest(frame_time: float) -> int:
    return max(2, round(_SHORTEST / frame_time))


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
