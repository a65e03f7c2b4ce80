"""Which joint carries the travel, and what the bones are where position channels stand for OFFSETs."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, CHANNELS, ROOT_CHANNELS, above, skeleton_of, standing

from motionedit.core.body.bones import below, bones_of, travel_joint
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.motion import Motion
from motionedit.core.skeleton import Skeleton


def under_a_root(*, root=ROOT_CHANNELS, offset=(0.0, 0.0, 0.0)):
    """Return a body whose hips have position channels and hang on a root with the given channels."""
    skeleton = skeleton_of(above(BONES, "joint_Root"))
    offsets = skeleton.offsets.copy()
    offsets[1] = offset
    return replace(skeleton, channels=(root, ROOT_CHANNELS, *skeleton.channels[2:]), offsets=offsets)


def moved(skeleton, paths, *, frames=20):
    """Return a motion in which joints with position channels go along paths (F, 3), the others stay at their OFFSET."""
    translations = np.tile(skeleton.offsets[skeleton.translated], (frames, 1, 1))
    for joint, path in paths.items():
        translations[:, skeleton.translated.tolist().index(skeleton.names.index(joint))] = path
    return Motion(skeleton, standing(skeleton, frames).rotations, translations, 0.01)


def six_channels():
    """Return the body with six channels on every joint."""
    skeleton = skeleton_of()
    return replace(skeleton, channels=(ROOT_CHANNELS,) * len(skeleton))


WAY = np.linspace([0.0, 1.0, 0.0], [0.0, 1.0, 2.0], 20)


def test_travel_is_carried_by_the_joint_that_moves_below_a_static_root():
    skeleton = under_a_root()
    jitter = np.stack((1e-4 * np.arange(20), np.zeros(20), np.zeros(20)), axis=1)
    motion = moved(skeleton, {"joint_Root": jitter, "Hips": WAY})
    assert skeleton.names[travel_joint(motion)] == "Hips"
    assert skeleton.names[travel_joint(moved(skeleton, {"joint_Root": WAY, "Hips": jitter}))] == "joint_Root"


def test_of_two_that_move_the_one_nearer_to_the_root_carries_the_travel():
    skeleton = under_a_root()
    assert travel_joint(moved(skeleton, {"joint_Root": WAY, "Hips": 0.1 * WAY})) == 0


def test_travel_of_a_clip_that_stands_still_is_at_the_first_joint_with_positions():
    assert travel_joint(standing(skeleton_of())) == 0
    skeleton = Skeleton(("a", "b", "c"), np.array([-1, 0, 1]), np.zeros((3, 3)), ((), ROOT_CHANNELS, ()))
    assert travel_joint(standing(skeleton)) == 1
    still = Skeleton(("a", "b"), np.array([-1, 0]), np.zeros((2, 3)), ((), ()))
    assert travel_joint(standing(still)) == 0


@pytest.mark.parametrize("joint", ["Head", "LeftHand", "LeftUpLeg", "RightToeBase"])
def test_a_limb_that_is_stretched_farther_than_the_body_goes_carries_no_travel(joint):
    motion = moved(six_channels(), {joint: 3.0 * WAY, "Hips": 0.02 * WAY})
    assert travel_joint(motion) == 0


def test_without_position_channels_the_skeleton_is_its_own_bones_but_for_where_it_begins():
    skeleton = skeleton_of()
    assert bones_of(standing(skeleton), 0) is skeleton
    far = replace(skeleton, offsets=skeleton.offsets + np.where(np.arange(len(skeleton)) == 0, 7.0, 0.0)[:, None])
    np.testing.assert_array_equal(bones_of(standing(far), 0).offsets, skeleton.offsets)


def test_the_offset_of_a_root_and_of_what_carries_the_travel_is_no_bone():
    motion = moved(under_a_root(offset=(30.0, 400.0, -7.0)), {"Hips": WAY})
    bones = bones_of(motion, travel_joint(motion))
    np.testing.assert_array_equal(bones.offsets[:2], np.zeros((2, 3)))
    np.testing.assert_array_equal(bones.offsets[1:], skeleton_of().offsets)
    assert find_anatomy(bones).height == pytest.approx(find_anatomy(skeleton_of()).height)


def test_joints_that_do_not_hang_on_what_carries_the_travel_have_no_bones():
    rows = [*above(BONES, "World"), ("Target", "World", (5.0, 0.0, 0.0)), ("TargetEnd", "Target", (0.0, 2.0, 0.0))]
    skeleton = skeleton_of(rows)
    skeleton = replace(skeleton, channels=((), ROOT_CHANNELS, *skeleton.channels[2:]))
    motion = moved(skeleton, {"Hips": WAY})
    bones = bones_of(motion, travel_joint(motion))
    np.testing.assert_array_equal(bones.offsets[-2:], np.zeros((2, 3)))
    np.testing.assert_array_equal(bones.offsets[1:-2], skeleton_of().offsets)


@pytest.mark.parametrize("factor", [0.0, 0.5, -3.0])
def test_a_bone_is_what_the_rows_say_whatever_the_offset(factor):
    plain = six_channels()
    rows = moved(plain, {"Hips": WAY})
    other = replace(plain, offsets=factor * plain.offsets)
    bones = bones_of(Motion(other, rows.rotations, rows.translations, rows.frame_time), 0)
    np.testing.assert_allclose(bones.offsets, plain.offsets, atol=1e-15)


def test_a_bone_is_the_median_of_the_rows_and_no_stretched_frame():
    motion = moved(six_channels(), {"Hips": WAY})
    translations = motion.translations.copy()
    translations[:9] += 5.0
    np.testing.assert_allclose(
        bones_of(replace(motion, translations=translations), 0).offsets, skeleton_of().offsets, atol=1e-15
    )
    translations[:11] += 5.0
    assert np.abs(bones_of(replace(motion, translations=translations), 0).offsets - skeleton_of().offsets).max() > 1.0


def test_rows_of_nothing_are_shifts_and_leave_the_offset_a_bone():
    motion = moved(six_channels(), {"Hips": WAY})
    translations = motion.translations.copy()
    translations[:, 1:] = 0.0
    assert bones_of(replace(motion, translations=translations), 0) is motion.skeleton


def test_motions_of_the_same_bones_share_one_skeleton():
    motion = moved(under_a_root(offset=(3.0, 4.0, 5.0)), {"Hips": WAY})
    again = replace(motion, translations=motion.translations[::-1])
    assert bones_of(motion, 1) is bones_of(again, 1)


def test_what_hangs_on_a_joint_is_all_below_it():
    skeleton = Skeleton(tuple("abcde"), np.array([-1, 0, 1, 0, 2]), np.zeros((5, 3)), (ROOT_CHANNELS, *(CHANNELS,) * 4))
    assert below(skeleton, 1).tolist() == [False, True, True, False, True]
    assert below(skeleton, 0).all()
