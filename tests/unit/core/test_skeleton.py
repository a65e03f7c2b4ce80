"""The skeleton knows its tree, its channels and where they stand in a row."""

import pickle

import numpy as np
import pytest

from motionedit.core.skeleton import EndSite, Skeleton, same_skeleton
from motionedit.dataclass import replace

#        0
#      /   \
#     1     4
#    / \    |
#   2   3   5
PARENTS = np.array([-1, 0, 1, 1, 0, 4])


@pytest.fixture
def skeleton():
    return Skeleton(
        names=("Root", "A", "Same", "Same", "B", "Tip"),
        parents=PARENTS,
        offsets=np.arange(18.0).reshape(6, 3),
        channels=(
            ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"),
            ("Zrotation", "Xrotation", "Yrotation"),
            (),
            ("Xrotation", "Zposition", "Yrotation"),
            ("Zrotation", "Xrotation", "Yrotation"),
            ("Yrotation",),
        ),
        end_sites=(EndSite(5, np.array([0.0, 0.5, 0.0])),),
    )


def test_rows_are_laid_out_joint_by_joint(skeleton):
    assert len(skeleton) == 6
    assert skeleton.channel_count == 16
    assert skeleton.channel_starts.tolist() == [0, 6, 9, 9, 12, 15]
    assert skeleton.columns(3, "rotation") == [9, 11]
    assert skeleton.columns(3, "position") == [10]


def test_axes_are_in_channel_order(skeleton):
    assert skeleton.rotation_axes == ((2, 0, 1), (2, 0, 1), (), (0, 1), (2, 0, 1), (1,))
    assert skeleton.position_axes[3] == (2,)
    assert skeleton.translated.tolist() == [0, 3]


def test_joints_with_the_same_axes_are_grouped(skeleton):
    groups = {group.axes: (group.joints.tolist(), group.columns.tolist()) for group in skeleton.rotation_groups}
    assert groups == {
        (2, 0, 1): ([0, 1, 4], [[3, 4, 5], [6, 7, 8], [12, 13, 14]]),
        (0, 1): ([3], [[9, 11]]),
        (1,): ([5], [[15]]),
    }


def test_levels_children_and_chains_follow_the_tree(skeleton):
    assert [level.tolist() for level in skeleton.levels] == [[0], [1, 4], [2, 3, 5]]
    assert skeleton.children == ((1, 4), (2, 3), (), (), (5,), ())
    assert skeleton.chain(3).tolist() == [0, 1, 3]
    assert skeleton.chain(0).tolist() == [0]


def test_the_level_order_makes_each_level_a_slice(skeleton):
    walk = skeleton.level_order
    assert walk.joints.tolist() == [0, 1, 4, 2, 3, 5]
    assert walk.parents.tolist() == [0, 0, 0, 1, 1, 2]
    assert walk.levels == ((1, 3), (3, 6))


def test_a_repeated_name_has_several_joints(skeleton):
    assert skeleton.indices("Same") == (2, 3)
    assert skeleton.indices("Tip") == (5,)
    assert skeleton.indices("None") == ()


def test_a_lone_root_is_a_skeleton():
    alone = Skeleton(("R",), np.array([-1]), np.zeros((1, 3)), (("Xrotation",),))
    assert [level.tolist() for level in alone.levels] == [[0]]
    assert alone.level_order.levels == ()


def sent(thing):
    return pickle.loads(pickle.dumps(thing))  # noqa: S301  our own


def test_what_another_process_sends_is_one_skeleton_with_the_same_joints(skeleton):
    mine = sent(skeleton)
    assert sent(skeleton) is mine
    assert same_skeleton(mine, skeleton)
    assert mine.names == skeleton.names
    for theirs, ours in zip(mine.end_sites, skeleton.end_sites, strict=True):
        assert theirs.joint == ours.joint
        np.testing.assert_array_equal(theirs.offset, ours.offset)
    assert not mine.offsets.flags.writeable
    assert not same_skeleton(sent(replace(skeleton, offsets=skeleton.offsets + 1.0)), mine)
