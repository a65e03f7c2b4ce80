"""Elbows and knees that an edit bends back, or shut too far, are held where a body's end."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.overbent import hold_bends
from motionedit.core.kinematics import forward

SKELETON = skeleton_of()
ELBOW = SKELETON.names.index("LeftForeArm")
FRAMES = 40
MOVED = slice(10, 30)


def bent_by(degrees):
    """Return a motion whose left elbow is bent by some degrees about z, of shape (F,) or one for all frames."""
    motion = standing(SKELETON, FRAMES)
    angles = np.broadcast_to(np.radians(degrees), FRAMES)
    return with_rotation(motion, "LeftForeArm", slice(None), angles[:, None] * [0.0, 0.0, 1.0])


def bends_of(motion, first=0):
    return find_bends(SKELETON, forward(motion), find_anatomy(SKELETON), first=first)


def elbow_of(motion):
    return np.degrees(rot.log(motion.rotations[:, ELBOW])[:, 2])


def edited(before, degrees):
    angles = np.full(FRAMES, 30.0)
    angles[MOVED] = degrees
    return before, bent_by(angles)


@pytest.mark.parametrize("degrees", [-1.0, -40.0, -80.0, 166.0, 175.0])
def test_a_limb_bent_too_far_is_held_within_and_nothing_else_is_turned(degrees):
    before, after = edited(bent_by(30.0), degrees)
    held = hold_bends(after, bends_of(before), first=0)
    assert held.joints == (ELBOW,)
    angles = elbow_of(held.motion)
    assert (angles[MOVED] >= 0.0).all()
    assert (angles[MOVED] <= 165.0).all()
    still = np.ones(FRAMES, dtype=bool)
    still[MOVED] = False
    np.testing.assert_allclose(angles[still], 30.0, atol=1e-9)
    others = np.arange(len(SKELETON)) != ELBOW
    np.testing.assert_array_equal(held.motion.rotations[:, others], after.rotations[:, others])


@pytest.mark.parametrize(("own", "degrees"), [(30.0, 3.0), (-12.0, -12.0), (170.0, 169.0)])
def test_a_limb_may_be_bent_as_far_as_the_input_bends_it(own, degrees):
    angles = np.full(FRAMES, 30.0)
    angles[:5] = own
    before = bent_by(angles)
    angles[MOVED] = degrees
    held = hold_bends(bent_by(angles), bends_of(before), first=0)
    assert held.joints == ()


def test_a_limb_comes_to_its_limit_without_a_corner():
    before = bent_by(30.0)
    after = bent_by(np.linspace(30.0, -30.0, FRAMES))
    angles = elbow_of(hold_bends(after, bends_of(before), first=0).motion)
    assert angles.min() >= 0.0
    assert np.abs(np.diff(angles, 2)).max() < 0.3 * (60.0 / FRAMES)
    assert (np.diff(angles) < 0.0).all()


def test_a_rest_pose_is_left_as_it_is():
    before, after = edited(bent_by(30.0), -20.0)
    held = hold_bends(after, bends_of(before, first=12), first=12)
    np.testing.assert_allclose(elbow_of(held.motion)[:12], elbow_of(after)[:12], atol=1e-12)
    assert elbow_of(held.motion)[12:].min() >= 0.0
