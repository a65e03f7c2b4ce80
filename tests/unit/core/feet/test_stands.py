"""Stands re-placed: a foot whose body goes on too far for its leg stands where the leg holds it to the end."""

import numpy as np
import pytest

from motionedit.core.feet.reach import released
from motionedit.core.feet.stance import Stance
from motionedit.core.feet.stands import within_reach

UP, FRONT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


def stance(frames=20):
    """Return a foot that stands flat at the origin in all frames but the last, which its toe does."""
    heel = np.arange(frames) < frames - 1
    places = np.zeros((frames, 3))
    turns = np.tile([1.0, 0.0, 0.0, 0.0], (frames, 1))
    return Stance(heel, np.ones(frames, bool), places, places + 15.0 * FRONT, turns, np.zeros(frames, int))


def hips(first, last, frames=20):
    """Return hips 90 above the ground that go on by a straight line along z."""
    return np.linspace([0.0, 90.0, first], [0.0, 90.0, last], frames)


def test_a_stand_within_reach_stays_where_it_is():
    stands, reach = stance(), np.full(20, 100.0)
    assert np.array_equal(within_reach(stands, hips(-30.0, 40.0), reach, 1.0, UP).heel_place, stands.heel_place)


def test_a_stand_that_its_body_leaves_behind_is_moved_along_on_the_level_until_it_holds():
    stands, reach, hip = stance(), np.full(20, 100.0), hips(-20.0, 60.0)
    assert not released(stands, hip, reach).heel[18]
    found = within_reach(stands, hip, reach, 1.0, UP)
    assert np.array_equal(released(found, hip - 1.0 * UP, reach).heel, stands.heel)
    way = found.heel_place - stands.heel_place
    assert found.toe_place - stands.toe_place == pytest.approx(way)
    assert np.ptp(way, axis=0).max() == 0.0
    assert way[0] == pytest.approx([0.0, 0.0, hip[18, 2] - np.sqrt(100.0**2 - 90.0**2)], abs=0.1)


def test_a_stand_too_long_for_the_leg_lacks_as_much_at_both_ends():
    hip = hips(-60.0, 60.0)
    found = within_reach(stance(), hip + 25.0 * FRONT, np.full(20, 100.0), 1.0, UP)
    far = np.linalg.norm(hip + 25.0 * FRONT - found.heel_place, axis=1)
    assert far[0] == pytest.approx(far[18], rel=0.05)
