"""When feet stand: by speed and by what the point itself does around, on the floor, on stairs, on a box, on a slope."""

import numpy as np
import pytest
from human import ANKLE_HEIGHT, HIPS_HEIGHT, skeleton_of, standing
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from takes import clock, foot_path, footfalls, smooth, within

from motionedit.core.body.contacts import Plant, foot_plants, plants_of, sole_tracks
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ground import axis_vector
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

UP = axis_vector("y")
RATE = 100.0
BODY = find_anatomy(skeleton_of())
# As the docstring of plants_of has them, m/s.
ENTERS, LEAVES = 0.3, 0.45


def stands_of(path, *, rate=RATE, first=0, other=None):
    """Return when (s) a left heel stands that goes along a path (F, 3), metres, the right one along the `other`.

    The toes run away, and so does the other foot where it is not given.
    """
    away = 100.0 * np.arange(len(path))[:, None] * np.ones(3)
    tracks = np.stack((path, away, away if other is None else other, away), axis=1)
    plants = plants_of(tracks, BODY, up=UP, first=first, frame_time=1.0 / rate)
    assert all(plant.point in {0, 2} for plant in plants)
    return [(plant.start / rate, plant.stop / rate) for plant in plants if plant.point == 0]


def along(axis, way):
    """Return a path along one axis."""
    path = np.zeros((len(way), 3))
    path[:, axis] = way
    return path


def assert_spans(found, expected, *, within=0.03):
    assert len(found) == len(expected), (found, expected)
    if expected:
        assert np.abs(np.subtract(found, expected)).max() <= within, (found, expected)


def carried(height, *, frame_time=0.01, scale=1.0):
    """Return a body whose stiff legs are lifted by `height` (F,), m."""
    skeleton = skeleton_of(scale=scale)
    motion = standing(skeleton, frames=len(height), frame_time=frame_time)
    translations = np.zeros((len(height), 1, 3))
    translations[:, 0, 1] = scale * (HIPS_HEIGHT + np.asarray(height, dtype=float))
    return Motion(skeleton, motion.rotations, translations, frame_time)


def found_in(motion, first=0):
    return plants_among(motion, forward(motion), first)


def plants_among(motion, poses, first=0):
    anatomy = find_anatomy(motion.skeleton)
    return plants_of(sole_tracks(poses, anatomy), anatomy, up=UP, first=first, frame_time=motion.frame_time)


def test_feet_that_stand_are_planted_from_the_first_frame_to_the_last():
    plants = found_in(carried(np.zeros(30)))
    names = skeleton_of().names
    found = {(plant.foot, plant.part, names[plant.joint], plant.start, plant.stop, plant.frames) for plant in plants}
    assert found == {
        (side.lower(), part, side + joint, 0, 29, 30)
        for side in ("Left", "Right")
        for part, joint in (("heel", "Foot"), ("toe", "ToeBase"))
    }


def test_a_plants_point_is_its_place_among_the_sole_points_and_its_height_that_of_its_track():
    motion = carried(np.zeros(30), scale=100.0)
    anatomy = find_anatomy(motion.skeleton)
    tracks = sole_tracks(forward(motion), anatomy)
    for plant in found_in(motion):
        point = anatomy.sole_points[plant.point]
        assert (point.foot, point.part, point.joint) == (plant.foot, plant.part, plant.joint)
        assert plant.height == pytest.approx(np.median(tracks[:, plant.point, 1]))
    assert {round(plant.height, 6) for plant in found_in(motion)} == {100.0 * ANKLE_HEIGHT, 2.0}


@pytest.mark.parametrize("rate", [30.0, 60.0, 100.0, 240.0])
def test_a_point_leaves_at_a_speed(rate):
    # It gains 1 m/s each second from rest.
    t = clock(1.0, rate)
    for way in (0.5 * t**2, -0.5 * t**2):
        assert_spans(stands_of(along(2, way), rate=rate), [(0.0, LEAVES)], within=0.01 + 1.0 / rate)
        assert_spans(stands_of(along(2, way[::-1]), rate=rate), [(1.0 - LEAVES, 1.0)], within=0.01 + 1.0 / rate)


