"""Where a foot shall be at every frame: its stances, rolling on and coming down, and what eases between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.feet.correction import eased
from motionedit.core.feet.knees import eased_ways
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.feet.knees import Knee
    from motionedit.core.feet.stance import Foot, FootPath, Stance

_GIVE = 0.006  # of a leg
_NO_WAY = 1e-12  # a length: a foot without a toe has no arm
# Seconds: how slowly an ankle's correction bends, from the first where it is a small share of a leg to the second where
# it is a large one: far ways take their time.
_SLOWLY, _SMALL_TO_LARGE = (0.02, 0.05), (0.05, 0.1)
_LIFTS = 4  # times that a foot which is too deep is eased anew
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


def ground_under(anatomy: Anatomy, up: FloatArray, *, floor: float | None = None) -> Ground:
    """Return the ground of a body, on which a foot in the air goes 5 mm deeper than before (at a leg of 0.85 m)."""
    return Ground(up, floor, _GIVE * anatomy.leg_length, anatomy.leg_length)


@dataclass(frozen=True, eq=False)
class FootGoal:
    """Where a foot shall be: its ankle's places (F, 3) and turns (F, 4), and the frames at which it is `down` (F,).

    `back` says at which its knee is bent back, shape (F,).
    """

    foot: Foot
    places: FloatArray
    turns: FloatArray
    down: BoolArray
    back: BoolArray


def foot_goal(
    foot: Foot,
    path: FootPath,
    stance: Stance,
    frame_time: float,
    *,
    hip: FloatArray,
    knee: Knee | None,
    ground: Ground,
) -> FootGoal:
    """Return where a foot shall be at every frame, from where it goes and where it stands, and from its hip (F, 3).

    In the air, and on its toe, over which it rolls, it is where a knee that is nearly straight eases. About a heel that
    is down alone it is turned until its toe is on the floor, where it would be deeper.
    """
    flat, down = stance.flat, stance.down
    on_toe, on_heel = stance.toe & ~stance.heel, stance.heel & ~stance.toe
    turn = np.where((np.sum(stance.turn * path.turn, axis=1) < 0.0)[:, None], -stance.turn, stance.turn)
    twist = rot.log(rot.multiply(turn, rot.conjugate(path.turn)))
    turns = rot.multiply(rot.exp(eased(twist, flat, frame_time)), path.turn)
    places = _standing(stance, path, turns)
    back, roll = np.zeros(len(down), dtype=np.bool_), np.zeros_like(places)
    if knee is not None and on_toe.any():
        # In the air a leg counts as straight: beside it one that rolls over its toe eases, however bent it is.
        straight = hip - knee.way(np.zeros(len(hip)))[:, None] * ground.up
        there = np.where(down[:, None], places, straight)
        ways, back = eased_ways(knee, hip, path.ankle, there, known=stance.heel, back=back, frame_time=frame_time)
        back &= on_toe
        onto = _roll_onto(stance.toe_place, rot.rotate(turns, -path.toe), hip, ways, ground)
        roll = np.where(on_toe[:, None], onto, roll)
    if ground.height is not None and on_heel.any():
        out = _roll_out(stance.heel_place, rot.rotate(turns, path.toe), ground.up, ground.height)
        roll = np.where(on_heel[:, None], out, roll)
    if roll.any():
        rolled = rot.multiply(rot.exp(roll), turns)
        twist = rot.log(rot.multiply(rolled, rot.conjugate(path.turn)))
        turns = rot.multiply(rot.exp(eased(twist, down, frame_time)), path.turn)
    turns[flat] = stance.turn[flat]
    places = _standing(stance, path, turns)
    moved = places - path.ankle
    least = _least_heights(path, places, turns, down, ground)
    held = down
    bends = _bends(moved[down], ground.leg)
    for _ in range(_LIFTS):
        free, behind = path.ankle + eased(moved, held, frame_time, bends=bends), back
        if knee is not None:
            ways, bent_back = eased_ways(knee, hip, path.ankle, free, known=held, back=back, frame_time=frame_time)
            free = np.where(held[:, None], free, _at_ways(free, hip, ways))
            behind = np.where(held, back, bent_back)
        lift = np.where(down, 0.0, least - _lowest(free, turns, path, ground.up))
        deep = lift > _DEEP * float(np.abs(least).max())
        if not deep.any():
            break
        moved = np.where(deep[:, None], free + lift[:, None] * ground.up - path.ankle, moved)
        held = held | deep
    if ground.height is not None:
        free = free + np.maximum(lift, 0.0)[:, None] * ground.up
    return FootGoal(foot, np.where(down[:, None], places, free), turns, down, behind)


def _standing(stance: Stance, path: FootPath, turns: FloatArray) -> FloatArray:
    """Return where the ankle is as the foot stands, shape (F, 3): its heel's place, or over its toe."""
    return np.where(stance.heel[:, None], stance.heel_place, stance.toe_place - rot.rotate(turns, path.toe))


