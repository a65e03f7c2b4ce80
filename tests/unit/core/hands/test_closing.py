"""Hands together again after one arm was moved: a golf swing whose right shoulder is turned."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import read_clip
from motionedit.core.hands.closing import close_grips
from motionedit.core.motion import Motion
from motionedit.dataclass import replace

SWING = Path(__file__).resolve().parents[4] / "data" / "golf" / "swing04.bvh"
HIT = 85


class Swing:
    def __init__(self):
        self.motion = read_clip(SWING).motion
        self.anatomy = anatomy_of(self.motion)
        self.poses = kinematics.forward(self.motion)
        self.bends = find_bends(self.motion.skeleton, self.poses, self.anatomy, first=0)
        self.left, self.right = self.anatomy.arms

    def turned(self, degrees, arm=None, frames=slice(None)):
        """Return the swing with a shoulder turned about its own axis y, as much in all frames."""
        rotations = self.motion.rotations.copy()
        turn = rot.exp(np.radians([0.0, degrees, 0.0]))
        joint = (arm or self.right).shoulder
        rotations[frames, joint] = rot.multiply(rotations[frames, joint], turn)
        return Motion(self.motion.skeleton, rotations, self.motion.translations, self.motion.frame_time)

    def close(self, edited, *, grips=((0, 120),), goals=((), ()), left_alone=()):
        given = self.poses, grips, self.anatomy, self.bends
        return close_grips(edited, *given, goals=goals, left_alone=left_alone)

    def seen(self, motion):
        """Return where the right hand is in the left hand's frame, and how it is turned."""
        poses = kinematics.forward(motion)
        left, right = self.left.wrist, self.right.wrist
        place = rot.unrotate(poses.rotations[:, left], poses.positions[:, right] - poses.positions[:, left])
        return place, rot.between(poses.rotations[:, left], poses.rotations[:, right])


@pytest.fixture(scope="module")
def swing():
    return Swing()


def joints_of(arm):
    return {arm.shoulder, arm.elbow, arm.wrist}


@pytest.mark.parametrize("arm", ["left", "right"])
def test_hands_are_as_they_were_and_nothing_but_the_arms_is_turned(swing, arm):
    edited = swing.turned(6.0, getattr(swing, arm))
    place, turn = swing.seen(swing.motion)
    assert np.linalg.norm(swing.seen(edited)[0] - place, axis=1).mean() > 2.0
    closed = swing.close(edited)
    now, turned = swing.seen(closed.motion)
    assert np.linalg.norm(now - place, axis=1).max() < 0.3  # cm, where an arm is straight
    assert np.median(np.linalg.norm(now - place, axis=1)) < 1e-6
    assert np.degrees(rot.angle_between(turned, turn)).max() < 1e-5
    assert closed.off == pytest.approx(np.linalg.norm(now - place, axis=1), abs=1e-9)
    others = [j for j in range(len(edited.skeleton)) if j not in joints_of(swing.left) | joints_of(swing.right)]
    assert np.array_equal(closed.motion.rotations[:, others], edited.rotations[:, others])
    assert not closed.touched[:, others].any()


def test_a_hand_with_a_goal_stays_where_the_edit_put_it_and_elsewhere_the_bent_arm_gives_way(swing):
    edited = swing.turned(6.0)
    before = kinematics.forward(edited)
    for goals, kept, gives in ((([], [HIT]), swing.right, swing.left), (([HIT], []), swing.left, swing.right)):
        after = kinematics.forward(swing.close(edited, goals=goals).motion)
        moved = np.linalg.norm(after.positions - before.positions, axis=2)
        assert moved[HIT, kept.wrist] < 1e-9
        assert moved[HIT, gives.wrist] > 1.0
        # Far from it the left arm, which is straight, leads.
        assert moved[20, swing.right.wrist] > 2.0 * moved[20, swing.left.wrist] > 0.0
    both = swing.close(edited, goals=([HIT], [HIT]))
    assert np.array_equal(both.motion.rotations[HIT], edited.rotations[HIT])
    assert both.off[HIT] > 2.0


def test_the_hand_without_a_goal_goes_all_the_way_at_it_and_its_share_fades_within_a_second(swing):
    edited = swing.turned(6.0)
    before = kinematics.forward(edited)
    far, near = (
        kinematics.forward(swing.close(edited, goals=([], frames)).motion).positions[:, swing.right.wrist]
        for frames in ([], [HIT])
    )
    alone = np.linalg.norm(far - before.positions[:, swing.right.wrist], axis=1)
    share = np.linalg.norm(near - before.positions[:, swing.right.wrist], axis=1) / alone
    assert share[HIT] < 1e-9
    assert (np.diff(share[HIT : HIT + 15]) > -1e-3).all()
    assert 0.1 < share[HIT + 5] < 0.8  # 0.2 s
    assert share[HIT + 25] == pytest.approx(1.0, abs=0.02)
    assert share[HIT - 25] == pytest.approx(1.0, abs=0.02)


