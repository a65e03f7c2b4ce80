"""Feet put back by the legs alone, on the walk of data/ whose pelvis was moved."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import anatomy_of
from motionedit.core.body.contacts import find_plants, foot_plants
from motionedit.core.bvh import read_clip
from motionedit.core.motion import Motion
from motionedit.core.standing.legs import keep_feet, standing_feet
from motionedit.core.standing.two_bones import bent_to

WALK = Path(__file__).resolve().parents[4] / "data" / "walk.bvh"
UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def walk():
    motion = read_clip(WALK).motion
    anatomy = anatomy_of(motion)
    plants = foot_plants(find_plants(motion, kinematics.forward(motion), anatomy, up=UP, first=0))
    return motion, anatomy, plants


def moved(motion, shift):
    return Motion(motion.skeleton, motion.rotations, motion.translations + shift, motion.frame_time)


def jerk(motion):
    return np.sqrt(np.mean(np.diff(kinematics.forward(motion).positions, 3, axis=0) ** 2))


@pytest.mark.parametrize("shift", [(3.0, -1.0, 2.0), (0.0, 4.0, 0.0), (-6.0, 0.0, 0.0)])
def test_planted_feet_stand_where_they_stood_and_the_rest_keeps_its_turns(walk, shift):
    motion, anatomy, plants = walk
    feet = standing_feet(motion, anatomy.legs, plants)
    kept = keep_feet(moved(motion, np.array(shift)), motion, feet, up=UP, travel=0, places="keep")
    before, after = kinematics.forward(motion), kinematics.forward(kept.motion)
    for foot in feet:
        for start, stop in foot.intervals:
            off = after.positions[start : stop + 1, foot.leg.ankle] - before.positions[start : stop + 1, foot.leg.ankle]
            assert np.linalg.norm(off, axis=1).max() < 0.5
    legs = [j for leg in anatomy.legs for j in (leg.thigh, leg.knee, leg.ankle)]
    others = np.setdiff1d(np.arange(len(motion.skeleton)), legs)
    np.testing.assert_array_equal(kept.motion.rotations[:, others], motion.rotations[:, others])
    assert not kept.touched[:, others].any()
    assert jerk(kept.motion) < 1.5 * jerk(motion)


def test_plants_that_move_as_wholes_go_where_the_edit_takes_them(walk):
    motion, anatomy, plants = walk
    shift = np.array([4.0, 0.0, -3.0])
    kept = keep_feet(
        moved(motion, shift), motion, standing_feet(motion, anatomy.legs, plants), up=UP, travel=0, places="move"
    )
    before, after = kinematics.forward(motion), kinematics.forward(kept.motion)
    np.testing.assert_allclose(after.positions, before.positions + shift, atol=1e-6)


def test_what_is_in_place_and_a_rest_pose_stay(walk):
    motion, anatomy, plants = walk
    feet = standing_feet(motion, anatomy.legs, plants)
    same = keep_feet(motion, motion, feet, up=UP, travel=0, places="keep")
    assert not same.moved.any()
    np.testing.assert_allclose(same.motion.rotations, motion.rotations, atol=1e-9)
    late = keep_feet(moved(motion, [3.0, 0.0, 0.0]), motion, feet, up=UP, travel=0, places="keep", first=20)
    np.testing.assert_array_equal(late.motion.rotations[:20], motion.rotations[:20])


def test_a_foot_with_a_goal_is_free_at_that_frame(walk):
    motion, anatomy, plants = walk
    leg = anatomy.legs[0]
    plant = next(p for p in plants if p.foot == "left")
    feet = standing_feet(motion, anatomy.legs, plants, fixed={(leg.ankle, plant.start)})
    assert (plant.start, plant.stop) not in feet[0].intervals
    assert feet[0].fixed == (plant.start,)


def test_two_bones_reach_their_target_or_stretch_towards_it():
    rng = np.random.default_rng(0)
    hip, knee = np.zeros((40, 3)), np.array([0.02, -0.4, 0.05]) + 0.02 * rng.normal(size=(40, 3))
    ankle = knee + np.array([0.0, -0.38, -0.12])
    thigh = np.tile(rot.IDENTITY, (40, 1))
    target = ankle + 0.1 * rng.normal(size=(40, 3)) + np.array([0.0, 0.1, 0.0])
    shank, whole = bent_to(hip, knee, ankle, target, thigh, soft=np.full(40, 1e-3))
    reached = rot.rotate(whole, knee + rot.rotate(shank, ankle - knee))
    near = np.linalg.norm(target, axis=1) < 0.97 * (np.linalg.norm(knee, axis=1) + np.linalg.norm(ankle - knee, axis=1))
    assert near.any()
    np.testing.assert_allclose(reached[near], target[near], atol=1e-9)
    far = bent_to(hip, knee, ankle, 3.0 * target, thigh, soft=np.full(40, 1e-3))
    stretched = rot.rotate(far[1], knee + rot.rotate(far[0], ankle - knee))
    assert np.linalg.norm(np.cross(stretched, target), axis=1).max() < 1e-9


def test_a_knee_that_a_capture_has_past_straight_for_a_while_bends_forward_all_along():
    frames = 40
    # The shank's turn about +x: forward is positive, and frames in the middle are past straight.
    bend = np.radians(8.0) * np.cos(np.linspace(0.0, 2.0 * np.pi, frames))
    hip = np.zeros((frames, 3))
    knee = np.tile([0.0, -0.4, 0.0], (frames, 1))
    ankle = knee + 0.4 * np.stack((np.zeros(frames), -np.cos(bend), -np.sin(bend)), axis=1)
    thigh = np.tile(rot.IDENTITY, (frames, 1))
    target = ankle + np.array([0.0, 0.02, 0.0])
    bend[:4] = bend[-4:] = np.radians(20.0)  # where the knee's own side is plain
    ankle = knee + 0.4 * np.stack((np.zeros(frames), -np.cos(bend), -np.sin(bend)), axis=1)
    shank, whole = bent_to(hip, knee, ankle, target, thigh, soft=np.full(frames, 0.006))
    place = rot.rotate(whole, knee)
    assert place[:, 2].min() > 0.0
    assert np.linalg.norm(np.diff(place[4:-4], axis=0), axis=1).max() < 0.01
    reached = place + rot.rotate(whole, rot.rotate(shank, ankle - knee))
    np.testing.assert_allclose(reached, target, atol=1e-3)


def test_a_leg_that_an_edit_straightens_does_not_kick_its_knee_sideways():
    frames = 40
    # For a while the leg is nearly straight, and what is left of its bend turns aside by a right angle.
    stretched = np.exp(-0.5 * ((np.arange(frames) - 20.0) / 4.0) ** 2)
    bend, aside = np.radians(40.0 - 34.0 * stretched), np.radians(90.0) * stretched
    hip, knee = np.zeros((frames, 3)), np.tile([0.0, -0.4, 0.0], (frames, 1))
    across = np.sin(bend)[:, None] * np.stack((np.sin(aside), np.zeros(frames), -np.cos(aside)), axis=1)
    ankle = knee + 0.4 * (across - np.cos(bend)[:, None] * np.array([0.0, 1.0, 0.0]))
    target = np.tile([0.0, -0.7, -0.1], (frames, 1))
    thigh = np.tile(rot.IDENTITY, (frames, 1))
    _, whole = bent_to(hip, knee, ankle, target, thigh, soft=np.full(frames, 0.006))
    place = rot.rotate(whole, knee)
    assert np.linalg.norm(np.diff(place, axis=0), axis=1).max() < 0.025  # metres a frame; 0.4 m is the thigh
    assert np.abs(place[:, 0]).max() < 0.12
