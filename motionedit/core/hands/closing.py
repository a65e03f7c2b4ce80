"""Hands brought together again after an edit, by the arms alone, as they were on the one thing that they hold."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto, turns_freely
from motionedit.core.feet.reach import stretch
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.smooth import smooth_share
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy, Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.feet.knees import Knee
    from motionedit.core.kinematics import WorldPoses

_FADE = 0.3  # seconds: about a frame with a goal for one hand the other goes all the way
# Of an arm's length: a straight arm gives way by so much of what one does that is bent as far as an arm can be.
_LEAST_SLACK = 1e-3
_EASE = 0.2  # seconds before and after a grip in which hands come together and part
# Metres at leg length 0.85 m by which an edit takes hands apart: up to the first they are brought together again,
# beyond the second arms would be thrown about for it.
_BROUGHT, _LEFT = 0.35, 0.55
# Of an arm: so near to its full length it does not go all the way, for there a millimetre is a centimetre at the elbow.
_STRAIGHT = 0.01
_TINY = float(np.finfo(float).tiny)  # what is divided by in place of 0
_ROUNDING = 1e-12  # of quaternions: an arm that is turned by no more stays as it is, to the bit


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a hand is and how it is turned: `place` (F, 3), `turn` (F, 4)."""

    place: FloatArray
    turn: FloatArray

    def of(self, other: Pose) -> Pose:
        """Return another pose as this one sees it."""
        return Pose(rot.unrotate(self.turn, other.place - self.place), rot.between(self.turn, other.turn))

    def to(self, seen: Pose) -> Pose:
        """Return the pose of what this one sees so."""
        return Pose(self.place + rot.rotate(self.turn, seen.place), rot.multiply(self.turn, seen.turn))

    def towards(self, other: Pose, share: FloatArray) -> Pose:
        """Return the pose a share, shape (F,), of the way to another."""
        part = share[:, None]
        turn = rot.multiply(self.turn, rot.exp(part * rot.log(rot.between(self.turn, other.turn))))
        return Pose(self.place + part * (other.place - self.place), turn)


@dataclass(frozen=True, eq=False)
class Closed:
    """The motion with its hands together; the joints `touched`, (F, J), and how far hands are still `off`, (F,)."""

    motion: Motion
    touched: BoolArray
    off: FloatArray


def close_grips(
    edited: Motion,
    before: WorldPoses,
    grips: Sequence[tuple[int, int]],
    anatomy: Anatomy,
    bends: Sequence[Bend],
    *,
    goals: tuple[Collection[int], Collection[int]],
    left_alone: Collection[int] = (),
) -> Closed:
    """Return an edited motion whose hands are as far apart, and turned so, as the input's, wherever they grip.

    The arm that the input has bent further gives way the more, for a straight one leads a swing and has no choice;
    near a frame with a goal for one hand the other one does, and everywhere where one arm cannot be turned freely.
    Of an arm that is too short the hand stays behind, and the arm nearly straight; hands that an edit takes far
    apart stay so.

    Parameters
    ----------
    edited, before
        The motion, and the input's world transforms; clip units.
    grips : sequence of (first, last)
        By `find_grips` of the input.
    bends : sequence of Bend
        Those of the elbows among them.
    goals : (frames, frames)
        Where the left hand, and the right one, is meant to be where the edit put it.
    left_alone : collection of int
        Joints that stay as the edit has them; an arm with one of them is not turned.
    """
    axes = {bend.joint: bend for bend in bends}
    arms = [arm.as_leg for arm in anatomy.arms or ()]
    turned = [arm.knee in axes and turns_freely(edited.skeleton, arm, left_alone=left_alone) for arm in arms]
    now = forward(edited)
    theirs = [_pose_of(before, arm.ankle) for arm in arms]
    mine = [_pose_of(now, arm.ankle) for arm in arms]
    seen = theirs[1].of(theirs[0])
    free = [
        (1.0 - _nearness(frames, len(edited), edited.frame_time)) * float(each)
        for frames, each in zip(goals, turned, strict=True)
    ]
    left, right = (each * _slack(before, arm) for each, arm in zip(free, arms, strict=True))
    together = mine[0].towards(mine[1].to(seen), left / np.maximum(left + right, _TINY))
    wanted = [together, together.to(theirs[0].of(theirs[1]))]
    gap = rot.length(mine[1].of(mine[0]).place - seen.place) * (STANDARD_LEG / anatomy.leg_length)
    share = _brought(grips, gap, edited.frame_time) * (1.0 - (1.0 - free[0]) * (1.0 - free[1]))
    onto = []
    for arm, own, other in itertools.compress(zip(arms, mine, wanted, strict=True), turned):
        knee, pose = knee_of(edited.skeleton, now, arm, axes[arm.knee]), own.towards(other, share)
        shoulder = now.positions[:, arm.thigh]
        onto.append(LegGoal(arm, knee, _within_reach(knee, shoulder, own.place, pose.place), pose.turn))
    closed = legs_onto(edited, now, onto)
    touched = np.abs(closed.rotations - edited.rotations).max(axis=-1) > _ROUNDING
    touched &= (share > 0.0)[:, None]
    rotations = np.where(touched[..., None], closed.rotations, edited.rotations)
    motion = Motion(edited.skeleton, frozen(rotations), edited.translations, edited.frame_time)
    after = forward(motion)
    hands = [_pose_of(after, arm.ankle) for arm in arms]
    off = np.zeros(len(edited))
    for start, stop in grips:
        span = slice(start, stop + 1)
        off[span] = rot.length(hands[1].of(hands[0]).place - seen.place)[span]
    return Closed(motion, touched, off)


