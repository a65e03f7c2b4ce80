"""Feet put back by the legs alone, on the walk of data/ whose pelvis was moved."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.contacts import foot_plants, plants_of, sole_tracks
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import read_clip
from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.put_back import Fixed, StandingFoot, carried, put_back, standing_feet
from motionedit.core.motion import Motion

WALK = Path(__file__).resolve().parents[4] / "data" / "walk.bvh"
UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def walk():
    motion = read_clip(WALK).motion
    anatomy = anatomy_of(motion)
    tracks = sole_tracks(kinematics.forward(motion), anatomy)
    plants = foot_plants(plants_of(tracks, anatomy, up=UP, first=0, frame_time=motion.frame_time))
    return motion, anatomy, plants


def moved(motion, shift):
    return Motion(motion.skeleton, motion.rotations, motion.translations + shift, motion.frame_time)


def jerk(motion):
    return np.sqrt(np.mean(np.diff(kinematics.forward(motion).positions, 3, axis=0) ** 2))


@pytest.mark.parametrize("shift", [(3.0, -1.0, 2.0), (0.0, 4.0, 0.0), (-6.0, 0.0, 0.0)])
def test_planted_feet_stand_where_they_stood_and_the_rest_keeps_its_turns(walk, shift):
    motion, anatomy, plants = walk
    feet = standing_feet(motion, anatomy, plants)
    kept = put_back(moved(motion, np.array(shift)), motion, feet, anatomy, up=UP, travel=0)
    before, after = kinematics.forward(motion), kinematics.forward(kept.motion)
    for foot in feet:
        ankle = foot.foot.leg.ankle
        for start, stop in foot.intervals:
            off = after.positions[start : stop + 1, ankle] - before.positions[start : stop + 1, ankle]
            assert np.linalg.norm(off, axis=1).max() < 0.5
    legs = [j for leg in anatomy.legs for j in (leg.thigh, leg.knee, leg.ankle)]
    others = np.setdiff1d(np.arange(len(motion.skeleton)), legs)
    np.testing.assert_array_equal(kept.motion.rotations[:, others], motion.rotations[:, others])
    assert not kept.touched[:, others].any()
    assert jerk(kept.motion) < 1.5 * jerk(motion)


def test_plants_that_move_as_wholes_go_where_the_edit_takes_them(walk):
    motion, anatomy, plants = walk
    shift = np.array([4.0, 0.0, -3.0])
    edited = moved(motion, shift)
    feet = carried(standing_feet(motion, anatomy, plants), edited, motion, anatomy, up=UP)
    kept = put_back(edited, motion, feet, anatomy, up=UP, travel=0)
    before, after = kinematics.forward(motion), kinematics.forward(kept.motion)
    np.testing.assert_allclose(after.positions, before.positions + shift, atol=1e-6)


def test_plants_that_are_near_in_time_and_place_move_alike_and_steps_by_themselves(walk):
    motion, anatomy, _ = walk
    still = Motion(
        motion.skeleton,
        np.repeat(motion.rotations[:1], len(motion), axis=0),
        np.repeat(motion.translations[:1], len(motion), axis=0),
        motion.frame_time,
    )
    # The body sways away in the second half of a clip in which it stands.
    aside = np.zeros((len(motion), 1, 3))
    aside[len(motion) // 2 :, :, 0] = 6.0
    left, right = (each.foot for each in standing_feet(motion, anatomy, ()))
    early, late, both = (0, 60), (64, 120), (0, 120)

    def ways(reference, *feet):
        found = carried(feet, moved(reference, aside), reference, anatomy, up=UP)
        return [way[0] for each in found for way in each.ways]

    again = ways(still, StandingFoot(left, (early, late)))
    assert abs(again[1] - again[0]) < 0.5
    beside = ways(still, StandingFoot(left, (both,)), StandingFoot(right, (late,)))
    assert 0.0 < beside[1] - beside[0] < 0.75 * 3.0
    fixed = ways(still, StandingFoot(left, (early, late), (Fixed(left.leg.ankle, 30),)))
    assert fixed[1] == pytest.approx(aside[64:121, 0, 0].mean())
    steps = ways(motion, *standing_feet(motion, anatomy, walk[2]))
    assert max(steps) - min(steps) > 5.0


def test_what_is_in_place_and_a_rest_pose_stay(walk):
    motion, anatomy, plants = walk
    feet = standing_feet(motion, anatomy, plants)
    same = put_back(motion, motion, feet, anatomy, up=UP, travel=0)
    assert not same.moved.any()
    np.testing.assert_allclose(same.motion.rotations, motion.rotations, atol=1e-9)
    late = put_back(moved(motion, [3.0, 0.0, 0.0]), motion, feet, anatomy, up=UP, travel=0, first=20)
    np.testing.assert_array_equal(late.motion.rotations[:20], motion.rotations[:20])


def long_plant(walk, foot):
    motion, _, plants = walk
    least = 0.4 / motion.frame_time
    return next(p for p in plants if p.foot == foot and p.stop - p.start > least)


def test_a_plant_is_left_alone_near_whose_ends_its_foot_is_fixed_and_one_of_a_knee_or_of_several_frames(walk):
    motion, anatomy, plants = walk
    leg, plant = anatomy.legs[0], long_plant(walk, "left")
    middle = (plant.start + plant.stop) // 2
    for fixed in (
        [Fixed(leg.ankle, plant.start)],
        [Fixed(leg.ankle, plant.stop + 2)],
        [Fixed(leg.knee, middle)],
        [Fixed(leg.ankle, middle), Fixed(leg.ankle, middle + 1)],
    ):
        left, right = standing_feet(motion, anatomy, plants, fixed=fixed)
        assert (plant.start, plant.stop) not in left.intervals
        assert left.fixed == tuple(fixed)
        assert right.fixed == ()


def test_a_foot_that_is_lifted_stands_before_and_after_and_not_then(walk):
    motion, anatomy, plants = walk
    leg, plant = anatomy.legs[0], long_plant(walk, "left")
    at, away = (plant.start + plant.stop) // 2, round(0.25 / motion.frame_time)
    (lifted, _), (whole, _) = (
        standing_feet(motion, anatomy, plants, fixed=[Fixed(leg.ankle, at, lifted=each)]) for each in (True, False)
    )
    parts = {(plant.start, at - away - 1), (at + away + 1, plant.stop)}
    assert set(whole.intervals) - set(lifted.intervals) == {(plant.start, plant.stop)}
    assert set(lifted.intervals) - set(whole.intervals) == parts
    translations = motion.translations.copy()
    translations[at, 0] += [0.0, 4.0, 0.0]
    edited = Motion(motion.skeleton, motion.rotations, translations, motion.frame_time)
    after = kinematics.forward(put_back(edited, motion, [lifted], anatomy, up=UP, travel=0).motion)
    up = (after.positions - kinematics.forward(motion).positions)[:, leg.ankle, 1]
    assert up[at] == pytest.approx(4.0, abs=1e-6)
    for start, stop in parts:
        assert np.abs(up[start : stop + 1]).max() < 0.5


def test_a_leg_with_a_joint_that_is_left_alone_is_not_put_back(walk):
    motion, anatomy, plants = walk
    left, right = anatomy.legs
    for joint in (left.thigh, left.knee, left.ankle):
        (only,) = standing_feet(motion, anatomy, plants, left_alone=[joint])
        assert only.foot.leg == right


def test_a_plant_goes_as_a_whole_to_where_its_foot_is_fixed_and_turns_if_that_is(walk):
    motion, anatomy, plants = walk
    leg, plant = anatomy.legs[0], long_plant(walk, "left")
    middle, span = (plant.start + plant.stop) // 2, slice(plant.start, plant.stop + 1)
    rotations = motion.rotations.copy()
    rotations[middle, 0] = rot.multiply(rot.exp(np.array([0.0, 0.1, 0.0])), rotations[middle, 0])
    translations = motion.translations.copy()
    translations[middle] += [2.0, 0.0, 1.0]
    edited = Motion(motion.skeleton, rotations, translations, motion.frame_time)
    before, there = kinematics.forward(motion), kinematics.forward(edited)
    for turned in (False, True):
        fixed = [Fixed(leg.ankle, middle, turned)]
        feet = standing_feet(motion, anatomy, plants, fixed=fixed)
        after = kinematics.forward(put_back(edited, motion, feet, anatomy, up=UP, travel=0).motion)
        np.testing.assert_allclose(after.positions[middle, leg.ankle], there.positions[middle, leg.ankle], atol=1e-3)
        own, now = ((each.positions[span, leg.ankle], each.rotations[span, leg.ankle]) for each in (before, after))
        turn = rot.multiply(there.rotations[middle, leg.ankle], rot.conjugate(before.rotations[middle, leg.ankle]))
        turn = turn if turned else rot.IDENTITY
        at = there.positions[middle, leg.ankle] + rot.rotate(turn, own[0] - before.positions[middle, leg.ankle])
        np.testing.assert_allclose(now[0], at, atol=0.5)
        assert np.degrees(rot.angle_between(now[1], rot.multiply(turn, own[1]))).max() < 2.0


def test_a_knee_that_a_capture_has_past_straight_for_a_while_bends_forward_all_along(walk):
    motion, anatomy, plants = walk
    leg, poses = anatomy.legs[0], kinematics.forward(motion)
    bend = next(b for b in find_bends(motion.skeleton, poses, anatomy, first=0) if b.joint == leg.knee)
    plant = next(p for p in plants if p.foot == "left" and p.start > 20)
    # In the middle of the plant the knee is bent back, by up to 4 degrees.
    middle = np.arange(len(motion)) - 0.5 * (plant.start + plant.stop)
    angle = knee_of(motion.skeleton, poses, leg, bend).angle
    extra = (np.radians(-4.0) - angle) * np.exp(-0.5 * (middle / 3.0) ** 2)
    rotations = motion.rotations.copy()
    rotations[:, leg.knee] = rot.multiply(rot.exp(extra[:, None] * bend.axis), rotations[:, leg.knee])
    locked = Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)
    before = knee_of(motion.skeleton, kinematics.forward(locked), leg, bend).angle
    assert np.degrees(before.min()) == pytest.approx(-4.0, abs=0.5)
    kept = put_back(
        moved(locked, [0.0, 0.0, 1.0]),
        locked,
        standing_feet(locked, anatomy, plants),
        anatomy,
        up=UP,
        travel=0,
    )
    after = np.degrees(knee_of(motion.skeleton, kinematics.forward(kept.motion), leg, bend).angle)
    assert after[plant.start : plant.stop + 1].min() > 0.0
    assert np.abs(np.diff(after, 2)).max() < 2.0 * np.abs(np.diff(np.degrees(before), 2)).max()
