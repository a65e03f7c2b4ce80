"""Steps from frame to frame, against turns of known angles and SciPy's rotations."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation
from scipy.spatial.transform import Rotation

from motionedit.core import rotations as rot
from motionedit.core.body.steps import change_steps, own_steps
from motionedit.core.motion import Motion

SKELETON = skeleton_of()
ARM, HEAD = (SKELETON.names.index(name) for name in ("LeftArm", "Head"))


def turning(degrees, *, frame_time=1 / 60, seed=4):
    """Return a motion in which every joint turns at random, by steps of about so many degrees."""
    steps = np.random.default_rng(seed).normal(scale=np.radians(degrees), size=(20, len(SKELETON), 3))
    q = rot.exp(steps)
    for f in range(1, 20):
        q[f] = rot.multiply(q[f - 1], q[f])
    still = standing(SKELETON, frame_time=frame_time)
    return Motion(SKELETON, q, still.translations, frame_time)


def scipy(motion):
    return Rotation.from_quat(motion.rotations.reshape(-1, 4)[:, [1, 2, 3, 0]])


def largest(turns, first=0):
    """Return the largest step of each joint and the frame into which it is, from (F J) rotations."""
    matrices = turns.as_matrix().reshape(20, len(SKELETON), 3, 3)
    steps = np.swapaxes(matrices[:-1], -1, -2) @ matrices[1:]
    angles = np.degrees(Rotation.from_matrix(steps.reshape(-1, 3, 3)).magnitude()).reshape(19, -1)[first:]
    return angles.max(axis=0), angles.argmax(axis=0) + first + 1


@pytest.mark.parametrize("first", [0, 7])
def test_a_motions_own_steps_are_those_of_scipy(first):
    motion = turning(5.0)
    found = own_steps(motion, first=first)
    angles, frames = largest(scipy(motion), first)
    np.testing.assert_allclose(found.degrees, angles, rtol=1e-9)
    np.testing.assert_array_equal(found.frames, frames)


def test_the_change_is_the_inverse_of_the_input_times_the_output():
    before, after = turning(5.0), turning(4.0, seed=9)
    found = change_steps(before, after, first=0)
    angles, frames = largest(scipy(before).inv() * scipy(after))
    np.testing.assert_allclose(found.degrees, angles, rtol=1e-9)
    np.testing.assert_array_equal(found.frames, frames)


def test_a_step_is_told_at_60_hz():
    # 12 degrees in a 120th of a second are 24 in a 60th, in a 30th 6.
    for rate, degrees in ((60.0, 12.0), (120.0, 24.0), (30.0, 6.0)):
        motion = standing(SKELETON, frame_time=1.0 / rate)
        edited = with_rotation(motion, "LeftArm", slice(8, None), [0.0, 0.0, np.radians(12.0)])
        found = change_steps(motion, edited, first=0)
        assert found.degrees[ARM] == pytest.approx(degrees)
        assert (found.joint, found.frames[ARM]) == (ARM, 8)


def test_a_change_that_stays_does_not_step_and_nothing_steps_in_no_change():
    motion = turning(5.0)
    turned = motion.rotations.copy()
    turned[:, HEAD] = rot.multiply(turned[:, HEAD], rot.exp(np.array([0.5, 0.2, 0.0])))
    found = change_steps(motion, Motion(SKELETON, turned, motion.translations, motion.frame_time), first=0)
    assert found.joint is None
    assert change_steps(motion, motion, first=0).degrees.max() == 0.0


def test_the_step_out_of_a_rest_pose_does_not_count():
    edited = with_rotation(standing(SKELETON), "LeftArm", slice(1, None), [0.0, 0.0, 1.0])
    assert own_steps(edited, first=1).joint is None
    assert own_steps(edited, first=0).joint == ARM


def test_one_frame_has_no_steps():
    assert own_steps(standing(SKELETON, frames=1), first=0).joint is None
