"""Legs alone, solved exactly: the hip turns, the knee bends about its axis, the ankle turns; nothing else moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.feet.knees import Knee
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class LegGoal:
    """A leg, its knee in the motion, its ankle's places (F, 3) and turns (F, 4) in the world.

    `back` says where the knee is bent back, shape (F,); None: nowhere.
    """

    leg: Leg
    knee: Knee
    places: FloatArray
    turns: FloatArray
    back: BoolArray | None = None


def turns_freely(skeleton: Skeleton, leg: Leg, *, left_alone: Collection[int] = ()) -> bool:
    """Return whether hip, knee and ankle can be turned about three axes each, so that a leg is solved exactly.

    They cannot without three rotation channels, or where they are among the joints that are `left_alone`.
    """
    return all(skeleton.turns_freely(joint) and joint not in left_alone for joint in leg.joints)


def legs_onto(
    motion: Motion,
    poses: WorldPoses,
    goals: Sequence[LegGoal],
    *,
    shift: FloatArray | None = None,
) -> Motion:
    """Return a motion whose ankles are at given places, turned as given, by the legs' joints alone.

    The knee bends about its own axis as far as the way from hip to ankle asks; the hip turns the leg onto it by the
    smallest turn; the ankle turns back. A leg that is too short points to its ankle's place and stays straight.

    Parameters
    ----------
    motion, poses
        The motion, and its world transforms.
    goals : sequence of LegGoal
    shift : shape (F, 3), optional
        How far the hips were shifted since `poses` were taken.
    """
    rotations = motion.rotations.copy()
    parents = motion.skeleton.parents
    for goal in goals:
        leg, turns = goal.leg, goal.turns
        hip, middle, ankle = (poses.positions[:, j] for j in leg.joints)
        wanted = goal.places - hip - (0.0 if shift is None else shift)
        upper, lower = middle - hip, ankle - middle
        knee = goal.knee
        angle = knee.bent(rot.length(wanted))
        flexion = _axis_turn(
            knee.axis, (angle if goal.back is None else np.where(goal.back, -angle, angle)) - knee.angle
        )
        swing = _smallest_turn(upper + rot.rotate(flexion, lower), wanted)
        above = {j: poses.rotations[:, parents[j]] for j in leg.joints}
        world = rot.multiply(swing, poses.rotations[:, leg.thigh])
        rotations[:, leg.thigh] = rot.between(above[leg.thigh], world)
        bent = rot.multiply(flexion, poses.rotations[:, leg.knee])
        rotations[:, leg.knee] = rot.between(above[leg.knee], bent)
        below = rot.multiply(rot.multiply(swing, flexion), above[leg.ankle])
        rotations[:, leg.ankle] = rot.between(below, turns)
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


def _axis_turn(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the rotations by angles (F,) about unit axes (F, 3), quaternions (F, 4)."""
    return np.concatenate((np.cos(0.5 * angle)[:, None], np.sin(0.5 * angle)[:, None] * axis), axis=1)


def _smallest_turn(start: FloatArray, stop: FloatArray) -> FloatArray:
    """Return the smallest rotations from directions to directions, shapes (F, 3), quaternions (F, 4)."""
    scale = rot.length(start) * rot.length(stop)
    q = np.concatenate(((scale + rot.dot(start, stop))[:, None], rot.cross(start, stop)), axis=1)
    length = np.linalg.norm(q, axis=1, keepdims=True)
    turn: FloatArray = np.where(length > 0.0, q / np.maximum(length, np.finfo(float).tiny), rot.IDENTITY)
    return turn