@pytest.mark.parametrize(("slowest", "stands"), [(0.97 * ENTERS, True), (1.03 * ENTERS, False)])
def test_a_point_stands_only_where_it_gets_slower_than_that(slowest, stands):
    t = clock(2.0, RATE) - 1.0
    way = slowest * t + 0.2 * np.sign(t) * t**2
    half = (LEAVES - slowest) / 0.4
    assert_spans(stands_of(along(0, way)), [(1.0 - half, 1.0 + half)] if stands else [])


@pytest.mark.parametrize("axis", [0, 2])
def test_a_point_that_slides_is_planted_up_to_a_speed(axis):
    t = clock(1.0, RATE)
    assert stands_of(along(axis, 0.97 * ENTERS * t)) == [(0.0, 1.0)]
    assert stands_of(along(axis, 1.03 * ENTERS * t)) == []


def test_a_heel_that_rises_slowly_stands_until_it_is_five_centimetres_high():
    t = clock(2.0, RATE)
    assert_spans(stands_of(along(1, 0.24 * np.maximum(t - 1.0, 0.0))), [(0.0, 1.0 + 0.05 / 0.24)])


@pytest.mark.parametrize("drift", [-0.15, -0.03, 0.03, 0.15])
def test_a_foot_that_stands_is_planted_however_far_its_height_drifts(drift):
    t = clock(5.0, RATE)
    assert stands_of(along(1, drift * t)) == [(0.0, 5.0)]


def slip(radius, speed, angle):
    """Return a point that stands for a second, goes along a part of a circle on the ground, and stands for another."""
    t = clock(3.0, RATE)
    turn = np.clip((t - 1.0) * speed / radius, 0.0, angle)
    return radius * np.stack((1.0 - np.cos(turn), np.zeros(len(t)), np.sin(turn)), axis=1)


def test_a_short_slip_that_stays_at_its_place_breaks_no_plant():
    assert len(stands_of(slip(0.012, 0.7, np.pi))) == 1  # 2.4 cm in 0.05 s
    assert len(stands_of(slip(0.012, 0.7, 2.0 * np.pi))) == 1  # there and back in 0.11 s


def test_a_slip_that_goes_farther_or_takes_longer_parts_two_plants():
    assert len(stands_of(slip(0.02, 1.0, np.pi))) == 2  # 4 cm in 0.06 s
    assert len(stands_of(slip(0.02, 1.5, 2.0 * np.pi))) == 2  # 4 cm there and back in 0.08 s
    assert len(stands_of(slip(0.012, 0.6, 3.0 * np.pi))) == 2  # 2.4 cm to and fro for 0.19 s


@pytest.mark.parametrize("rate", [100.0, 120.0, 240.0])
@pytest.mark.parametrize(("gain", "stands"), [(11.0, True), (24.0, False)])
def test_a_plant_lasts_a_twentieth_of_a_second_at_least(rate, gain, stands):
    # It stops and goes on, gaining so many m/s each second: slow for 0.08 or 0.04 s.
    t = clock(1.0, rate) - 0.5
    assert len(stands_of(along(2, 0.5 * gain * np.sign(t) * t**2), rate=rate)) == stands


@pytest.mark.parametrize("rate", [60.0, 100.0, 120.0, 240.0])
@pytest.mark.parametrize("stance", [0.1, 0.15])
def test_the_short_stances_of_a_run_are_found(rate, stance):
    stances = footfalls(3.0, speed=4.0, cycle=0.66, duty=stance / 0.66, first=0.3)
    path = foot_path(clock(3.0, rate), stances, lift=0.25)
    assert_spans(stands_of(path, rate=rate), within(stances, 3.0), within=0.04)


@pytest.mark.parametrize("rise", [-0.34, -0.17, 0.17, 0.34])
def test_every_stance_on_stairs_is_found_at_its_own_height(rise):
    stances = footfalls(6.0, speed=0.5, cycle=1.2, duty=0.6, first=0.4, rise=rise)
    path = foot_path(clock(6.0, RATE), stances, lift=0.2)
    assert_spans(stands_of(path), within(stances, 6.0), within=0.06)
    tracks = np.stack((path,) * 4, axis=1)
    heights = {round(plant.height, 3) for plant in plants_of(tracks, BODY, up=UP, first=0, frame_time=0.01)}
    assert heights == {round(place[1], 3) for on, off, place in stances if off > 0.0 and on < 6.0}


