"""A motion is made of channel values: any order, positions on any joint, axes left to OFFSET."""

from dataclasses import replace

import numpy as np
import pytest
from channels import motion_from_channels
from scipy.spatial.transform import Rotation

from motionedit.core import motion as module
from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward
from motionedit.core.motion import position_columns, scaled
from motionedit.core.skeleton import EndSite, Skeleton

SKELETON = Skeleton(
    names=("Root", "Arm", "Fixed", "Hinge", "Rail"),
    parents=np.array([-1, 0, 1, 1, 0]),
    offsets=np.arange(15.0).reshape(5, 3),
    channels=(
        ("Zrotation", "Xposition", "Xrotation", "Yposition", "Yrotation", "Zposition"),
        ("Yrotation", "Zrotation", "Xrotation"),
        (),
        ("Xrotation",),
        ("Zposition", "Xposition"),
    ),
)
VALUES = np.random.default_rng(3).uniform(-200.0, 200.0, size=(50, 12))


@pytest.fixture
def motion():
    return motion_from_channels(SKELETON, VALUES, frame_time=0.02)


def test_rotations_follow_the_channel_order_of_each_joint(motion):
    def off(joint, order, columns):
        theirs = Rotation.from_euler(order, VALUES[:, columns], degrees=True).as_quat(scalar_first=True)
        return rot.angle_between(motion.rotations[:, joint], theirs).max()

    assert off(0, "ZXY", [0, 2, 4]) < 1e-14
    assert off(1, "YZX", [6, 7, 8]) < 1e-14
    assert off(3, "X", [9]) < 1e-14


def test_joints_without_rotation_channels_do_not_turn(motion):
    for joint in (2, 4):
        np.testing.assert_array_equal(motion.rotations[:, joint], np.tile(rot.IDENTITY, (50, 1)))


def test_a_position_channel_replaces_that_axis_of_the_offset(motion):
    np.testing.assert_array_equal(motion.translations[:, 0], VALUES[:, [1, 3, 5]])
    np.testing.assert_array_equal(motion.translations[:, 1, [0, 2]], VALUES[:, [11, 10]])
    np.testing.assert_array_equal(motion.translations[:, 1, 1], SKELETON.offsets[4, 1])
    assert position_columns(SKELETON, 4) == [(2, 10), (0, 11)]


def test_rate_and_duration_come_from_the_frame_time(motion):
    assert len(motion) == 50
    assert motion.frame_rate == 50.0
    assert motion.duration == pytest.approx(0.98)


def test_blocks_of_frames_make_no_difference(motion, monkeypatch):
    monkeypatch.setattr(module, "_BLOCK_VALUES", 60)
    np.testing.assert_allclose(
        motion_from_channels(SKELETON, VALUES, frame_time=0.02).rotations, motion.rotations, atol=1e-15
    )


def test_a_motion_is_read_only(motion):
    with pytest.raises(ValueError, match="read-only"):
        motion.rotations[0, 0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        motion.translations[0, 0, 0] = 1.0


def test_a_scaled_motion_is_the_same_in_another_unit(motion):
    site = EndSite(4, np.array([1.0, 2.0, 3.0]))
    whole = replace(motion, skeleton=replace(motion.skeleton, end_sites=(site,)))
    small = scaled(whole, 0.01)
    np.testing.assert_allclose(forward(small).positions, 0.01 * forward(whole).positions, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(forward(small).rotations, forward(whole).rotations)
    np.testing.assert_array_equal(small.skeleton.end_sites[0].offset, 0.01 * site.offset)
    assert (small.frame_time, small.skeleton.names) == (whole.frame_time, whole.skeleton.names)
    np.testing.assert_array_equal(site.offset, [1.0, 2.0, 3.0])
