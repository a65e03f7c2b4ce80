"""A body that goes down by its legs: its feet stay where they are."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.feet.crouch import crouched
from motionedit.core.kinematics import forward, shifted

SKELETON, FRAMES = skeleton_of(), 5
ANATOMY, UP = find_anatomy(SKELETON), np.array([0.0, 1.0, 0.0])
ANKLES = [leg.ankle for leg in ANATOMY.legs]
LEGS = {joint for leg in ANATOMY.legs for joint in (leg.thigh, leg.knee, leg.ankle)}


def walker():
    """Return one who stands, the left knee bent a little and the right one straight."""
    return with_rotation(standing(SKELETON, FRAMES), "LeftLeg", slice(None), (0.3, 0.0, 0.0))


def lowered(down):
    motion = walker()
    bends = find_bends(SKELETON, forward(motion), ANATOMY, first=0)
    return crouched(motion, ANATOMY.legs, bends, down=np.full(FRAMES, down), up=UP)


@pytest.mark.parametrize("down", [0.0, 0.05, 0.2])
def test_ankles_stay_where_they_are_as_the_hips_go_down(down):
    motion, low = walker(), lowered(down)
    less = down * (1.0 + (down / 0.6) ** 4) ** -0.25
    before, after = forward(motion), forward(shifted(low, np.tile(-less * UP, (FRAMES, 1)), 0))
    np.testing.assert_allclose(after.positions[:, ANKLES], before.positions[:, ANKLES], atol=1e-9)
    assert rot.angle_between(after.rotations[:, ANKLES], before.rotations[:, ANKLES]).max() < 1e-9
    others = [joint for joint in range(len(SKELETON)) if joint not in LEGS]
    np.testing.assert_array_equal(low.rotations[:, others], motion.rotations[:, others])


def test_no_body_goes_lower_by_its_legs_than_they_fold():
    deep, deeper = (rot.angle_between(lowered(down).rotations, walker().rotations) for down in (2.0, 8.0))
    assert np.degrees(np.abs(deeper - deep).max()) < 1.0
    assert np.degrees(deeper.max()) < 180.0