@pytest.mark.parametrize("height", [0.2, 0.45])
def test_a_foot_stands_on_a_box_that_it_steps_on_and_off(height):
    stances = [(0.0, 0.8, (0.0, 0.08, 0.0)), (1.3, 2.2, (0.0, 0.08 + height, 0.4)), (2.7, 3.5, (0.0, 0.08, 0.8))]
    path = foot_path(clock(3.5, RATE), stances, lift=0.25)
    assert_spans(stands_of(path), within(stances, 3.5), within=0.06)


@pytest.mark.parametrize("slope", [-15.0, -6.0, 6.0, 15.0])
def test_every_stance_on_a_slope_is_found(slope):
    # The clip begins and ends while the foot is in the air.
    stances = footfalls(4.6, speed=1.2, cycle=1.1, duty=0.62, first=0.3, rise=1.2 * 1.1 * np.tan(np.radians(slope)))
    path = foot_path(clock(4.6, RATE), stances)
    assert_spans(stands_of(path), within(stances, 4.6), within=0.06)


@given(st.floats(0.08, 0.8), st.floats(0.1, 0.35), st.floats(0.0, 1.5), st.sampled_from([30.0, 60.0, 120.0]))
@settings(max_examples=100)
def test_a_foot_that_is_held_in_the_air_after_a_kick_does_not_stand_there(height, rise, held, rate):
    assume(2.0 * height / rise > 0.6)  # m/s, its fastest
    t = clock(3.5, rate)
    lifted = height * (smooth(t, 0.5, 0.5 + rise) - smooth(t, 0.5 + rise + held, 0.5 + 2.0 * rise + held))
    spans = stands_of(along(1, lifted), rate=rate, other=np.zeros((len(t), 3)))
    assert all(lifted[round(middle * rate)] < 0.06 for middle in np.mean(spans, axis=1)), spans
    assert spans[0][0] == 0.0
    assert spans[-1][1] == t[-1]


@pytest.mark.parametrize("began", [0.0, 1.0])
def test_who_stands_on_a_box_with_both_feet_stands_there(began):
    # Down from it, and before that up onto it, where it does not begin there.
    t = clock(began + 3.5, RATE)
    lifted = 0.4 * ((smooth(t, 0.7, 0.9) if began else 1.0) - smooth(t, began + 1.5, began + 1.7))
    both = along(1, lifted)
    spans = stands_of(both, other=both)
    before = [(0.0, 0.7)] if began else []
    on_the_box = (0.9 if began else 0.0, began + 1.5)
    assert_spans(spans, [*before, on_the_box, (began + 1.7, t[-1])], within=0.08)


@given(st.floats(0.08, 0.8), st.sampled_from([30.0, 60.0, 120.0, 240.0]))
@settings(max_examples=50)
def test_the_top_of_a_jump_is_no_stand(height, rate):
    t = clock(2.5, rate)
    flight = np.sqrt(8.0 * height / 9.81)
    lifted = np.maximum(0.5 * 9.81 * (t - 0.8) * (0.8 + flight - t), 0.0)
    assert_spans(stands_of(along(1, lifted), rate=rate), [(0.0, 0.8), (0.8 + flight, t[-1])], within=0.03 + 1.0 / rate)


def test_the_unit_of_the_file_does_not_matter():
    height = np.concatenate((np.zeros(40), np.linspace(0.0, 0.3, 101)[1:]))
    spans = [
        [(plant.start, plant.stop) for plant in found_in(carried(height, scale=scale))] for scale in (1.0, 39.37, 1e3)
    ]
    assert spans[0] == spans[1] == spans[2] != []


def test_frames_of_a_rest_pose_are_never_planted_nor_asked_for_the_floor():
    plants = found_in(carried(np.concatenate(([-1.0, -1.0], np.zeros(30)))), first=2)
    assert {(plant.start, plant.stop) for plant in plants} == {(2, 31)}


