"""Legs that draw up as a body does it by itself: ankles go up, feet keep their turns, and nothing else moves."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.feet.drawn_up import drawn_up
from motionedit.core.kinematics import forward

SKELETON, FRAMES = skeleton_of(), 5
ANATOMY, UP = find_anatomy(SKELETON), np.array([0.0, 1.0, 0.0])
ANKLES = [leg.ankle for leg in ANATOMY.legs]
LEGS = {joint for leg in ANATOMY.legs for joint in (leg.thigh, leg.knee, leg.ankle)}
# One who stands, the left knee bent a little and the right one straight.
MOTION = with_rotation(standing(SKELETON, FRAMES), "LeftLeg", slice(None), (0.3, 0.0, 0.0))
POSES = forward(MOTION)


def drawn(left, right):
    bends = find_bends(SKELETON, POSES, ANATOMY, first=0)
    return drawn_up(MOTION, ANATOMY.legs, bends, by=np.tile([left, right], (FRAMES, 1)), up=UP)


def rises(motion):
    """Return how much higher both ankles are, shape (2,), and hold them to be nowhere else."""
    shift = forward(motion).positions[:, ANKLES] - POSES.positions[:, ANKLES]
    np.testing.assert_allclose(shift - (shift @ UP)[..., None] * UP, 0.0, atol=1e-9)
    return (shift @ UP)[0]


@pytest.mark.parametrize("by", [(0.0, 0.0), (0.05, 0.05), (0.0, 0.1), (0.2, 0.05)])
def test_ankles_go_up_by_the_legs_alone(by):
    found = drawn(*by)
    np.testing.assert_allclose(rises(found), by, rtol=0.02, atol=1e-9)
    turns = forward(found).rotations[:, ANKLES]
    assert rot.angle_between(turns, POSES.rotations[:, ANKLES]).max() < 1e-9
    others = [joint for joint in range(len(SKELETON)) if joint not in LEGS]
    np.testing.assert_array_equal(found.rotations[:, others], MOTION.rotations[:, others])


def test_no_leg_folds_to_nothing():
    leg = ANATOMY.legs[1]
    whole = (POSES.positions[0, leg.thigh] - POSES.positions[0, leg.ankle]) @ UP
    far, farther = (rises(drawn(0.0, by))[1] for by in (1.5, 8.0))
    assert farther == pytest.approx(far, rel=0.01)
    assert farther == pytest.approx(0.6 * whole, rel=0.02)
