"""Targets of shape constraints: points met exactly, holds that stand still, ramps that leave and meet the input."""

import numpy as np
import pytest
from trajectories_through_points import (
    FRAMES,
    PATH,
    PLACE,
    RATE,
    SHIFT,
    TURNS,
    T,
    at,
    during,
    hold,
    largest_jump,
    targets,
    turned,
    whole,
)

from motionedit.core.priorities.trajectories.positions import ControlPoint, active_interval, share_of
from motionedit.core.priorities.trajectories.rotations import rotation_targets


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


def test_a_share_is_all_in_the_points_and_rises_and_falls_as_hermites_cubic():
    share = share_of([ControlPoint("hold", 20, 30)], ease_in=10.0, ease_out=5.0, frames=60)
    np.testing.assert_array_equal(share[20:31], 1.0)
    assert not share[:11].any()
    assert not share[35:].any()
    s = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(share[10:21], 3 * s**2 - 2 * s**3, atol=1e-12)
    np.testing.assert_array_equal(share_of([], ease_in=10.0, ease_out=5.0, frames=4), np.ones(4))


def test_a_share_whose_ramps_the_clip_cuts_is_a_part_of_the_whole_one():
    def shares(start, frames):
        point = ControlPoint("during", start, start + 6)
        return share_of([point], ease_in=10.0, ease_out=10.0, frames=frames)

    whole = shares(20, 60)
    np.testing.assert_allclose(shares(4, 14), whole[16:30], atol=1e-12)
    assert 0.0 < shares(4, 14)[0] < shares(4, 14)[1]