def test_ankle_and_toe_are_planted_by_themselves_and_make_one_stand_of_the_foot():
    motion = carried(np.zeros(60))
    poses = forward(motion)
    places = poses.positions.copy()
    ankle, toe = (motion.skeleton.names.index(name) for name in ("LeftFoot", "LeftToeBase"))
    places[30:, ankle, 1] += 0.008 * np.arange(30)
    places[:15, toe, 1] += 0.008 * np.arange(15)[::-1]
    plants = plants_among(motion, WorldPoses(places, poses.rotations))
    left = {plant.part: (plant.start, plant.stop) for plant in plants if plant.foot == "left"}
    assert left["heel"] == (0, pytest.approx(30, abs=3))
    assert left["toe"] == (pytest.approx(14, abs=3), 59)
    (stand,) = (stand for stand in foot_plants(plants) if stand.foot == "left")
    assert (stand.start, stand.stop) == (0, 59)
    assert [plant.part for plant in stand.phases] == ["heel", "toe"]


def planted(foot, part, start, stop):
    return Plant(foot, part, joint=0, point=int(part == "toe"), start=start, stop=stop, height=0.0)


def test_plants_of_a_foot_that_overlap_or_meet_are_one_stand():
    plants = [
        planted("left", "heel", 0, 9),
        planted("right", "heel", 5, 40),
        planted("left", "toe", 10, 20),
        planted("left", "heel", 22, 30),
        planted("left", "toe", 24, 26),
        planted("left", "toe", 29, 50),
    ]
    assert [(stand.foot, stand.start, stand.stop, len(stand.phases)) for stand in foot_plants(plants)] == [
        ("left", 0, 20, 2),
        ("right", 5, 40, 1),
        ("left", 22, 50, 3),
    ]
    assert foot_plants([]) == []


def test_plants_come_in_the_order_of_their_first_frames():
    stances = footfalls(4.0, speed=0.9, cycle=1.1, duty=0.6, first=0.3)
    other = footfalls(4.0, speed=0.9, cycle=1.1, duty=0.6, first=0.85)
    left, right = (foot_path(clock(4.0, RATE), falls) for falls in (stances, other))
    plants = plants_of(np.stack((left, left, right, right), axis=1), BODY, up=UP, first=0, frame_time=0.01)
    keys = [(plant.start, plant.foot, plant.point) for plant in plants]
    assert keys == sorted(keys)
    assert len(plants) == 2 * (len(within(stances, 4.0)) + len(within(other, 4.0)))


def test_a_body_without_legs_or_a_take_of_one_frame_has_no_plants():
    assert found_in(carried(np.zeros(3)), first=2) == []
    arms = [("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]
    assert found_in(standing(skeleton_of(arms))) == []


def strolls(rng, frames):
    """Return paths of the four points, (F, 4, 3), that rest and go on, for a while up in the air."""
    going = np.repeat(rng.random((frames // 5 + 1, 4)) < 0.5, 5, axis=0)[:frames]
    steps = going[..., None] * rng.normal(scale=0.01, size=(frames, 4, 3)) * rng.choice([0.3, 1.0, 3.0])
    return np.cumsum(steps + rng.normal(scale=0.0004, size=(frames, 4, 3)), axis=0)


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(30))
def test_compiled_plants_are_those_of_numpy(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    tracks = strolls(rng, int(rng.choice([2, 3, 40, 400])))
    how = {"up": axis_vector(str(rng.choice(["x", "-y", "z"]))), "first": seed % 2, "frame_time": 1.0 / 60.0}
    found = plants_of(tracks, BODY, **how)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    assert found == plants_of(tracks, BODY, **how)


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_tracks_of_another_size_are_an_error_and_no_crash():
    rules = (1, 1, 1, 2, 1, *[1.0] * 7)
    with pytest.raises(ValueError, match="tracks has 72 bytes instead of"):
        compiled().stands(np.zeros((3, 1, 3)), np.zeros(1, np.int64), UP, 4, 1, 1.0, rules)
    with pytest.raises(ValueError, match="up has 16 bytes instead of"):
        compiled().stands(np.zeros((3, 1, 3)), np.zeros(1, np.int64), np.zeros(2), 3, 1, 1.0, rules)
    with pytest.raises(ValueError, match="too few frames"):
        compiled().stands(np.zeros((1, 1, 3)), np.zeros(1, np.int64), UP, 1, 1, 1.0, rules)
