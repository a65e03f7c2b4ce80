"""Stands moved as a whole: within reach of a body that goes on another path, or onto one height."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.feet.reach import released
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.feet.stance import Stance

# Seconds over which the body follows the heights of its feet.
_FOLLOWS = 0.25
# Rounds, each of which takes half of what a stand lacks: the farthest frames of its two ends share what cannot be had.
_ROUNDS = 48
_WELL_WITHIN = 0.999  # of the reach: what a step aims at, so that few of them arrive


def within_reach(stance: Stance, hip: FloatArray, reach: FloatArray, low: float, up: FloatArray) -> Stance:
    """Return a stance whose stands are moved on the level, where a heel would be `released`, until it is within reach.

    A body that goes on another path goes farther, or faster, while a foot stands: where the mean of its path takes
    the foot, the leg may be too short for the first or the last frames.

    Parameters
    ----------
    hip : shape (F, 3)
    reach : shape (F,)
        How far from the hip the heel may be.
    low : float
        How far the pelvis may come down before a heel is released; where both ends of a stand lack, each gets a share.
    """
    let_go = stance.heel & ~released(stance, hip - low * up, reach).heel
    way = stance.heel_place - hip
    height = way @ up
    level = way - height[:, None] * up
    radius = np.sqrt(np.maximum(reach**2 - height**2, 0.0))
    ways = np.zeros((len(stance.whole), 3))
    for stand in np.unique(stance.whole[let_go]):
        here = stance.whole == stand
        from_hip, within, moved = level[here & stance.heel], radius[here & stance.heel], np.zeros(3)
        for _ in range(_ROUNDS):
            far = np.linalg.norm(from_hip + moved, axis=1)
            worst = int(np.argmax(far - within))
            if far[worst] <= within[worst]:
                break
            moved -= 0.5 * (1.0 - _WELL_WITHIN * within[worst] / far[worst]) * (from_hip[worst] + moved)
        ways[here] = moved
    return replace(stance, heel_place=stance.heel_place + ways, toe_place=stance.toe_place + ways)


def on_height(stance: Stance, height: float, up: FloatArray) -> Stance:
    """Return a stance each of whose stands has the lower of its heel and toe on a height along up.

    A stand of a heel alone is moved as the others are, by their mean: how thick a heel is, it does not show.
    """
    lifts: dict[int, float] = {}
    stands = [int(stand) for stand in np.unique(stance.whole[stance.whole >= 0])]
    for stand in stands:
        here = stance.whole == stand
        toes = stance.toe_place[here & stance.toe] @ up
        heels = stance.heel_place[here & stance.heel] @ up
        if len(toes):
            lifts[stand] = height - min(float(toes.min()), float(heels.min(initial=np.inf)))
    usual = float(np.mean(list(lifts.values()))) if lifts else 0.0
    ways = np.zeros((len(stance.whole), 3))
    for stand in stands:
        ways[stance.whole == stand] = lifts.get(stand, usual) * up
    return replace(stance, heel_place=stance.heel_place + ways, toe_place=stance.toe_place + ways)


def body_shift(stances: Sequence[tuple[Stance, Stance]], frame_time: float, up: FloatArray) -> FloatArray:
    """Return how the body comes along as its feet are lifted, shape (F, 3): from one stance to the other of each foot.

    The mean lift of the feet that are down, linear between, smoothed over a quarter of a second.
    """
    frames = len(stances[0][0].whole)
    total, count = np.zeros(frames), np.zeros(frames)
    for before, after in stances:
        way = np.where(before.heel[:, None], after.heel_place - before.heel_place, after.toe_place - before.toe_place)
        total += np.where(before.down, way @ up, 0.0)
        count += before.down
    down = np.flatnonzero(count)
    if not len(down) or not np.any(total):
        return np.zeros((frames, 3))
    lift = np.interp(np.arange(frames), down, total[down] / count[down])
    half = max(1, round(_FOLLOWS / frame_time))
    box = np.full(2 * half + 1, 1.0 / (2 * half + 1))
    for _ in range(3):
        lift = np.convolve(np.pad(lift, half, mode="edge"), box, mode="valid")
    shift: FloatArray = lift[:, None] * up
    return shift
