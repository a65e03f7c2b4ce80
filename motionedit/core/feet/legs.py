"""Legs alone, solved exactly: the hip turns, the knee bends about its axis, the ankle turns; nothing else moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

# A knee that is bent back goes on doing so up to so many times as far; then it bends forward.
_BACK = 1.25


def turns_freely(skeleton: Skeleton, leg: Leg) -> bool:
    """Return whether hip, knee and ankle have three rotation channels each, so that a leg is solved exactly."""
    return all(len(set(skeleton.rotation_axes[joint])) == 3 for joint in (leg.thigh, leg.knee, leg.ankle))


def legs_onto(
    motion: Motion,
    poses: WorldPoses,
    goals: Sequence[tuple[Leg, Bend, FloatArray, FloatArray]],
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
    goals
        Leg, its knee's bend, the ankle's places (F, 3) and turns (F, 4) in the world.
    shift : shape (F, 3), optional
        How far the hips were shifted since `poses` were taken.
    """
    rotations = motion.rotations.copy()
    parents = motion.skeleton.parents
    for leg, bend, places, turns in goals:
        hip, knee, ankle = (poses.positions[:, j] for j in (leg.thigh, leg.knee, leg.ankle))
        wanted = places - hip - (0.0 if shift is None else shift)
        upper, lower = knee - hip, ankle - knee
        axis = rot.rotate(poses.rotations[:, parents[leg.knee]], np.broadcast_to(bend.axis, upper.shape))
        flexion = _axis_turn(axis, _flexion(upper, lower, axis, np.linalg.norm(wanted, axis=1)))
        swing = _smallest_turn(upper + rot.rotate(flexion, lower), wanted)
        above = {j: poses.rotations[:, parents[j]] for j in (leg.thigh, leg.knee, leg.ankle)}
        world = rot.multiply(swing, poses.rotations[:, leg.thigh])
        rotations[:, leg.thigh] = rot.multiply(rot.conjugate(above[leg.thigh]), world)
        bent = rot.multiply(flexion, poses.rotations[:, leg.knee])
        rotations[:, leg.knee] = rot.multiply(rot.conjugate(above[leg.knee]), bent)
        below = rot.multiply(rot.multiply(swing, flexion), above[leg.ankle])
        rotations[:, leg.ankle] = rot.multiply(rot.conjugate(below), turns)
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


def _flexion(upper: FloatArray, lower: FloatArray, axis: FloatArray, length: FloatArray) -> FloatArray:
    """Return the angle about a knee's axis that makes |upper + turned lower| a length, shape (F,), rad.

    u . R v = (u . a)(v . a) + C cos x + S sin x, so that x = atan2(S, C) +- acos((k - (u . a)(v . a)) / |C, S|). It
    bends forward; one that is bent back stays so as far as it is. Beyond the leg's length it is straight.
    """
    along = np.sum(upper * axis, axis=1) * np.sum(lower * axis, axis=1)
    dot = np.sum(upper * lower, axis=1)
    cosine, sine = dot - along, np.sum(upper * rot.cross(axis, lower), axis=1)
    squares = np.sum(upper**2, axis=1) + np.sum(lower**2, axis=1)
    wanted = 0.5 * (length**2 - squares) - along
    share = np.clip(wanted / np.maximum(np.hypot(cosine, sine), np.finfo(float).tiny), -1.0, 1.0)
    straight = np.arctan2(sine, cosine)
    bend = np.arccos(share)
    angle: FloatArray = straight + np.where(bend < _BACK * straight, -1.0, 1.0) * bend
    return angle


def _axis_turn(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the rotations by angles (F,) about unit axes (F, 3), quaternions (F, 4)."""
    return np.concatenate((np.cos(0.5 * angle)[:, None], np.sin(0.5 * angle)[:, None] * axis), axis=1)


def _smallest_turn(start: FloatArray, stop: FloatArray) -> FloatArray:
    """Return the smallest rotations from directions to directions, shapes (F, 3), quaternions (F, 4)."""
    scale = np.linalg.norm(start, axis=1) * np.linalg.norm(stop, axis=1)
    q = np.concatenate(((scale + np.sum(start * stop, axis=1))[:, None], rot.cross(start, stop)), axis=1)
    length = np.linalg.norm(q, axis=1, keepdims=True)
    turn: FloatArray = np.where(length > 0.0, q / np.maximum(length, np.finfo(float).tiny), rot.IDENTITY)
    return turn
