"""Feet kept: a motion whose feet stand where another one's stand, by its legs and, where they are short, its pelvis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.body.bends import find_bends
from motionedit.core.feet.goals import FootGoal, Ground, foot_goal, ground_under
from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto, turns_freely
from motionedit.core.feet.pelvis import drop_needed, smooth_cover
from motionedit.core.feet.reach import CALMS_ANOTHER, CALMS_OWN, LOWERED, handed_on, reach_calm, reach_of, released
from motionedit.core.feet.stance import feet_of, foot_path, stance_of
from motionedit.core.kinematics import WorldPoses, forward, shifted
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.body.contacts import Plant
    from motionedit.core.feet.stance import Foot, Stance


@dataclass(frozen=True, eq=False)
class Kept:
    """A motion whose feet stand, the goals of its feet, and how far its pelvis was lowered, shape (F,)."""

    motion: Motion
    goals: tuple[FootGoal, ...]
    lowered: FloatArray


def keep_feet(
    motion: Motion,
    reference: Motion,
    anatomy: Anatomy,
    plants: Sequence[Plant],
    *,
    up: FloatArray,
    travel: int,
    first: int = 0,
) -> Kept:
    """Return a motion with planted feet that stand where another version of it has them.

    A plant is one place: a heel's, a toe's, and the foot's turn while both are down; the ankle rolls over the toe,
    and the foot comes down about the heel. Between plants the corrections ease (`eased`), so that the foot's own
    path and roll in the air are kept. Legs alone are solved onto them (`legs_onto`); where a leg is too short the
    pelvis is lowered smoothly. Without plants the motion is returned as it is.

    Parameters
    ----------
    motion : Motion
        The one to be mended: an edited one.
    reference : Motion
        The one whose places the plants keep, of the same frames and skeleton; the motion itself, to mend its sliding.
    anatomy : Anatomy
        In the motions' unit, as all lengths.
    plants : sequence of Plant
        When heels and toes stand, as `plants_of` of the reference.
    up : shape (3,)
        Signed unit axis.
    travel : int
        The joint that carries the travel.
    first : int
        The first frame after a rest pose; earlier ones stay.
    """
    poses = forward(motion)
    theirs = poses if reference is motion else forward(reference)
    stances = []
    for foot in feet_of(anatomy):
        here = [plant for plant in plants if plant.foot == foot.side]
        stances.append((foot, stance_of(foot_path(theirs, foot), here)))
    held = within_legs(stances, poses, anatomy, up=up)
    ground = ground_under(anatomy, up)
    calms = CALMS_OWN if reference is motion else CALMS_ANOTHER
    return onto_stances(motion, poses, held, anatomy, ground, travel=travel, first=first, calms=calms)


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
    """Return a motion whose feet stand as given, as `keep_feet`; `poses` are its world transforms.

    A heel that its leg is too short for stays down, and the pelvis goes as low as that takes: see `within_legs`. It
    goes lower by a share `calms` of a leg at most for a knee that would shake beside its heel: see `reach_calm`.
    """
    up = ground.up
    lowered = np.zeros(len(motion))
    if not any(stance.down.any() for _, stance in stances):
        return Kept(motion, (), lowered)
    bends = {bend.joint: bend for bend in find_bends(motion.skeleton, poses, anatomy, first=first)}
    knees = {
        foot.side: knee_of(motion.skeleton, poses, foot.leg, bends[foot.leg.knee])
        for foot, _ in stances
        if foot.leg.knee in bends
    }
    if motion.skeleton.position_axes[travel]:
        # Heels that stand say how low the pelvis is; a foot on its toe rolls on instead.
        for foot, stance in stances:
            hip, places, knee = poses.positions[:, foot.leg.thigh], stance.heel_place, knees.get(foot.side)
            reach = (
                reach_of(poses, foot)
                if knee is None
                else reach_calm(poses, foot, knee, stance, motion.frame_time, calms=calms)
            )
            lowered = np.maximum(lowered, np.where(stance.heel, drop_needed(hip, places, reach, up), 0.0))
        lowered[:first] = 0.0
        lowered[first:] = smooth_cover(lowered[first:], motion.frame_time)
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
    rotations = done.rotations.copy()
    rotations[:first] = motion.rotations[:first]
    found = Motion(done.skeleton, frozen(rotations), done.translations, done.frame_time)
    return Kept(found, goals, lowered)
