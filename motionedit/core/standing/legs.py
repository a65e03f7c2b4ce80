"""Planted feet put back by the legs alone: the rest of the body stays as an edit left it, but for a lower pelvis.

Where a foot stands in the reference it stands so in the result, place and turn; between plants the correction is
eased. A leg that would be stretched lowers the pelvis, smoothly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.feet.correction import eased
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion
from motionedit.core.standing.plants import lowered, planted_frames
from motionedit.core.standing.two_bones import bent_to
from motionedit.core.timeline.alignment import TravelPath, travel_path, with_travel_path
from motionedit.core.timeline.interpolation import low_pass
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.contacts import FootPlant

Places = Literal["keep", "move"]

# The share of a leg's length that a planted foot may ask for before the pelvis is lowered, unless the reference's own
# leg is longer there; and the most that it is lowered, over the leg's length.
_STRETCHED = 0.985
_LOWEST = 0.15
# How much of the cosine of its bend a leg takes to come to rest before it is straight: in the air it may miss, where it
# stands the pelvis is lowered instead. Seconds between the two.
_SOFT_AIR, _SOFT_PLANT, _FIRM_WITHIN = 0.06, 0.006, 0.1
# Seconds: how slowly corrections bend between plants.
_BENDS = 0.05


@dataclass(frozen=True, eq=False)
class StandingFoot:
    """A leg and when its foot stands: `intervals` of frames, both ends in; at `fixed` frames it stays as edited."""

    leg: Leg
    intervals: tuple[tuple[int, int], ...]
    fixed: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class FeetKept:
    """The motion with its feet put back, and what was changed: `touched` (F, J) joints, `moved` (F,) travel."""

    motion: Motion
    touched: BoolArray
    moved: BoolArray


def standing_feet(
    motion: Motion, legs: Sequence[Leg], plants: Sequence[FootPlant], *, fixed: Collection[tuple[int, int]] = ()
) -> list[StandingFoot]:
    """Return the feet of a body whose legs can be turned freely, with their plants.

    Parameters
    ----------
    fixed : collection of (joint, frame)
        Where a joint is meant to be where the edit put it: a plant with such a frame of its foot is left alone.
    """
    skeleton, feet = motion.skeleton, []
    for side, leg in zip(("left", "right"), legs, strict=False):
        if any(len(skeleton.rotation_axes[j]) != 3 for j in (leg.thigh, leg.knee, leg.ankle)):
            continue
        frames = tuple(sorted(f for joint, f in fixed if leg.thigh in skeleton.chain(joint)))
        intervals = tuple(
            (p.start, p.stop) for p in plants if p.foot == side and not any(p.start <= f <= p.stop for f in frames)
        )
        feet.append(StandingFoot(leg, intervals, frames))
    return feet


def keep_feet(
    edited: Motion,
    reference: Motion,
    feet: Sequence[StandingFoot],
    *,
    up: FloatArray,
    travel: int,
    places: Places,
    first: int = 0,
) -> FeetKept:
    """Return an edited motion whose feet stand where the reference's stand.

    Parameters
    ----------
    edited, reference : Motion
        Of one skeleton, frame by frame; clip units.
    up : shape (3,)
    travel : int
        The joint that carries the travel.
    places : str
        ``keep``: each plant where it is in the reference; ``move``: where the edit takes it as a whole.
    first : int
        Frames before this one are a rest pose and stay as they are.
    """
    frames = len(edited)
    touched, moved = np.zeros((frames, len(edited.skeleton)), dtype=np.bool_), np.zeros(frames, dtype=np.bool_)
    before, now = forward(reference), forward(edited)
    targets = [_target(foot, before, now, up=up, places=places, frame_time=edited.frame_time) for foot in feet]
    need = np.zeros(frames)
    for foot, target in zip(feet, targets, strict=True):
        need = np.maximum(need, _too_far(foot, target, before, now, up=up))
    drop = lowered(need, edited.frame_time)
    drop[:first] = 0.0
    if drop.any():
        path = travel_path(edited, travel)
        edited = with_travel_path(edited, travel, TravelPath(path.positions - drop[:, None] * up, path.rotations))
        moved = drop > 0.0
        now = WorldPoses(now.positions - drop[:, None, None] * up, now.rotations)
    rotations = edited.rotations.copy()
    for foot, target in zip(feet, targets, strict=True):
        changed = _turn_leg(rotations, foot.leg, edited, now, target, drop=drop, first=first)
        touched[:, [foot.leg.thigh, foot.leg.knee, foot.leg.ankle]] |= changed[:, None]
    motion = Motion(edited.skeleton, frozen(rotations), edited.translations, edited.frame_time)
    return FeetKept(motion, touched, moved)


@dataclass(frozen=True, eq=False)
class _Target:
    """Where an ankle is wanted (F, 3), how its foot is turned (F, 4), which frames differ from the edit (F,)."""

    positions: FloatArray
    rotations: FloatArray
    corrected: BoolArray
    planted: BoolArray
    soft: FloatArray


def _target(
    foot: StandingFoot, before: WorldPoses, now: WorldPoses, *, up: FloatArray, places: Places, frame_time: float
) -> _Target:
    ankle = foot.leg.ankle
    positions, rotations = now.positions[:, ankle], now.rotations[:, ankle]
    planted = planted_frames(foot.intervals, len(positions))
    way = before.positions[:, ankle] - positions
    if places == "move":
        for start, stop in foot.intervals:
            mean = way[start : stop + 1].mean(axis=0)
            way[start : stop + 1] -= mean - (mean @ up) * up
    turn = rot.log(rot.multiply(before.rotations[:, ankle], rot.conjugate(rotations)))
    known = planted.copy()
    known[list(foot.fixed)] = True
    wanted = np.where(planted[:, None], np.concatenate((way, turn), axis=1), 0.0)
    c = eased(wanted, known, frame_time, bends=_BENDS)
    firm = low_pass(planted[:, None].astype(np.float64), sigma=_FIRM_WITHIN / frame_time)[:, 0]
    return _Target(
        positions + c[:, :3],
        rot.multiply(rot.exp(c[:, 3:]), rotations),
        np.asarray(c.any(axis=1)),
        planted,
        _SOFT_AIR + (_SOFT_PLANT - _SOFT_AIR) * np.clip(firm, 0.0, 1.0),
    )


def _too_far(foot: StandingFoot, target: _Target, before: WorldPoses, now: WorldPoses, *, up: FloatArray) -> FloatArray:
    """Return how much lower the hip must be for a leg to reach its planted foot unstretched, shape (F,)."""
    leg = foot.leg
    bones = before.positions[:, [leg.knee, leg.ankle]] - before.positions[:, [leg.thigh, leg.knee]]
    length = float(np.linalg.norm(bones, axis=2).sum(axis=1).max())
    own = np.linalg.norm(before.positions[:, leg.ankle] - before.positions[:, leg.thigh], axis=1)
    reach = np.maximum(own, _STRETCHED * length)
    v = target.positions - now.positions[:, leg.thigh]
    over, height = np.einsum("fi,fi->f", v, v) - reach**2, -(v @ up)
    # (height - h)^2 + |level|^2 = reach^2
    drop = height - np.sqrt(np.maximum(height**2 - over, 0.0))
    # Rounding lowers no pelvis.
    over = np.where(over > 1e-9 * length**2, over, 0.0)
    return np.where(target.planted & (over > 0.0) & (height > 0.0), np.minimum(drop, _LOWEST * length), 0.0)


def _turn_leg(
    rotations: FloatArray, leg: Leg, edited: Motion, now: WorldPoses, target: _Target, *, drop: FloatArray, first: int
) -> BoolArray:
    """Write the local rotations of a leg that brings its foot to the target, and return the frames it changed."""
    changed = target.corrected | (drop > 0.0)
    changed[:first] = False
    f = np.flatnonzero(changed)
    if not len(f):
        return changed
    p, q = now.positions[f], now.rotations[f]
    ankle, soft = p[:, leg.ankle], target.soft[f]
    shank, whole = bent_to(p[:, leg.thigh], p[:, leg.knee], ankle, target.positions[f], q[:, leg.thigh], soft=soft)
    parents = edited.skeleton.parents
    thigh = rot.multiply(whole, q[:, leg.thigh])
    above = q[:, parents[leg.thigh]] if parents[leg.thigh] >= 0 else np.broadcast_to(rot.IDENTITY, thigh.shape)
    rotations[f, leg.thigh] = rot.multiply(rot.conjugate(above), thigh)
    # What lies between thigh and knee turns with the thigh.
    above_knee = rot.multiply(whole, q[:, parents[leg.knee]])
    knee = rot.multiply(whole, rot.multiply(shank, q[:, leg.knee]))
    rotations[f, leg.knee] = rot.multiply(rot.conjugate(above_knee), knee)
    above_ankle = rot.multiply(whole, rot.multiply(shank, q[:, parents[leg.ankle]]))
    rotations[f, leg.ankle] = rot.multiply(rot.conjugate(above_ankle), target.rotations[f])
    return changed
