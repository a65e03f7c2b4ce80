"""Feet put back after an edit: where a whole foot stands in the reference it goes as it goes there, place and turn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.feet.goals import Ground
from motionedit.core.feet.keep import onto_stances
from motionedit.core.feet.legs import turns_freely
from motionedit.core.feet.stance import Stance, feet_of, foot_path
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import FootPlant
    from motionedit.core.feet.stance import Foot, FootPath

Places = Literal["keep", "move"]

_ROUNDING = 1e-12  # of quaternions: a leg that is turned by no more stays as it is, to the bit


@dataclass(frozen=True, eq=False)
class StandingFoot:
    """A foot and when it stands: `intervals` of frames, both ends in; at `fixed` frames it stays as edited."""

    foot: Foot
    intervals: tuple[tuple[int, int], ...]
    fixed: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class PutBack:
    """The motion with its feet put back, and what was changed: `touched` (F, J) joints, `moved` (F,) travel."""

    motion: Motion
    touched: BoolArray
    moved: BoolArray


def standing_feet(
    motion: Motion, anatomy: Anatomy, plants: Sequence[FootPlant], *, fixed: Collection[tuple[int, int]] = ()
) -> list[StandingFoot]:
    """Return the feet of a body whose legs can be turned freely, with their plants.

    Parameters
    ----------
    fixed : collection of (joint, frame)
        Where a joint is meant to be where the edit put it: a plant with such a frame of its foot is left alone.
    """
    found = []
    for foot in feet_of(anatomy):
        if not turns_freely(motion.skeleton, foot.leg):
            continue
        frames = tuple(sorted(f for joint, f in fixed if foot.leg.thigh in motion.skeleton.chain(joint)))
        intervals = tuple(
            (p.start, p.stop) for p in plants if p.foot == foot.side and not any(p.start <= f <= p.stop for f in frames)
        )
        found.append(StandingFoot(foot, intervals, frames))
    return found


def put_back(
    edited: Motion,
    reference: Motion,
    feet: Sequence[StandingFoot],
    anatomy: Anatomy,
    *,
    up: FloatArray,
    travel: int,
    places: Places,
    first: int = 0,
) -> PutBack:
    """Return an edited motion whose feet stand where the reference's stand, by `onto_stances`.

    Heels stay down as long as they do in the reference, slips and all; the pelvis is lowered where legs are short.

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
    before, now = forward(reference), forward(edited)
    stances = [
        (each.foot, _stance(each, foot_path(before, each.foot), foot_path(now, each.foot), up=up, places=places))
        for each in feet
    ]
    # Lifted before it comes down, a leg that is nearly straight would kick: what the edit makes of the air is kept.
    ground = Ground(up, None, np.inf, anatomy.leg_length)
    kept = onto_stances(edited, now, stances, anatomy, ground, travel=travel, first=first)
    touched = np.abs(kept.motion.rotations - edited.rotations).max(axis=-1) > _ROUNDING
    rotations = np.where(touched[..., None], kept.motion.rotations, edited.rotations)
    motion = Motion(edited.skeleton, frozen(rotations), kept.motion.translations, edited.frame_time)
    return PutBack(motion, touched, kept.lowered > 0.0)


def _stance(standing: StandingFoot, theirs: FootPath, now: FootPath, *, up: FloatArray, places: Places) -> Stance:
    """Return where a foot stands: flat as it goes in the reference, and where the edit has it at its fixed frames."""
    down, whole = np.zeros(len(now.ankle), dtype=np.bool_), np.full(len(now.ankle), -1)
    heel, toe, turn = now.ankle.copy(), now.toe_place.copy(), now.turn.copy()
    for stand, (start, stop) in enumerate(standing.intervals):
        span, way = slice(start, stop + 1), np.zeros(3)
        if places == "move":
            way = (now.ankle[span] - theirs.ankle[span]).mean(axis=0)
            way = way - (way @ up) * up
        heel[span], toe[span], turn[span] = theirs.ankle[span] + way, theirs.toe_place[span] + way, theirs.turn[span]
        down[span], whole[span] = True, stand
    fixed = list(standing.fixed)
    down[fixed], whole[fixed] = True, len(standing.intervals) + np.arange(len(fixed))
    return Stance(down, down, heel, toe, turn, whole)
