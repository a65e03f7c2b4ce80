import time

import numpy as np
import pytest
from human import (
    ARMS,
    BONES,
    CHANNELS,
    ENDS,
    LEGS,
    SHANK,
    THIGH,
    above,
    arms_of,
    assert_human,
    legs_of,
    names_of,
    skeleton_of,
    split,
    standing,
)
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import forward
from motionedit.core.skeleton import EndSite, Skeleton

# y up becomes z up, forward becomes -y.
Z_UP = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
MIRROR = np.diag([-1.0, 1.0, 1.0])


def test_a_human_has_legs_arms_and_a_head():
    skeleton = skeleton_of()
    assert_human(skeleton, find_anatomy(skeleton))


def test_leg_length_is_thigh_to_ankle_and_height_the_longest_path_between_ends():
    anatomy = find_anatomy(skeleton_of())
    toe = np.hypot(0.06, 0.13) + 0.06
    leg = np.hypot(0.1, 0.05) + THIGH + SHANK + toe
    arm = np.hypot(0.05, 0.15) + 0.12 + 0.29 + 0.25 + 0.15
    assert anatomy.leg_length == pytest.approx(THIGH + SHANK)
    assert anatomy.height == pytest.approx(leg + 0.3 + arm)


def test_lengths_follow_the_unit_of_the_file():
    anatomy, centimetres = find_anatomy(skeleton_of()), find_anatomy(skeleton_of(scale=100.0))
    assert centimetres.leg_length == pytest.approx(100.0 * anatomy.leg_length)
    assert centimetres.height == pytest.approx(100.0 * anatomy.height)


def test_names_without_meaning_change_nothing_but_take_the_side_from_the_toes():
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    skeleton = skeleton_of(rename=names.get)
    assert find_anatomy(skeleton) == find_anatomy(skeleton_of())


def test_a_mirrored_skeleton_without_names_swaps_its_sides():
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    plain = find_anatomy(skeleton_of(rename=names.get))
    mirrored = find_anatomy(skeleton_of(rename=names.get, turn=MIRROR))
    assert mirrored.legs == plain.legs[::-1]
    assert mirrored.arms == plain.arms[::-1]


def test_a_mirrored_skeleton_with_names_keeps_to_its_names():
    skeleton = skeleton_of(turn=MIRROR)
    assert_human(skeleton, find_anatomy(skeleton))


def test_poses_tell_the_side_where_offsets_all_point_along_their_own_bone():
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    skeleton = skeleton_of(rename=names.get)
    motion = standing(skeleton)
    # The poses are given mirrored: left is where they say, not where OFFSET does.
    poses = forward(motion)
    mirrored = type(poses)(poses.positions * np.array([-1.0, 1.0, 1.0]), poses.rotations)
    assert find_anatomy(skeleton, poses=mirrored).legs == find_anatomy(skeleton).legs[::-1]


def test_without_names_and_toes_the_order_of_the_file_is_taken_with_a_warning():
    bones = [row for row in BONES if "Toe" not in row[0]]
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(bones)}
    anatomy = find_anatomy(skeleton_of(bones, rename=names.get))
    assert anatomy.legs[0].toe is None
    assert any("left from right" in line for line in anatomy.warnings)


def test_a_static_root_above_the_hips_is_no_part_of_the_body():
    plain = find_anatomy(skeleton_of())
    skeleton = skeleton_of(above(BONES, "joint_Root", offset=(0.0, 0.0, 0.0)))
    anatomy = find_anatomy(skeleton)
    assert_human(skeleton, anatomy)
    assert (anatomy.leg_length, anatomy.height) == (plain.leg_length, plain.height)


def test_bones_cut_by_twist_joints_add_up():
    bones = split(BONES, "LeftLeg", "LeftTwist", 0.2)
    bones = split(bones, "RightLeg", "RightTwist", 0.2)
    bones = split(bones, "LeftFoot", "LeftCalfTwist", 0.5)
    bones = split(bones, "RightFoot", "RightCalfTwist", 0.5)
    skeleton = skeleton_of(bones)
    anatomy = find_anatomy(skeleton)
    assert_human(skeleton, anatomy)
    assert anatomy.leg_length == pytest.approx(THIGH + SHANK)