def _at_ways(ankle: FloatArray, hip: FloatArray, ways: FloatArray) -> FloatArray:
    """Return ankles (F, 3) brought to a way (F,) from their hips, in the direction that they have."""
    way = ankle - hip
    share = ways / np.maximum(rot.length(way), np.finfo(float).tiny)
    brought: FloatArray = hip + share[:, None] * way
    return brought


def _bends(corrections: FloatArray, leg: float) -> float:
    """Return how slowly an ankle's corrections (n, 3) bend, s, for a leg of this length."""
    largest = float(rot.length(corrections).max(initial=0.0))
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


def _roll_onto(toe: FloatArray, arm: FloatArray, hip: FloatArray, ways: FloatArray, ground: Ground) -> FloatArray:
    """Return rotation vectors (F, 3) about toes that bring the ankles, at toe + arm, to ways (F,) from the hips.

    But no ankle goes below the floor, where there is one.
    """
    way = hip - toe
    long, short = rot.length(way), rot.length(arm)
    scale = np.maximum(long * short, _NO_WAY * np.maximum(long, 1.0))
    wanted = np.arccos(np.clip((long**2 + short**2 - ways**2) / (2.0 * scale), -1.0, 1.0))
    now = np.arccos(np.clip(rot.dot(way, arm) / scale, -1.0, 1.0))
    axis = rot.cross(arm, way)
    unit = axis / np.maximum(rot.length(axis)[:, None], np.finfo(float).tiny)
    roll: FloatArray = (now - wanted)[:, None] * unit
    if ground.height is None:
        return roll
    height, rolled, floor = arm @ ground.up, rot.rotate(rot.exp(roll), arm) @ ground.up, ground.height - toe @ ground.up
    deep = rolled < np.minimum(height, floor)
    share = np.where(deep, np.maximum(height - floor, 0.0) / np.where(deep, height - rolled, 1.0), 1.0)
    return share[:, None] * roll


def _roll_out(heel: FloatArray, arm: FloatArray, up: FloatArray, floor: float) -> FloatArray:
    """Return rotation vectors (F, 3) about heels that bring toes, at heel + arm, onto a floor where they are deeper."""
    height, rise, length = arm @ up, floor - heel @ up, rot.length(arm)
    # A floor out of the toe's reach leaves the foot upright.
    scale = np.maximum(np.maximum(length, np.abs(rise)), np.finfo(float).tiny)
    now, least = np.arcsin(np.clip(height / scale, -1.0, 1.0)), np.arcsin(rise / scale)
    axis = rot.cross(arm, np.broadcast_to(up, arm.shape))
    unit = axis / np.maximum(rot.length(axis)[:, None], np.finfo(float).tiny)
    roll: FloatArray = np.maximum(least - now, 0.0)[:, None] * unit
    return roll
