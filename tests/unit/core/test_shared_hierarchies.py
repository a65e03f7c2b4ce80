"""Files with one hierarchy share one skeleton; every other file is parsed, and refused, by itself."""

import numpy as np
import pytest

from motionedit.core.bvh import parse_clip
from motionedit.errors import BvhError

TEXT = b"""HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  End Site
  {
    OFFSET 0 1 0
  }
}
MOTION
Frames: 1
Frame Time: 0.1
1 2 3
"""


def test_files_with_the_same_hierarchy_share_the_skeleton_and_nothing_else():
    first = parse_clip(TEXT, label="a.bvh")
    second = parse_clip(TEXT.replace(b"0.1", b"0.25").replace(b"1 2 3", b"4 5 6"), label="b.bvh")
    assert second.motion.skeleton is first.motion.skeleton
    assert (first.motion.frame_time, second.motion.frame_time) == (0.1, 0.25)
    np.testing.assert_array_equal(second.values, [[4, 5, 6]])


def test_a_hierarchy_that_differs_in_one_byte_is_another():
    first = parse_clip(TEXT, label="a.bvh").motion.skeleton
    second = parse_clip(TEXT.replace(b"0 1 0", b"0 2 0"), label="b.bvh").motion.skeleton
    assert [first.end_sites[0].offset[1], second.end_sites[0].offset[1]] == [1, 2]


@pytest.mark.parametrize("label", ["a.bvh", "b.bvh"])
def test_a_fault_is_said_with_its_own_file_each_time(label):
    with pytest.raises(BvhError, match="OFFSET") as caught:
        parse_clip(TEXT.replace(b"0 1 0", b"0 1"), label=label)
    assert (caught.value.file, caught.value.line) == (label, 8)


def test_a_joint_called_motion_is_no_end_of_the_hierarchy():
    text = TEXT.replace(b"ROOT Hips", b"ROOT\nMOTION\n").replace(b"{\n  OFFSET 0 0", b"\n{\n  OFFSET 0 0", 1)
    plain = TEXT.replace(b"Hips", b"MOTION")
    assert parse_clip(plain, label="a.bvh").motion.skeleton.names == ("MOTION",)
    with pytest.raises(BvhError):
        parse_clip(text, label="b.bvh")