def _slack(poses: WorldPoses, arm: Leg) -> FloatArray:
    """Return how far an arm is from straight, a share of its length, shape (F,); never 0."""
    way, length = stretch(poses, arm)
    slack: FloatArray = np.maximum(1.0 - way / np.maximum(length, _TINY), _LEAST_SLACK)
    return slack


def _pose_of(poses: WorldPoses, joint: int) -> Pose:
    return Pose(poses.positions[:, joint], poses.rotations[:, joint])


def _nearness(frames: Collection[int], count: int, frame_time: float) -> FloatArray:
    """Return how near each frame is to one of some, shape (count,): 1 there, and nothing a second away."""
    if not frames:
        return np.zeros(count)
    apart = np.abs(np.arange(count)[:, None] - np.array(sorted(frames))).min(axis=1)
    nearness: FloatArray = np.exp(-0.5 * (apart * (frame_time / _FADE)) ** 2)
    return nearness


def _brought(grips: Sequence[tuple[int, int]], gap: FloatArray, frame_time: float) -> FloatArray:
    """Return how far hands are brought together, shape (F,): one share in a grip, by its widest gap; 0 far from all."""
    frames = np.arange(len(gap))
    brought = np.zeros(len(gap))
    for start, stop in grips:
        most = smooth_share(gap[start : stop + 1].max(), _LEFT, _BROUGHT)
        outside = np.maximum(np.maximum(start - frames, frames - stop), 0)
        brought = np.maximum(brought, most * smooth_share(outside * (frame_time / _EASE), 1.0, 0.0))
    return brought


def _within_reach(knee: Knee, shoulder: FloatArray, own: FloatArray, place: FloatArray) -> FloatArray:
    """Return places (F, 3) as far from the shoulder as the arm goes: the last of the way to straight eases."""
    longest = np.maximum(knee.way(np.zeros(len(own))), _TINY)
    way, before = rot.length(place - shoulder), rot.length(own - shoulder)
    reached = before + longest * (_eased(way / longest) - _eased(before / longest))
    share = np.minimum(reached, longest) / np.maximum(way, _TINY)
    return shoulder + share[:, None] * (place - shoulder)


def _eased(share: FloatArray) -> FloatArray:
    """Return shares of a length that come to 1 by a parabola, from 1 - m at 1 - m to 1 at 1 + m, m the margin."""
    beyond = np.clip(share - (1.0 - _STRAIGHT), 0.0, 2.0 * _STRAIGHT)
    eased: FloatArray = np.minimum(share, 1.0 + _STRAIGHT) - beyond**2 / (4.0 * _STRAIGHT)
    return eased
