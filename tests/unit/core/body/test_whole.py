"""The joints that turn a whole body, whatever stands above its hips."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, above, skeleton_of, standing

from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.limits import human_limits
from motionedit.core.body.ranges import regions_of
from motionedit.core.body.stiffness import CARRIER, PELVIS, human_mobility
from motionedit.core.body.whole import whole_joints
from motionedit.core.kinematics import forward

WALKING = above(above(BONES, "Root"), "Reference")
WITHOUT_LEGS = [row for row in BONES if not any(part in row[0] for part in ("Leg", "Foot", "Toe"))]
PELVIS_ROWS = [
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("Pelvis", "Hips", (0.0, 0.0, 0.0)),
    *((name, "Pelvis" if name.endswith("HipJoint") else parent, at) for name, parent, at in BONES[1:]),
]


def whole_of(rows, travel):
    skeleton = skeleton_of(rows)
    joints = whole_joints(skeleton, find_anatomy(skeleton), travel=skeleton.names.index(travel))
    return [skeleton.names[j] for j in joints]


@pytest.mark.parametrize(
    ("rows", "travel", "expected"),
    [
        (BONES, "Hips", ["Hips"]),
        (WALKING, "Reference", ["Reference", "Root", "Hips"]),
        (WALKING, "Root", ["Root", "Hips"]),
        (WALKING, "Hips", ["Hips"]),
        (PELVIS_ROWS, "Hips", ["Hips"]),
        (
            [row for row in BONES if "Leg" not in row[0] and "Foot" not in row[0] and "Toe" not in row[0]],
            "Hips",
            ["Hips"],
        ),
    ],
)
def test_a_body_turns_by_what_is_from_the_travel_down_to_its_hips(rows, travel, expected):
    assert whole_of(rows, travel) == expected


def test_hips_below_a_root_that_walks_turn_as_those_without_and_are_no_part_of_the_spine():
    plain, walking = skeleton_of(), skeleton_of(above(BONES, "Root"))
    read = []
    for skeleton in (plain, walking):
        anatomy = find_anatomy(skeleton)
        mobility = dict(zip(skeleton.names, human_mobility(skeleton, anatomy, travel=0).tolist(), strict=True))
        motion = standing(skeleton)
        limits = human_limits(motion, forward(motion), anatomy, travel=0, first=0)
        rows = zip(limits.joints.tolist(), limits.swing.tolist(), limits.twist.tolist(), strict=True)
        regions = regions_of(skeleton, anatomy, travel=0)
        names = {(skeleton.names[one.lower], skeleton.names[one.upper], one.most) for one in regions}
        read.append([mobility, {skeleton.names[j]: half for j, *half in rows}, names])
    assert read[1][0].pop("Root") == CARRIER
    assert read[0][0]["Hips"] == PELVIS
    assert read[0] == read[1]


def test_a_body_whose_hips_do_not_turn_turns_by_what_carries_it():
    skeleton = skeleton_of(above(BONES, "Root"))
    still = replace(skeleton, channels=(skeleton.channels[0], (), *skeleton.channels[2:]))
    assert human_mobility(still, find_anatomy(still), travel=0)[0] == PELVIS


def test_spines_share_alike_whatever_stands_above_the_hips():
    found = [human_mobility(each, find_anatomy(each), travel=0) for each in map(skeleton_of, (BONES, WALKING))]
    np.testing.assert_array_equal(found[1][2:], found[0])