def test_twist_joints_beside_the_bones_are_left_alone():
    bones = [*BONES]
    for side in ("Left", "Right"):
        bones += [
            (side + "CalfTwist", side + "Leg", (0.0, 0.0, 0.0)),
            (side + "CalfTwist2", side + "CalfTwist", (0.0, -0.5 * SHANK, 0.0)),
        ]
    skeleton = skeleton_of(bones)
    assert_human(skeleton, find_anatomy(skeleton))


def test_a_club_in_one_hand_changes_no_joint():
    skeleton = skeleton_of([*BONES, ("Club", "RightHand", (0.0, 0.0, 0.0))], {**ENDS, "Club": (0.0, -0.92, 0.0)})
    assert_human(skeleton, find_anatomy(skeleton))


def test_digits_are_wrists_hands_and_toes():
    bones = [*BONES, ("LeftThumb", "LeftHand", (0.03, 0.0, 0.0)), ("RightThumb", "RightHand", (-0.03, 0.0, 0.0))]
    skeleton = skeleton_of(bones)
    digits = {skeleton.names[j] for j in find_anatomy(skeleton).digits}
    assert digits == {side + part for side in ("Left", "Right") for part in ("Hand", "Thumb", "ToeBase")}


def test_a_root_in_the_chest_leaves_legs_legs():
    # The same body hung up at Spine1: the spine goes down from it.
    flipped = {"Hips": ("Spine", (0.0, -0.1, 0.0)), "Spine": ("Spine1", (0.0, -0.2, 0.0)), "Spine1": (None, (0, 0, 0))}
    rows = {name: (parent, offset) for name, parent, offset in BONES} | flipped
    order = ["Spine1", "Spine", "Hips", *(name for name, _, _ in BONES if name not in flipped)]
    skeleton = skeleton_of([(name, *rows[name]) for name in order])
    assert_human(skeleton, find_anatomy(skeleton))


def test_a_tail_longer_than_the_neck_leaves_legs_legs():
    tail = [(f"Tail{i}", f"Tail{i - 1}" if i else "Hips", (0.0, 0.0, -0.3)) for i in range(3)]
    skeleton = skeleton_of([*BONES, *tail])
    assert legs_of(skeleton, find_anatomy(skeleton)) == LEGS


def test_arms_alone_are_arms_by_their_names():
    bones = [row for row in BONES if "Leg" not in row[0] and "Foot" not in row[0] and "Toe" not in row[0]]
    bones = [row for row in bones if "HipJoint" not in row[0]]
    skeleton = skeleton_of(bones)
    anatomy = find_anatomy(skeleton)
    assert anatomy.legs is None
    assert arms_of(skeleton, anatomy) == ARMS
    assert anatomy.leg_length == pytest.approx(0.5 * anatomy.height)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_chain_has_no_legs_and_half_its_height_stands_for_them(count):
    skeleton = Skeleton(
        names=tuple(f"link{i}" for i in range(count)),
        parents=np.arange(-1, count - 1),
        offsets=np.array([[0.0, 0.0, 0.0]] + [[0.0, 2.0, 0.0]] * (count - 1)),
        channels=(CHANNELS,) * count,
        end_sites=(EndSite(count - 1, np.array([0.0, 2.0, 0.0])),),
    )
    anatomy = find_anatomy(skeleton)
    assert (anatomy.legs, anatomy.arms, anatomy.head) == (None, None, None)
    assert anatomy.height == pytest.approx(2.0 * count)
    assert anatomy.leg_length == pytest.approx(count)
    assert any("no legs" in line for line in anatomy.warnings)


def test_a_skeleton_of_no_size_is_no_error():
    skeleton = Skeleton(
        names=("a", "b", "c"), parents=np.array([-1, 0, 0]), offsets=np.zeros((3, 3)), channels=((),) * 3
    )
    anatomy = find_anatomy(skeleton)
    assert anatomy.legs is None
    assert anatomy.height == 0.0


def test_axes_of_the_file_do_not_matter():
    skeleton = skeleton_of(turn=Z_UP)
    assert_human(skeleton, find_anatomy(skeleton))