def test_an_arm_comes_to_straight_gently(swing):
    # Of a right arm that is led further and further away the elbow's angle goes down without a corner.
    rotations = np.repeat(swing.motion.rotations[:1], 61, axis=0)
    translations = np.repeat(swing.motion.translations[:1], 61, axis=0)
    still = Motion(swing.motion.skeleton, rotations, translations, 0.04)
    turned = rotations.copy()
    turns = rot.exp(np.radians(np.linspace(0.0, -20.0, 61))[:, None] * [1.0, 0.0, 0.0])
    turned[:, swing.left.shoulder] = rot.multiply(turned[:, swing.left.shoulder], turns)
    edited = Motion(still.skeleton, turned, translations, 0.04)
    poses = kinematics.forward(still)
    bends = find_bends(still.skeleton, poses, swing.anatomy, first=0)
    goals = (list(range(61)), [])
    closed = close_grips(edited, poses, ((0, 60),), swing.anatomy, bends, goals=goals)
    after = kinematics.forward(closed.motion)
    shoulder, elbow, wrist = (
        after.positions[:, j] for j in (swing.right.shoulder, swing.right.elbow, swing.right.wrist)
    )
    length = np.linalg.norm(elbow - shoulder, axis=1) + np.linalg.norm(wrist - elbow, axis=1)
    way = np.linalg.norm(wrist - shoulder, axis=1) / length
    assert way.max() <= 1.0 + 1e-9
    assert closed.off[-1] > 1.0  # it does not reach
    upper, lower = elbow - shoulder, wrist - elbow
    cosine = np.sum(upper * lower, axis=1) / (np.linalg.norm(upper, axis=1) * np.linalg.norm(lower, axis=1))
    bent = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    assert bent[0] > 15.0
    assert bent[-1] < 5.0
    assert np.abs(np.diff(bent, 2)).max() < 1.5


def test_beside_a_grip_the_correction_eases_and_ends(swing):
    edited = swing.turned(6.0)
    closed = swing.close(edited, grips=((40, 80),))
    assert closed.touched[40:81].any(axis=1).all()
    assert not closed.touched[:35].any()
    assert not closed.touched[86:].any()
    steps = np.degrees(rot.angle_between(closed.motion.rotations, edited.rotations))[:, swing.right.shoulder]
    assert 0.0 < steps[38] < steps[40]
    assert not closed.off[:40].any()


def test_an_edit_that_leaves_the_grip_alone_is_left_alone(swing):
    closed = swing.close(swing.motion)
    assert not closed.touched.any()
    assert np.array_equal(closed.motion.rotations, swing.motion.rotations)


def test_hands_that_are_taken_far_apart_stay_so(swing):
    edited = swing.turned(120.0)
    closed = swing.close(edited)
    assert closed.off.max() > 55.0
    assert np.array_equal(closed.motion.rotations, edited.rotations)


def test_a_smooth_edit_stays_smooth(swing):
    def jerk(motion):
        return np.sqrt(np.mean(np.diff(kinematics.forward(motion).positions, 3, axis=0) ** 2))

    closed = swing.close(swing.turned(6.0), goals=([], [HIT]))
    assert jerk(closed.motion) < 1.2 * jerk(swing.motion)


def test_of_arms_one_of_which_does_not_turn_freely_the_other_goes_all_the_way(swing):
    edited = swing.turned(6.0)
    channels = list(edited.skeleton.channels)
    channels[swing.right.elbow] = channels[swing.right.elbow][:1]
    bound = Motion(
        replace(edited.skeleton, channels=tuple(channels)), edited.rotations, edited.translations, edited.frame_time
    )
    closed = close_grips(bound, swing.poses, ((0, 120),), swing.anatomy, swing.bends, goals=((), ()))
    assert set(np.flatnonzero(closed.touched.any(axis=0)).tolist()) == joints_of(swing.left)
    assert closed.off.max() < 0.5


def test_arms_with_joints_that_are_left_alone_are_not_turned_and_how_far_hands_are_apart_is_told(swing):
    edited = swing.turned(6.0)
    for joint in joints_of(swing.left):
        alone = swing.close(edited, left_alone=[joint])
        assert set(np.flatnonzero(alone.touched.any(axis=0)).tolist()) <= joints_of(swing.right)
        assert alone.off.max() < 0.5
    both = swing.close(edited, left_alone=[swing.left.wrist, swing.right.shoulder])
    assert both.motion.rotations.tobytes() == edited.rotations.tobytes()
    place, own = swing.seen(edited)[0], swing.seen(swing.motion)[0]
    np.testing.assert_allclose(both.off.max(), np.linalg.norm(place - own, axis=1).max(), rtol=0.2)
    assert both.off.max() > 3.0


def test_arms_without_length_stay_where_they_are(swing):
    offsets = swing.motion.skeleton.offsets.copy()
    for arm in (swing.left, swing.right):
        offsets[[arm.elbow, arm.wrist]] = 0.0
    skeleton = replace(swing.motion.skeleton, offsets=offsets)
    short, edited = (
        Motion(skeleton, m.rotations, m.translations, m.frame_time) for m in (swing.motion, swing.turned(6.0))
    )
    with np.errstate(all="raise", under="ignore"):
        closed = close_grips(edited, kinematics.forward(short), ((0, 120),), swing.anatomy, swing.bends, goals=((), ()))
    assert np.isfinite(closed.motion.rotations).all()
