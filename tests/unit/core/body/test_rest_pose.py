import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.rest_pose import rest_pose_frames
from motionedit.core.motion import Motion


def frames_of(motion):
    return rest_pose_frames(motion, find_anatomy(motion.skeleton))


def swinging(angles, joint="LeftArm"):
    """Return a body that stands and turns one joint by angles (F,), rad, about the axis to the front."""
    motion = standing(skeleton_of(), frames=len(angles))
    rotations = motion.rotations.copy()
    rotations[:, motion.skeleton.names.index(joint)] = rot.about_axis(2, np.asarray(angles, dtype=float))
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


@pytest.mark.parametrize(
    ("joint", "first", "angle", "expected"),
    [
        ("LeftArm", 1, 1.4, 1),
        ("LeftArm", 2, 1.4, 2),
        ("LeftArm", 3, 1.4, 3),
        ("LeftArm", 4, 1.4, 0),  # too late: a defect, no rest pose
        ("LeftArm", 1, 0.59, 0),
        ("LeftArm", 1, 0.61, 1),
        ("LeftFoot", 1, 1.4, 1),  # an ankle counts
        ("LeftHand", 1, 1.4, 0),  # a wrist does not
        ("RightToeBase", 1, 1.4, 0),
        ("LeftArm", 0, 1.4, 0),
    ],
)
def test_a_rest_pose_ends_with_a_step_of_the_body_in_the_first_frames(joint, first, angle, expected):
    motion = with_rotation(standing(skeleton_of()), joint, slice(first, None), [0.0, 0.0, angle])
    assert frames_of(motion) == expected


def test_the_last_of_several_steps_ends_the_rest_pose():
    motion = with_rotation(standing(skeleton_of()), "LeftArm", slice(1, None), [0.0, 0.0, 1.4])
    motion = with_rotation(motion, "RightArm", slice(3, None), [0.0, 0.0, -1.4])
    assert frames_of(motion) == 3


@pytest.mark.parametrize("first", [0, 1, 2])
def test_an_arm_that_is_fast_throughout_a_clip_of_a_low_rate_makes_no_rest_pose(first):
    # 0.85 rad a frame at the most, in any phase: a swing of 1.2 rad to both sides at 12 Hz.
    assert frames_of(swinging(1.2 * np.sin(0.75 * np.arange(60) + first))) == 0


@pytest.mark.parametrize(("following", "expected"), [(0.3, 1), (0.32, 0)])
def test_a_step_that_is_not_three_times_the_next_is_a_motion_that_goes_on(following, expected):
    angles = np.cumsum([0.0, 0.93, following, *np.zeros(40)])
    assert frames_of(swinging(angles)) == expected


@pytest.mark.parametrize(("fast", "expected"), [(0.4, 1), (0.5, 0)])
def test_a_step_that_is_not_twice_what_the_joint_does_later_is_none(fast, expected):
    # The joint stands for a second and then swings for a third of the clip, as fast as it is given.
    steps = [0.0, 0.9, *np.zeros(40), *(fast * np.where(np.arange(20) % 2, 1.0, -1.0))]
    assert frames_of(swinging(np.cumsum(steps))) == expected


def test_one_defect_later_in_the_clip_does_not_make_the_first_step_usual():
    angles = np.cumsum([0.0, 1.4, *np.zeros(30), 1.4, -1.4, *np.zeros(60)])
    assert frames_of(swinging(angles)) == 1


def test_another_joint_that_is_fast_does_not_hide_the_rest_pose():
    motion = swinging(1.2 * np.sin(0.75 * np.arange(60)), joint="RightArm")
    motion = with_rotation(motion, "LeftArm", slice(1, None), [0.0, 0.0, 1.4])
    assert frames_of(motion) == 1


@pytest.mark.parametrize("count", [3, 4, 5, 6])
def test_a_clip_of_few_frames_may_have_a_rest_pose_but_one_of_two_has_none(count):
    motion = with_rotation(standing(skeleton_of(), frames=count), "LeftArm", slice(1, None), [0.0, 0.0, 1.4])
    assert frames_of(motion) == (0 if count == 2 else 1)


def test_of_two_frames_none_is_a_rest_pose():
    motion = with_rotation(standing(skeleton_of(), frames=2), "LeftArm", slice(1, None), [0.0, 0.0, 1.4])
    assert frames_of(motion) == 0


def test_a_rest_pose_in_front_of_a_long_clip_is_found():
    angles = 0.3 * np.sin(0.01 * np.arange(20_000)) + 1.4
    angles[0] = 0.0
    assert frames_of(swinging(angles)) == 1


def test_another_euler_branch_is_no_step():
    motion = standing(skeleton_of())
    rotations = motion.rotations.copy()
    rotations[1:] *= -1.0
    assert frames_of(Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)) == 0


def test_one_frame_has_no_rest_pose():
    assert frames_of(standing(skeleton_of(), frames=1)) == 0
