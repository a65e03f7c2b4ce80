"""Feet kept: a motion whose feet stand where another one's stand, by its legs and, where they are short, its pelvis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.body.bends import find_bends
from motionedit.core.feet.goals import FootGoal, Ground, foot_goal
from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto, turns_freely
from motionedit.core.feet.pelvis import drop_needed, smooth_cover
from motionedit.core.feet.reach import CALMS_ANOTHER, LOWERED, handed_on, reach_calm, reach_of, released
from motionedit.core.feet.stance import foot_path
from motionedit.core.kinematics import WorldPoses, shifted
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.feet.knees import Knee
    from motionedit.core.feet.stance import Foot, Stance


@dataclass(frozen=True, eq=False)
class Kept:
    """A motion whose feet stand, the goals of its feet, and how far its pelvis was lowered, shape (F,)."""

    motion: Motion
    goals: tuple[FootGoal, ...]
    lowered: FloatArray


def within_legs(
    stances: Sequence[tuple[Foot, Stance]],
    poses: WorldPoses,
    anatomy: Anatomy,
    *,
    up: FloatArray,
    lowered: float = LOWERED,
) -> list[tuple[Foot, Stance]]:
    """Return stances whose heels come up once the pelvis would have to be `lowered` by more of a leg for them."""
    low = lowered * anatomy.leg_length * up
    held = []
    for foot, stance in stances:
        up_again = released(stance, poses.positions[:, foot.leg.thigh] - low, reach_of(poses, foot))
        held.append((foot, handed_on(stance, up_again)))
    return held


def onto_stances(
    motion: Motion,
    poses: WorldPoses,
    stances: Sequence[tuple[Foot, Stance]],
    anatomy: Anatomy,
    ground: Ground,
    *,
    travel: int,
    first: int,
    calms: float = CALMS_ANOTHER,
) -> Kept:
    """Return a motion whose feet stand as given; without plants it is returned as it is.

    A plant is one place: a heel's, a toe's, and the foot's turn while both are down; the ankle rolls over the toe,
    and the foot comes down about the heel. Between plants the corrections ease (`eased`), so that the foot's own
    path and roll in the air are kept. Legs alone are solved onto them (`legs_onto`).

    A heel that its leg is too short for stays down, and the pelvis goes as low as that takes: see `within_legs`. It
    goes lower by a share `calms` of a leg at most for a knee that would shake beside its heel: see `reach_calm`.

    Parameters
    ----------
    motion, poses : Motion, WorldPoses
        The one whose feet are to stand, and its world transforms.
    stances : sequence of (Foot, Stance)
        When and where, in the motion's unit, as all lengths.
    travel : int
        The joint that carries the travel.
    first : int
        The first frame after a rest pose; earlier ones stay.
    """
    up = ground.up
    if not any(stance.down.any() for _, stance in stances):
        return Kept(motion, (), np.zeros(len(motion)))
    bends = {bend.joint: bend for bend in find_bends(motion.skeleton, poses, anatomy, first=first)}
    knees = {
        foot.side: knee_of(motion.skeleton, poses, foot.leg, bends[foot.leg.knee])
        for foot, _ in stances
        if foot.leg.knee in bends
    }
    lowered = np.zeros(len(motion))
    if motion.skeleton.position_axes[travel]:
        drop = _drop(poses, stances, knees, motion.frame_time, up=up, calms=calms)
        lowered[first:] = smooth_cover(drop[first:], motion.frame_time)
    shift = -lowered[:, None] * up
    goals = tuple(
        foot_goal(
            foot,
            foot_path(poses, foot),
            stance,
            motion.frame_time,
            hip=poses.positions[:, foot.leg.thigh] + shift,
            knee=knees.get(foot.side),
            ground=ground,
        )
        for foot, stance in stances
    )
    wanted = [
        LegGoal(goal.foot.leg, knees[goal.foot.side], goal.places, goal.turns, goal.back)
        for goal in goals
        if turns_freely(motion.skeleton, goal.foot.leg) and goal.foot.side in knees
    ]
    stood = legs_onto(motion, poses, wanted, shift=shift)
    done = shifted(stood, shift, travel, poses=poses) if lowered.any() else stood
    stood.rotations[:first] = motion.rotations[:first]
    found = Motion(motion.skeleton, frozen(stood.rotations), done.translations, motion.frame_time)
    return Kept(found, goals, lowered)


def _drop(
    poses: WorldPoses,
    stances: Sequence[tuple[Foot, Stance]],
    knees: Mapping[str, Knee],
    frame_time: float,
    *,
    up: FloatArray,
    calms: float,
) -> FloatArray:
    """Return how far the pelvis has to be lowered at each frame, shape (F,).

    Heels that stand say how low it is; a foot on its toe rolls on instead.
    """
    drop = np.zeros(len(poses.positions))
    for foot, stance in stances:
        hip, places, knee = poses.positions[:, foot.leg.thigh], stance.heel_place, knees.get(foot.side)
        if knee is None:
            reach = reach_of(poses, foot)
        else:
            reach = reach_calm(poses, foot, knee, stance, frame_time, calms=calms)
        drop = np.maximum(drop, np.where(stance.heel, drop_needed(hip, places, reach, up), 0.0))
    return drop