def test_hip_joints_and_collars_that_start_at_the_spine_are_no_thighs_and_no_shoulders():
    # Proportions as in CMU's subject 12: a thigh much shorter than the shank, a forearm of half an upper arm.
    offsets = {
        "UpLeg": (0.2, -0.16, 0.11), "Leg": (0.2, -0.56, 0.0), "Foot": (0.27, -0.75, 0.0),
        "ToeBase": (0.01, -0.02, 0.2), "Shoulder": (0.0, 0.0, 0.0), "Arm": (0.36, 0.08, -0.04),
        "ForeArm": (0.49, 0.0, 0.0),
        "Hand": (0.27, 0.0, 0.0),
    }  # fmt: skip
    bones = []
    for name, parent, offset in BONES:
        part = name.removeprefix("Left").removeprefix("Right")
        x, y, z = offsets.get(part, offset)
        bones.append((name, parent, (-x if name.startswith("Right") else x, y, z)))
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        bones += [
            (side + "FingerBase", side + "Hand", (0.0, 0.0, 0.0)),
            (side + "Index", side + "FingerBase", (sign * 0.07, 0.0, 0.0)),
            (side + "Thumb", side + "Hand", (0.0, 0.0, 0.0)),
        ]
    skeleton = skeleton_of(bones, {"LeftIndex": (0.05, 0, 0), "RightIndex": (-0.05, 0, 0), "Head": (0, 0.18, 0)})
    assert_human(skeleton, find_anatomy(skeleton))


@given(st.lists(st.floats(0.9, 1.1), min_size=len(BONES), max_size=len(BONES)))
def test_bones_a_tenth_longer_or_shorter_on_either_side_change_nothing(factors):
    bones = [
        (name, parent, tuple(factor * x for x in offset))
        for factor, (name, parent, offset) in zip(factors, BONES, strict=True)
    ]
    skeleton = skeleton_of(bones)
    assert_human(skeleton, find_anatomy(skeleton))


@pytest.mark.parametrize(("factor", "found"), [(0.75, True), (1.3, True), (1.8, False)])
@pytest.mark.parametrize("bone", ["LeftLeg", "RightFoot"])
def test_without_names_twins_are_alike_in_length(bone, factor, found):
    bones = [(n, parent, tuple(factor * x for x in o) if n == bone else o) for n, parent, o in BONES]
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    legs = find_anatomy(skeleton_of(bones, rename=names.get)).legs
    thighs = [names[side + "UpLeg"] for side in ("Left", "Right")]
    assert (
        legs is not None and [names_of(skeleton_of(bones, rename=names.get), (leg.thigh,))[0] for leg in legs] == thighs
    ) is found


@st.composite
def trees(draw):
    count = draw(st.integers(1, 25))
    parents = [-1] + [draw(st.integers(0, j - 1)) for j in range(1, count)]
    lengths = st.sampled_from([0.0, 1e-6, 0.5, 1.0, 1.1, 1e6])
    offsets = np.array([[draw(lengths), draw(lengths), draw(lengths)] for _ in range(count)])
    names = [draw(st.sampled_from(["a", "LeftLeg", "RightLeg", "hand.L", "hand.R", ""])) for _ in range(count)]
    return Skeleton(tuple(names), np.array(parents), offsets, (CHANNELS,) * count)


@given(trees())
def test_no_tree_is_an_error(skeleton):
    anatomy = find_anatomy(skeleton)
    assert anatomy.leg_length >= 0.0
    assert anatomy.height >= anatomy.leg_length
    assert (anatomy.legs is None) == any("no legs" in line for line in anatomy.warnings)
    assert all("; body: in a spec says which " in line for line in (*anatomy.warnings, *anatomy.missing))


@pytest.mark.parametrize("links", [600, 2000])
def test_two_long_ropes_side_by_side_are_looked_at_in_no_time(links):
    parents = [-1, 0, 0, *range(1, 2 * links - 1)]
    offsets = np.tile([[0.0, 1.0, 0.0]], (2 * links + 1, 1))
    names = tuple(f"link{j}" for j in range(2 * links + 1))
    skeleton = Skeleton(names, np.array(parents), offsets, ((),) * len(names))
    start = time.process_time()
    find_anatomy(skeleton)
    assert time.process_time() - start < 2.0
