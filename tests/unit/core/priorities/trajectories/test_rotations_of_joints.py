"""Trajectories of orientations: through their points, at rest in holds, without a step."""

import numpy as np
import pytest
from trajectories_through_points import SHIFT, TURN, TURNS, T, at, during, hold, largest_turn_jump, turned

from motionedit.core import rotations as rot
from motionedit.core.priorities.trajectories.rotations import rotation_targets
from motionedit.core.slerp import slerp


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
    expected = slerp(TURN, other, s * s * (3.0 - 2.0 * s))
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
