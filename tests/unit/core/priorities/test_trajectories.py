"""Targets of shape constraints: points met exactly, holds that stand still, ramps that leave and meet the input."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.priorities.trajectories import (
    ControlPoint,
    active_interval,
    eased,
    position_targets,
    rotation_targets,
)
from motionedit.core.units import STANDARD_LEG

# Frames so fine that a difference between two of them is a derivative: 10 s at 1000 frames a second.
FRAMES, RATE = 10001, 1000.0
T = np.arange(FRAMES) / RATE
PATH = np.stack((np.sin(T), 0.3 * np.cos(2.0 * T) + 0.1, 1.2 * T), axis=1)
TURNS = rot.multiply(rot.exp(np.outer(T, [0.0, 0.5, 0.0])), rot.exp(np.outer(np.sin(T), [0.4, 0.1, -0.3])))
SHIFT = np.array([0.1, 0.7, -0.3])
PLACE = np.array([1.3, 2.1, 4.7])
TURN = rot.exp(np.array([0.3, -1.1, 0.4]))


def hold(start, stop, position=None, shift=None, **more):
    return ControlPoint("hold", start, stop, position, shift, **more)


def during(start, stop, shift=None):
    return ControlPoint("during", start, stop, None, shift)


def at(frame, position=None, shift=None, **more):
    return ControlPoint("at", frame, frame, position, shift, **more)


def targets(points, *, path=PATH, ease=1000.0, curve="time"):
    return position_targets(path, points, ease_in=ease, ease_out=ease, curve=curve)


def whole(points, **how):
    """Return the input with the targets laid into it, shape (F, 3)."""
    path = how.get("path", PATH).copy()
    first, found = targets(points, **how)
    path[first : first + len(found)] = found
    return path


def turned(points, *, turns=TURNS, ease=1000.0):
    turns = turns.copy()
    first, found = rotation_targets(turns, points, ease_in=ease, ease_out=ease)
    turns[first : first + len(found)] = found
    return turns


def largest_jump(path, rate=RATE):
    """Return the largest change of velocity from one frame to the next, units a second."""
    return np.linalg.norm(np.diff(path, n=2, axis=0), axis=1).max() * rate


def largest_turn_jump(turns):
    """Return the largest change of angular velocity from one frame to the next, rad a second."""
    steps = rot.log(rot.multiply(rot.conjugate(turns[:-1]), turns[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=1).max() * RATE


# No points.


def test_without_points_the_targets_are_the_input_over_the_whole_clip():
    first_place, places = targets([])
    first_turn, turns = rotation_targets(TURNS, [], ease_in=1000.0, ease_out=1000.0)
    assert (first_place, first_turn) == (0, 0)
    assert places.tobytes() == PATH.tobytes()
    assert turns.tobytes() == TURNS.tobytes()
    assert not np.shares_memory(places, PATH)
    assert not np.shares_memory(turns, TURNS)


# The active interval.


def test_the_active_interval_is_eased_and_rounded_to_frames_halves_up():
    assert active_interval([at(50)], ease_in=10.0, ease_out=20.0, frames=100) == (40, 70)
    assert active_interval([hold(50, 60)], ease_in=9.6, ease_out=9.6, frames=100) == (40, 70)
    assert active_interval([hold(50, 60)], ease_in=9.5, ease_out=9.5, frames=100) == (41, 70)
    assert active_interval([], ease_in=10.0, ease_out=20.0, frames=100) == (0, 99)


def test_the_active_interval_is_cut_at_the_clips_ends():
    assert active_interval([at(5), at(95)], ease_in=10.0, ease_out=10.0, frames=100) == (0, 99)


def test_a_ramp_that_is_cut_is_what_is_left_of_a_whole_one_and_begins_displaced():
    first, found = targets([hold(800, 900, shift=SHIFT), hold(9100, 9200, shift=SHIFT)])
    assert first == 0
    assert len(found) == FRAMES
    # A ramp over a displacement is a cubic with a velocity at its end: that of the input, which a hold stops.
    for cut, frames, stop in ((found[:801], slice(0, 801), 800), (found[:9199:-1], slice(None, 9199, -1), 9200)):
        s, velocity = 1.0 - np.abs(np.arange(FRAMES)[frames] - stop)[:, None] / 1000.0, np.gradient(PATH, axis=0)[stop]
        along = -1000.0 * velocity * (1.0 if stop == 800 else -1.0)
        place = PATH[800 if stop == 800 else 9100] + SHIFT - PATH[stop]
        expected = s * s * (3.0 - 2.0 * s) * place + (s - 1.0) * s * s * along
        np.testing.assert_allclose(cut - PATH[frames], expected, atol=1e-12)
    assert np.linalg.norm(found[0] - PATH[0]) > 0.05
    assert largest_jump(found) < 0.1


def test_a_hold_from_the_first_frame_starts_in_place_and_one_to_the_last_ends_in_place():
    first, found = targets([hold(0, 300, position=PLACE), hold(9000, 10000, shift=SHIFT)])
    assert first == 0
    np.testing.assert_array_equal(found[:301], np.broadcast_to(PLACE, (301, 3)))
    np.testing.assert_array_equal(found[9000:], np.broadcast_to(PATH[9000] + SHIFT, (1001, 3)))


def test_without_ease_there_are_no_ramps():
    first, found = targets([hold(300, 400, shift=SHIFT)], ease=0.0)
    assert first == 300
    np.testing.assert_array_equal(found, np.broadcast_to(PATH[300] + SHIFT, (101, 3)))


def test_one_instant_without_ease_is_one_target():
    first, found = targets([at(300, position=PLACE)], ease=0.0)
    assert first == 300
    np.testing.assert_array_equal(found, PLACE[None])


def test_a_clip_of_one_frame_has_one_target():
    first, found = targets([at(0, shift=SHIFT)], path=PATH[:1])
    assert first == 0
    np.testing.assert_array_equal(found, PATH[:1] + SHIFT)


@pytest.mark.parametrize("points", [[at(300), hold(310, 400)], [hold(0, 5), at(6)]])
def test_points_that_only_follow_each_other_are_fine(points):
    assert active_interval(points, ease_in=0.0, ease_out=0.0, frames=FRAMES) == (points[0].start, points[-1].stop)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([hold(20, 60), hold(30, 40)], "'hold [20, 60]' and 'hold [30, 40]' share a frame"),
        ([during(20, 60), hold(60, 80)], "'during [20, 60]' and 'hold [60, 80]' share a frame"),
        ([at(20), at(20)], "'at 20' and 'at 20' share a frame"),
        ([at(5), hold(60, 80), at(20)], "'at 20' comes after 'hold [60, 80]'; points stand in the order"),
    ],
)
@pytest.mark.parametrize("of", [targets, turned])
def test_points_that_overlap_or_are_out_of_order_are_refused_by_name(points, message, of):
    with pytest.raises(ValueError, match="; ") as refusal:
        of(points)
    assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


# Holds.


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("curve", ["time", "index"])
def test_every_frame_of_a_hold_has_the_same_target_to_the_last_bit(seed, curve):
    shift = np.random.default_rng(seed).normal(size=3)
    found = whole([hold(2000, 2500, shift=shift), at(3000, shift=shift), hold(4000, 4100)], curve=curve)
    assert (found[2000:2501] == PATH[2000] + shift).all()
    assert (found[4000:4101] == PATH[4000]).all()


def test_a_hold_takes_its_place_from_the_input_at_its_start():
    found = whole([hold(2000, 2500, shift=SHIFT)])
    np.testing.assert_array_equal(found[2500], PATH[2000] + SHIFT)


@pytest.mark.parametrize("more", [{"shift": SHIFT}, {"position": PLACE}])
def test_a_hold_is_come_to_and_left_at_rest(more):
    found = whole([hold(2000, 2500, **more)])
    for velocity in (found[2000] - found[1999], found[2501] - found[2500]):
        assert np.linalg.norm(velocity) * RATE < 0.03


# Continuity.

SHAPES = {
    "hold by shift": [hold(2000, 2500, shift=SHIFT)],
    "hold by position": [hold(2000, 2500, position=PLACE)],
    "ride": [during(3000, 4000, SHIFT)],
    "instant": [at(5000, shift=SHIFT)],
    "instant at a place": [at(5000, position=PLACE)],
    "step": [hold(2000, 2500), at(3500, shift=SHIFT, bias=0.3), at(4000, shift=-SHIFT), hold(6000, 6100)],
    "ride between places": [at(2000, position=PLACE), during(3000, 3500, SHIFT), hold(5000, 5500, position=PLACE)],
    "from the first frame to the last": [hold(0, 100, shift=SHIFT), at(5000, tension=0.4), during(9000, 10000)],
    "instants in place": [at(0, position=PLACE), at(5000, shift=SHIFT), at(10000, position=-PLACE)],
}


@pytest.mark.parametrize("name", SHAPES)
def test_the_velocity_is_continuous_everywhere(name):
    # The input's own acceleration is 1.7 and the ramps' at most some 70 units/s^2: below 0.1 in a thousandth second.
    assert largest_jump(whole(SHAPES[name])) < 0.1


@pytest.mark.parametrize("name", SHAPES)
def test_targets_pass_through_every_point_exactly(name):
    found = whole(SHAPES[name])
    for point in SHAPES[name]:
        shift = np.zeros(3) if point.shift is None else point.shift
        place = PATH[point.start] + shift if point.position is None else point.position
        np.testing.assert_array_equal(found[point.start], place)


def test_a_given_end_tangent_keeps_the_velocity_where_a_ramp_leaves_the_input():
    kept = whole([hold(2000, 2500, position=PLACE)])
    jump = np.diff(kept, n=2, axis=0)[999] * RATE
    assert np.linalg.norm(jump) < 0.05
    assert np.linalg.norm(PATH[1000] - PATH[999]) * RATE > 1.0


def test_an_instant_in_place_of_a_splined_path_goes_at_the_inputs_velocity_and_with_tension_one_stands():
    start, stop = at(0, position=PLACE), at(10000, position=-PLACE)
    # Without an ease: a ramp would come from beyond the clip, and the point be inside the spline.
    found = whole([start, stop], ease=0.0)
    np.testing.assert_allclose(found[1] - found[0], PATH[1] - PATH[0], atol=1e-5)
    np.testing.assert_allclose(found[-1] - found[-2], PATH[-1] - PATH[-2], atol=1e-5)
    found = whole([at(0, position=PLACE, tension=1.0), at(10000, position=-PLACE, tension=1.0)], ease=0.0)
    assert np.abs(np.diff(found[[0, 1, -2, -1]], axis=0)[[0, 2]]).max() < 1e-5


# Displacement or path.


@pytest.mark.parametrize("curve", ["time", "index"])
def test_a_displacement_of_zero_is_the_input_to_the_last_bit(curve):
    zero = np.zeros(3)
    points = [at(2000), during(3000, 4000, zero), at(5000, shift=zero, tension=0.5, bias=1.0), during(7000, 8000)]
    np.testing.assert_array_equal(whole(points, curve=curve), PATH)


def test_a_ride_is_the_input_and_the_shift():
    found = whole([during(3000, 4000, SHIFT)])
    np.testing.assert_array_equal(found[3000:4001], PATH[3000:4001] + SHIFT)


def test_shifts_keep_the_inputs_detail_and_positions_replace_it():
    detail = PATH + 0.01 * np.sin(80.0 * T)[:, None]
    displaced = whole([at(5000, shift=SHIFT)], path=detail) - whole([at(5000, shift=SHIFT)])
    np.testing.assert_allclose(displaced, detail - PATH, atol=1e-14)
    place = detail[5000] + SHIFT
    replaced = whole([at(5000, position=place)], path=detail)
    assert largest_jump(replaced[4002:4999]) < 0.2 * largest_jump(displaced[4002:4999])


def test_a_displacement_rises_and_falls_as_hermites_cubic_with_no_slope_at_its_ends():
    found = whole([at(2000, shift=SHIFT)]) - PATH
    s = np.linspace(0.0, 1.0, 1001)[:, None]
    np.testing.assert_allclose(found[1000:2001], s * s * (3.0 - 2.0 * s) * SHIFT, atol=1e-14)
    np.testing.assert_allclose(found[2000:3001], (1.0 - s * s * (3.0 - 2.0 * s)) * SHIFT, atol=1e-14)
    assert not found[:1001].any()
    assert not found[3000:].any()


def test_points_without_a_position_go_to_their_own_place_in_a_splined_path():
    points = [at(2000, shift=SHIFT), during(2500, 3000), hold(4000, 4100, position=PLACE)]
    found = whole(points)
    np.testing.assert_array_equal(found[2000], PATH[2000] + SHIFT)
    np.testing.assert_array_equal(found[2500:3001], PATH[2500:3001])


def test_targets_do_not_depend_on_a_points_tension_where_it_holds():
    plain, tense = ([hold(2000, 2500, shift=SHIFT, tension=t, bias=t), at(4000)] for t in (0.0, 0.7))
    np.testing.assert_array_equal(whole(plain), whole(tense))


# The paper's own parameter.

UNEVEN = [at(2000, position=PLACE), at(2400, position=PLACE + SHIFT), at(4000, position=PLACE - SHIFT)]


def test_by_index_the_speed_jumps_at_uneven_keys_and_by_time_it_does_not():
    by_time, by_index = (whole(UNEVEN, curve=curve) for curve in ("time", "index"))
    assert largest_jump(by_time) < 0.1
    assert largest_jump(by_index) > 1.0
    for point in UNEVEN:
        np.testing.assert_array_equal(by_index[point.start], point.position)


def test_by_index_the_speeds_at_a_key_are_as_the_spans_on_its_sides():
    found = whole(UNEVEN, curve="index")
    before, after = found[2400] - found[2399], found[2401] - found[2400]
    # One tangent per index on both sides, so per second it is over 0.4 s before and over 1.6 s after.
    np.testing.assert_allclose(before / after, 4.0, rtol=0.05)


def test_by_index_the_ends_still_have_the_inputs_velocity():
    found = whole(UNEVEN, curve="index")
    np.testing.assert_allclose((found[1001] - found[1000]) * RATE, (PATH[1001] - PATH[1000]) * RATE, atol=0.02)
    np.testing.assert_allclose((found[5000] - found[4999]) * RATE, (PATH[5000] - PATH[4999]) * RATE, atol=0.02)


def test_at_even_keys_index_and_time_are_the_same_curve():
    points = [at(2000, shift=SHIFT), at(3000, shift=-SHIFT), at(4000, position=PLACE)]
    np.testing.assert_allclose(whole(points, curve="index"), whole(points), atol=1e-12)


# Rotations.


def test_turns_pass_through_their_points_and_stand_still_in_holds():
    found = turned([at(2000, orientation=TURN), hold(3000, 3500), hold(5000, 5500, orientation=TURN)])
    np.testing.assert_array_equal(found[2000], TURN)
    np.testing.assert_array_equal(found[3000:3501], np.broadcast_to(TURNS[3000], (501, 4)))
    np.testing.assert_array_equal(found[5000:5501], np.broadcast_to(TURN, (501, 4)))


@pytest.mark.parametrize(
    "points",
    [
        [hold(2000, 2500, orientation=TURN)],
        [at(2000, orientation=TURN), at(3000), at(4000, orientation=rot.conjugate(TURN))],
        [hold(0, 100), during(3000, 4000), hold(9000, 10000, orientation=TURN)],
    ],
)
def test_the_angular_velocity_is_continuous(points):
    assert largest_turn_jump(turned(points)) < 0.05


def test_between_two_holds_it_is_a_slerp_that_starts_and_ends_at_rest():
    other = rot.multiply(TURN, rot.exp(np.array([0.0, 0.0, 1.0])))
    found = turned([hold(2000, 2500, orientation=TURN), hold(3500, 4000, orientation=other)])
    s = np.linspace(0.0, 1.0, 1001)
    expected = rot.slerp(TURN, other, s * s * (3.0 - 2.0 * s))
    assert rot.angle_between(found[2500:3501], expected).max() < 1e-12


def test_turns_without_an_orientation_ride_the_input_to_the_last_bit():
    np.testing.assert_array_equal(turned([at(2000), during(3000, 4000), at(6000, shift=SHIFT)]), TURNS)


def test_an_instants_orientation_turns_with_the_input_around_it():
    found = turned([at(2000, orientation=TURN)])
    extra = rot.multiply(found, rot.conjugate(TURNS))
    # The extra turn is at its fullest there, and at rest.
    assert rot.angle_between(extra[1999], extra[2000]) < 1e-5
    assert rot.angle_between(extra[2000], rot.multiply(TURN, rot.conjugate(TURNS[2000]))) < 1e-12


def test_a_ramp_outside_which_nothing_turns_leaves_the_input_to_the_last_bit():
    found = turned([hold(2000, 2500, orientation=TURN)])
    np.testing.assert_array_equal(found[:1001], TURNS[:1001])
    np.testing.assert_array_equal(found[3500:], TURNS[3500:])


def test_a_hold_of_turns_at_the_clips_end_starts_in_place():
    first, found = rotation_targets(TURNS, [hold(0, 300, orientation=TURN)], ease_in=1000.0, ease_out=0.0)
    assert first == 0
    np.testing.assert_array_equal(found, np.broadcast_to(TURN, (301, 4)))


@pytest.mark.parametrize("past", [900, 500, 100])
def test_a_turn_that_goes_past_half_a_turn_from_its_goal_does_not_jump(past):
    spin = rot.exp(np.outer(T, [0.0, 1.5, 0.0]))
    # In the ramp of 1000 frames, at this one, the input is half a turn from its goal.
    goal = rot.exp(np.array([0.0, 1.5 * T[1000 + past] + np.pi, 0.0]))
    found = turned([hold(2000, 2500, orientation=goal)], turns=spin)
    assert rot.angle_between(found[1:], found[:-1]).max() < 0.02
    assert largest_turn_jump(found) < 0.05


def test_the_sign_of_a_quaternion_does_not_matter():
    one, other = (turned([hold(2000, 2500, orientation=sign * TURN)]) for sign in (1.0, -1.0))
    assert rot.angle_between(one, other).max() < 1e-12


def test_turns_that_begin_and_end_in_place_have_no_ramps():
    found = turned([at(0, orientation=TURN), at(10000, orientation=TURN)])
    np.testing.assert_array_equal(found[[0, -1]], np.stack((TURN, TURN)))


# Any points.


@st.composite
def sessions(draw):
    """Return a smooth path of some frames, and points on it."""
    frames = draw(st.integers(1, 80))
    path = np.cumsum(draw(nps.arrays(np.float64, (frames, 3), elements=st.floats(-1.0, 1.0))), axis=0)
    times = sorted(draw(st.sets(st.integers(0, frames - 1), min_size=1, max_size=8)))
    vectors = nps.arrays(np.float64, 3, elements=st.floats(-10.0, 10.0))
    points = []
    while times:
        start = times.pop(0)
        mode = draw(st.sampled_from(["hold", "during", "at"]))
        stop = times.pop(0) if times and mode != "at" else start
        means = [(None, None), (None, draw(vectors))] + [(draw(vectors), None)] * (mode != "during")
        position, shift = draw(st.sampled_from(means))
        points.append(ControlPoint(mode, start, stop, position, shift, None, *draw(st.tuples(*[st.floats(-1, 1)] * 3))))
    return path, points, draw(st.floats(0.0, 40.0)), draw(st.floats(0.0, 40.0))


@given(sessions(), st.sampled_from(["time", "index"]))
def test_any_targets_are_finite_meet_every_point_and_are_bounded(session, curve):
    path, points, ease_in, ease_out = session
    first, found = position_targets(path, points, ease_in=ease_in, ease_out=ease_out, curve=curve)
    last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(path))[1]
    assert found.shape == (last - first + 1, 3)
    assert np.isfinite(found).all()
    # A ramp that the clip does not cut meets the input.
    if first < points[0].start and eased(points, ease_in=ease_in, ease_out=ease_out)[0] >= 0:
        np.testing.assert_array_equal(found[0], path[first])
    if last > points[-1].stop and eased(points, ease_in=ease_in, ease_out=ease_out)[1] < len(path):
        np.testing.assert_array_equal(found[-1], path[last])
    for point in points:
        ride = path[point.start : point.stop + 1] if point.mode == "during" else path[point.start]
        wanted = ride + (0.0 if point.shift is None else point.shift) if point.position is None else point.position
        block = found[point.start - first : point.stop - first + 1]
        np.testing.assert_array_equal(block, np.broadcast_to(wanted, block.shape))


@given(sessions(), st.sampled_from(["time", "index"]))
def test_any_targets_are_continuous_finer_frames_take_steps_as_much_smaller(session, curve):
    path, points, ease_in, ease_out = session

    def largest_step(fine):
        """Return the longest step of the same session at `fine` frames for one."""
        frames = np.arange(fine * (len(path) - 1) + 1) / fine
        dense = np.stack([np.interp(frames, np.arange(len(path)), axis) for axis in path.T], axis=1)
        finer = [replace(point, start=fine * point.start, stop=fine * point.stop) for point in points]
        # Whole frames, so that no ramp is shorter than one.
        eases = {"ease_in": fine * round(ease_in), "ease_out": fine * round(ease_out)}
        _, found = position_targets(dense, finer, **eases, curve=curve)
        return np.abs(np.diff(found, axis=0)).max(initial=0.0)

    assert largest_step(160) <= 0.2 * largest_step(20) + 1e-12


def test_a_joint_less_than_half_a_turn_from_its_goal_is_led_back_on_the_side_on_which_it_is():
    # The input turns on while the goal stands: by 1.2 rad at its end, and half way through the ramp by more than pi.
    angle = np.where(T < 4.0, 1.2, 1.2 + 6.0 * (T - 4.0))
    turns = rot.exp(np.outer(angle, [0.0, 0.0, 1.0]))
    found = turned([hold(2000, 4000, orientation=rot.exp(np.zeros(3)))], turns=turns)
    behind = rot.log(rot.multiply(rot.conjugate(turns), found))[4000:5001, 2]
    assert behind.max() < 1e-9
    assert -np.pi < behind.min() < -1.2
    assert largest_turn_jump(found[4001:5000]) < 0.1


# A real walk.


@pytest.fixture(scope="module")
def walk():
    """Return the paths of the right ankle and wrist, normalised metres, and the frames of one second."""
    folder = os.environ.get("MOTIONEDIT_CLIPS")
    file = Path(folder or "", "motions", "cmu_12_01_walk.bvh")
    if folder is None or not file.exists():
        pytest.skip("MOTIONEDIT_CLIPS names no folder of real clips with this walk")
    motion = read_clip(file).motion
    anatomy = find_anatomy(motion.skeleton)
    poses = forward(motion)
    joints = (anatomy.legs[1].ankle, anatomy.arms[1].wrist)
    scale = STANDARD_LEG / anatomy.leg_length
    return [effector_positions(poses, Effector(j, np.zeros(3))) * scale for j in joints], 1.0 / motion.frame_time


@pytest.mark.parametrize("more", ["shift", "position"])
def test_on_a_real_walk_the_velocity_breaks_little_at_ramps_beyond_the_walks_own_and_at_holds(walk, more):
    paths, rate = walk
    ease = round(0.8 * rate)

    def breaks(path, frames):
        return np.linalg.norm(path[frames + 1] - 2.0 * path[frames] + path[frames - 1], axis=1) * rate

    for path in paths:
        speed = 0.0
        for start in range(110, len(path) - 150, 10):
            shift = np.array([0.0, 0.1, 0.1])
            how = {"shift": shift} if more == "shift" else {"position": path[start] + shift}
            found = whole([hold(start, start + 24, **how)], path=path, ease=ease)
            ramps, holds = np.array([start - ease, start + 24 + ease]), np.array([start, start + 24])
            assert (breaks(found, ramps) < breaks(path, ramps) + 0.2).all()
            assert (breaks(found, holds) < 0.25).all()
            speed = max(speed, np.linalg.norm(path[ramps + 1] - path[ramps], axis=1).max() * rate)
        # Without the input's velocity a ramp of the path would break it by all of that.
        assert speed > 1.5
