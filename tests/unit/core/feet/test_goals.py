"""A foot that rolls over its toe to bring the ankle nearer to the hip, or farther: never through the floor."""

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.feet.goals import Ground, _roll_onto, _roll_out

UP = np.array([0.0, 1.0, 0.0])
# An ankle 8 cm above a toe that stands on a height of 2 cm, and 12 behind it, under a hip 80 cm up.
TOE, ARM, HIP = np.array([[0.0, 2.0, 0.0]]), np.array([[-12.0, 8.0, 0.0]]), np.array([[-10.0, 80.0, 0.0]])
WAY = float(np.linalg.norm(HIP - TOE - ARM))


def rolled(way, floor):
    return rot.rotate(rot.exp(_roll_onto(TOE, ARM, HIP, np.array([way]), Ground(UP, floor, 0.0, 80.0))), ARM) + TOE


def test_it_rolls_until_the_ankle_is_as_far_from_the_hip_as_asked():
    for way in (WAY - 4.0, WAY + 9.0):
        ankle = rolled(way, None)
        assert np.linalg.norm(HIP - ankle) == pytest.approx(way)
        assert np.linalg.norm(ankle - TOE) == pytest.approx(np.linalg.norm(ARM))


def test_the_floor_ends_a_roll():
    deep = rolled(WAY + 9.0, None)[0, 1]
    floor = deep + 1.0
    assert floor <= rolled(WAY + 9.0, floor)[0, 1] < TOE[0, 1] + ARM[0, 1]
    assert rolled(WAY - 4.0, floor) == pytest.approx(rolled(WAY - 4.0, None))


def test_a_heel_that_is_down_alone_brings_its_toe_up_to_the_floor_and_no_farther():
    heel, arms = np.full((3, 3), 3.0), np.array([[10.0, -5.0, 0.0], [10.0, -1.0, 0.0], [0.0, 0.0, 0.0]])
    toes = rot.rotate(rot.exp(_roll_out(heel, arms, UP, 1.0)), arms)
    assert toes[0, 1] == pytest.approx(-2.0)
    assert np.linalg.norm(toes[0]) == pytest.approx(np.linalg.norm(arms[0]))
    assert toes[1:] == pytest.approx(arms[1:])
