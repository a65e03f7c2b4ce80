"""A new path: it turns a body by as much as its direction has turned, and takes each stand along as a whole."""

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.feet.path import carried, new_path, turned
from motionedit.core.feet.stance import Stance
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from tests.unit.core.feet.test_keep import facts

UP, FRAME_TIME, LEG = np.array([0.0, 1.0, 0.0]), 0.01, 0.85
WALK = np.linspace([0.0, 0.9, 0.0], [0.0, 0.9, 4.0], 300)
SWAY = 0.02 * np.sin(np.linspace(0.0, 30.0, 300))[:, None] * np.array([1.0, 0.5, 0.0])
QUARTER = rot.exp(np.radians(40.0) * UP)


def path(places, shift):
    return new_path(places, shift, up=UP, leg=LEG, frame_time=FRAME_TIME)


@pytest.mark.parametrize("angle", [-170.0, -30.0, 0.0, 40.0, 120.0])
def test_a_path_turned_as_a_whole_turns_the_body_by_its_angle(angle):
    places = WALK + SWAY
    after = rot.rotate(np.tile(rot.exp(np.radians(angle) * UP), (300, 1)), places)
    assert np.degrees(path(places, after - places).heading) == pytest.approx(angle, abs=1.0)


def test_a_path_that_is_moved_does_not_turn_the_body():
    assert path(WALK + SWAY, np.tile([3.0, 0.0, -2.0], (300, 1))).heading == pytest.approx(0.0, abs=1e-9)


def test_a_body_that_stands_has_no_direction_to_turn_from():
    aside = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 300)
    assert np.abs(np.degrees(path(SWAY, aside).heading)).max() < 5.0


def test_a_bend_turns_the_body_smoothly_there_and_back():
    aside = 0.3 * np.sin(np.linspace(0.0, np.pi, 300))[:, None] * np.array([1.0, 0.0, 0.0])
    heading = np.degrees(path(WALK, aside).heading)
    assert heading[0] == pytest.approx(-heading[-1], abs=1e-6)
    assert heading[0] == pytest.approx(np.degrees(np.arctan(0.3 * np.pi / 4.0)), abs=1.0)
    assert np.abs(np.diff(heading)).max() < 0.3


def test_a_stand_is_taken_along_as_a_whole():
    flat = np.arange(300) < 100
    turn = rot.exp(np.tile([0.1, 0.2, 0.0], (300, 1)))
    heel, toe = np.tile([0.1, 0.1, 0.6], (300, 1)), np.tile([0.1, 0.0, 0.75], (300, 1))
    stance = Stance(flat, flat, heel, toe, turn, np.where(flat, 0, -1))
    around = np.tile(QUARTER, (300, 1))
    found = carried(stance, path(WALK, rot.rotate(around, WALK) - WALK))
    for after, before in ((found.heel_place, heel), (found.toe_place, toe)):
        assert after[:100] == pytest.approx(rot.rotate(around[:100], before[:100]), abs=0.02)
        assert np.ptp(after[:100], axis=0).max() == 0.0
    length = np.linalg.norm(found.toe_place - found.heel_place, axis=1)
    assert length == pytest.approx(np.linalg.norm(toe - heel, axis=1))
    assert rot.angle_between(found.turn[:100], rot.multiply(around[:100], turn[:100])).max() < 0.02
    assert np.array_equal(found.turn[100:], turn[100:])


def test_a_body_is_turned_about_what_carries_it_and_nothing_in_it_moves():
    clip = facts("walk.bvh")
    before, places = clip.clip.motion, clip.poses.positions[:, clip.travel]
    around = np.tile(rot.exp(np.radians(40.0) * clip.up), (len(before), 1))
    way = new_path(
        places, rot.rotate(around, places) - places, up=clip.up, leg=clip.anatomy.leg_length, frame_time=1.0 / 24.0
    )
    after = turned(before, way, clip.poses, clip.travel)
    assert isinstance(after, Motion)
    assert np.array_equal(after.rotations[:, 1:], before.rotations[:, 1:])
    seen = forward(after).positions - places[:, None]
    asked = rot.rotate(
        np.broadcast_to(way.turns[:, None], (*seen.shape[:2], 4)), clip.poses.positions - places[:, None]
    )
    assert seen == pytest.approx(asked, abs=1e-9)
