"""Where a foot shall be at every frame: its stances, rolling on and coming down, and what eases between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.feet.correction import eased
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.feet.stance import Foot, FootPath, Stance

_NO_WAY = 1e-12  # a length: a foot without a toe has no arm
# Seconds: how slowly an ankle's correction bends, from the first where it is a small share of a leg to the second where
# it is a large one: far ways take their time.
_SLOWLY, _SMALL_TO_LARGE = (0.02, 0.05), (0.05, 0.1)
_GAP = 0.3  # s
_ROLLS = 4  # times that a foot which rolls on is eased anew
_DEEP = 1e-9  # of a foot's height: a foot that is so much too deep is no deeper than it may be


@dataclass(frozen=True, eq=False)
class Ground:
    """Which way is up, shape (3,), and the height below which no foot goes, None for no floor.

    `give` is by how much a foot in the air may go below its own height, where there is none, `leg` a leg's length.
    """

    up: FloatArray
    height: float | None
    give: float
    leg: float


@dataclass(frozen=True, eq=False)
class FootGoal:
    """Where a foot shall be: its ankle's places (F, 3) and turns (F, 4), and the frames at which it is `down` (F,)."""

    foot: Foot
    places: FloatArray
    turns: FloatArray
    down: BoolArray


def foot_goal(
    foot: Foot,
    path: FootPath,
    stance: Stance,
    frame_time: float,
    *,
    hip: FloatArray,
    reach: FloatArray,
    stiff: FloatArray,
    ground: Ground,
) -> FootGoal:
    """Return where a foot shall be at every frame, from where it goes and where it stands.

    A foot on its toe rolls on over it as far as the hip (F, 3) and the leg's reach (F,) ask.
    """
    flat, down = stance.flat, stance.down
    on_toe = stance.toe & ~stance.heel
    turn = np.where((np.sum(stance.turn * path.turn, axis=1) < 0.0)[:, None], -stance.turn, stance.turn)
    twist = rot.log(rot.multiply(turn, rot.conjugate(path.turn)))
    known, gap = flat, round(_GAP / frame_time)
    for _ in range(_ROLLS):
        turns = rot.multiply(rot.exp(eased(twist, known, frame_time)), path.turn)
        angle, axis = _roll_onto_reach(stance.toe_place, rot.rotate(turns, -path.toe), hip, reach)
        # A leg at its reach stays there over short gaps: to leave it and come back would shake the knee.
        far = on_toe & _closed(on_toe & ((angle > 0.0) | (known & ~flat)), gap)
        if not (far & ~known).any():
            break
        rolled = rot.log(rot.multiply(rot.multiply(rot.exp(angle[:, None] * axis), turns), rot.conjugate(path.turn)))
        twist, known = np.where(far[:, None], rolled, twist), known | far
    turns = rot.multiply(rot.exp(eased(twist, known, frame_time)), path.turn)
    turns[flat] = stance.turn[flat]
    over_toe = stance.toe_place - rot.rotate(turns, path.toe)
    places = np.where(stance.heel[:, None], stance.heel_place, over_toe)
    moved = places - path.ankle
    least = _least_heights(path, places, turns, down, ground)
    held = down
    bends = _bends(moved[down], ground.leg)
    for _ in range(_ROLLS):
        free = path.ankle + eased(moved, held, frame_time, bends=bends, stiff=stiff)
        lift = np.where(down, 0.0, least - _lowest(free, turns, path, ground.up))
        deep = lift > _DEEP * float(np.abs(least).max())
        if not deep.any():
            break
        moved = np.where(deep[:, None], free + lift[:, None] * ground.up - path.ankle, moved)
        held = held | deep
    if ground.height is not None:
        free = free + np.maximum(lift, 0.0)[:, None] * ground.up
    return FootGoal(foot, np.where(down[:, None], places, free), turns, down)


def _bends(corrections: FloatArray, leg: float) -> float:
    """Return how slowly an ankle's corrections (n, 3) bend, s, for a leg of this length."""
    largest = float(np.linalg.norm(corrections, axis=1).max(initial=0.0))
    return float(np.interp(largest / leg, _SMALL_TO_LARGE, _SLOWLY))


def _lowest(ankle: FloatArray, turns: FloatArray, path: FootPath, up: FloatArray) -> FloatArray:
    """Return the height of the lower of ankle and toe, shape (F,)."""
    lowest: FloatArray = np.minimum(ankle @ up, (ankle + rot.rotate(turns, path.toe)) @ up)
    return lowest


def _least_heights(
    path: FootPath, places: FloatArray, turns: FloatArray, down: BoolArray, ground: Ground
) -> FloatArray:
    """Return the height below which a foot in the air does not go, shape (F,).

    Its own in the input, or that of its plants around, whichever is lower; and the floor, where there is one.
    """
    at = np.flatnonzero(down)
    own = _lowest(path.ankle, path.turn, path, ground.up)
    if len(at):
        own = np.minimum(own, np.interp(np.arange(len(own)), at, _lowest(places, turns, path, ground.up)[at]))
    own = own - ground.give
    return own if ground.height is None else np.maximum(own, ground.height)


def _closed(there: BoolArray, gap: int) -> BoolArray:
    """Return frames, shape (F,), with gaps of up to so many frames closed."""
    at = np.flatnonzero(there)
    steps = np.diff(at)
    closed = there.copy()
    for start, step in zip(at[:-1], steps, strict=True):
        closed[start : start + step] |= step <= gap + 1
    return closed


def _roll_onto_reach(
    toe: FloatArray, arm: FloatArray, hip: FloatArray, reach: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the angles (F,) and unit axes (F, 3) about toes that bring the ankles, at toe + arm, just to their reach.

    An angle above 0 brings one nearer to its hip, that is beyond its reach as it is.
    """
    way = hip - toe
    long, short = np.linalg.norm(way, axis=1), np.linalg.norm(arm, axis=1)
    scale = np.maximum(long * short, _NO_WAY * np.maximum(long, 1.0))
    widest = np.arccos(np.clip((long**2 + short**2 - reach**2) / (2.0 * scale), -1.0, 1.0))
    now = np.arccos(np.clip(np.sum(way * arm, axis=1) / scale, -1.0, 1.0))
    axis = rot.cross(arm, way)
    unit: FloatArray = axis / np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), np.finfo(float).tiny)
    angle: FloatArray = now - widest
    return angle, unit
