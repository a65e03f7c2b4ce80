"""Heads and feet of a body, what a foot stands on, and what of a body is missing."""

from dataclasses import replace

import numpy as np
from human import ARMS, BONES, ENDS, LEGS, arms_of, assert_human, legs_of, skeleton_of, split

from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.skeleton import EndSite


def test_a_foot_of_five_toes_gives_the_same_toe_on_both_sides():
    bones = [row for row in BONES if "ToeBase" not in row[0]]
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        # In another order on each side, as some exporters write them.
        order = (0, 1, 2) if sign > 0 else (2, 0, 1)
        lengths = (0.13, 0.14, 0.12)
        bones += [(f"{side}Toe{i}", side + "Foot", (sign * 0.01 * i, -0.06, lengths[i])) for i in order]
    skeleton = skeleton_of(bones)
    legs = legs_of(skeleton, find_anatomy(skeleton))
    assert [leg[3] for leg in legs] == ["LeftToe1", "RightToe1"]


def test_a_metatarsal_is_no_toe():
    bones = split(BONES, "LeftToeBase", "LeftMetatarsal", 0.4)
    bones = split(bones, "RightToeBase", "RightMetatarsal", 0.4)
    skeleton = skeleton_of(bones)
    assert legs_of(skeleton, find_anatomy(skeleton)) == LEGS


def test_a_toe_has_no_longer_tips_than_the_way_to_it():
    bones = [*BONES, ("LeftToeTip", "LeftToeBase", (0, 0, 0.05)), ("RightToeTip", "RightToeBase", (0, 0, 0.05))]
    skeleton = skeleton_of(bones, {})
    assert legs_of(skeleton, find_anatomy(skeleton)) == LEGS


def test_breasts_are_no_neck_and_eyes_no_limbs():
    bones = [*BONES]
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        bones += [
            (side + "Breast", "Spine1", (sign * 0.1, 0.1, 0.7)),
            (side + "Eye", "Head", (sign * 0.03, 0.1, 0.1)),
        ]
    skeleton = skeleton_of(bones)
    anatomy = find_anatomy(skeleton)
    assert_human(skeleton, anatomy)
    assert {skeleton.names.index("LeftEye"), skeleton.names.index("RightEye")} <= anatomy.digits


def test_the_joint_at_the_top_of_the_head_is_not_the_head():
    skeleton = skeleton_of([*BONES, ("HeadTop_End", "Head", (0.0, 0.18, 0.0))])
    assert skeleton.names[find_anatomy(skeleton).head] == "Head"


def test_a_body_without_a_head_has_none():
    skeleton = skeleton_of([row for row in BONES if row[0] not in ("Neck", "Head")])
    anatomy = find_anatomy(skeleton)
    assert anatomy.head is None
    assert legs_of(skeleton, anatomy) == LEGS
    assert arms_of(skeleton, anatomy) == ARMS


def test_legs_alone_have_for_a_head_the_end_of_what_stands_on_them():
    skeleton = skeleton_of(
        [row for row in BONES if "Shoulder" not in row[0] and "Arm" not in row[0] and "Hand" not in row[0]]
    )
    anatomy = find_anatomy(skeleton)
    assert anatomy.arms is None
    assert legs_of(skeleton, anatomy) == LEGS
    assert skeleton.names[anatomy.head] == "Head"


def test_a_foot_stands_on_its_heel_and_its_toe():
    skeleton = skeleton_of()
    points = find_anatomy(skeleton).sole_points
    found = [(point.foot, point.part, skeleton.names[point.joint], point.offset) for point in points]
    assert found == [
        (side.lower(), part, side + joint, (0.0, 0.0, 0.0))
        for side in ("Left", "Right")
        for part, joint in (("heel", "Foot"), ("toe", "ToeBase"))
    ]


def test_a_foot_without_a_toe_stands_on_its_farthest_end_site():
    skeleton = skeleton_of(
        [row for row in BONES if "Toe" not in row[0]],
        {"LeftFoot": (0.0, -0.06, 0.19), "RightFoot": (0.0, -0.06, 0.19), "Head": ENDS["Head"]},
    )
    sites = (*skeleton.end_sites, EndSite(skeleton.names.index("LeftFoot"), np.array([0.0, -0.05, -0.06])))
    anatomy = find_anatomy(replace(skeleton, end_sites=sites))
    assert [leg.toe for leg in anatomy.legs] == [None, None]
    assert [leg.tip for leg in anatomy.legs] == [(0.0, -0.06, 0.19)] * 2
    toes = [point for point in anatomy.sole_points if point.part == "toe"]
    assert [(point.foot, skeleton.names[point.joint]) for point in toes] == [
        ("left", "LeftFoot"),
        ("right", "RightFoot"),
    ]
    np.testing.assert_array_equal(toes[0].effector.offset, [0.0, -0.06, 0.19])


def test_a_foot_of_nothing_but_an_ankle_stands_on_that():
    skeleton = skeleton_of([row for row in BONES if "Toe" not in row[0]], {"Head": ENDS["Head"]})
    assert [point.part for point in find_anatomy(skeleton).sole_points] == ["heel", "heel"]


def test_a_whole_body_misses_nothing_and_half_a_body_says_what_and_what_that_means():
    assert find_anatomy(skeleton_of()).missing == ()
    no_arms = [row for row in BONES if not any(part in row[0] for part in ("Shoulder", "Arm", "Hand"))]
    (line,) = find_anatomy(skeleton_of(no_arms)).missing
    assert line.startswith("no arms found: elbows are no hinges")
    (line,) = find_anatomy(skeleton_of([row for row in BONES if row[0] not in ("Neck", "Head")])).missing
    assert line.startswith("no head found: ")
    assert "body: in a spec" in line


def test_a_toe_on_one_side_only_is_none_of_the_anatomy_of_the_other():
    skeleton = skeleton_of([row for row in BONES if row[0] != "RightToeBase"])
    legs = find_anatomy(skeleton).legs
    assert (legs[0].toe, legs[1].toe) == (skeleton.names.index("LeftToeBase"), None)
