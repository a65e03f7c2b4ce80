"""How readily a human's joints give: the trunk, the neck and the shoulder girdle less than the limbs."""

import numpy as np
from human import BONES, skeleton_of, split

from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.stiffness import (
    CLAVICLE,
    HIP_GIRDLE,
    INSIDE_BONE,
    NECK,
    PELVIS,
    SPINE,
    WRIST_AND_ANKLE,
    human_mobility,
)

SKELETON = skeleton_of()


def mobility_of(skeleton):
    travel = skeleton.names.index("Hips")
    return dict(zip(skeleton.names, human_mobility(skeleton, find_anatomy(skeleton), travel=travel), strict=True))


def test_every_joint_has_the_mobility_of_its_part_of_the_body():
    found = mobility_of(SKELETON)
    expected = dict.fromkeys(SKELETON.names, 1.0) | {
        "Hips": PELVIS,
        "Spine": SPINE,
        "Spine1": SPINE,
        "Neck": NECK,
        "Head": NECK,
        "LHipJoint": HIP_GIRDLE,
        "RHipJoint": HIP_GIRDLE,
        "LeftShoulder": CLAVICLE,
        "RightShoulder": CLAVICLE,
        **dict.fromkeys(("LeftHand", "RightHand", "LeftFoot", "RightFoot"), WRIST_AND_ANKLE),
    }
    assert found == expected
    assert max(PELVIS, SPINE, NECK, CLAVICLE) < WRIST_AND_ANKLE < 1.0


def test_a_pelvis_on_which_both_legs_hang_gives_as_the_hips_do():
    bones = [("Hips", None, (0.0, 0.0, 0.0)), ("Pelvis", "Hips", (0.0, 0.0, 0.0))]
    bones += [(name, "Pelvis" if name.endswith("HipJoint") else parent, at) for name, parent, at in BONES[1:]]
    found = mobility_of(skeleton_of(bones))
    assert (found["Pelvis"], found["LHipJoint"], found["RHipJoint"]) == (PELVIS, HIP_GIRDLE, HIP_GIRDLE)


def test_no_limb_bends_in_the_middle_of_a_bone():
    bones, pieces = BONES, {"Leg": "UpLegRoll", "Foot": "LegRoll", "ForeArm": "ArmRoll", "Hand": "ForeArmRoll"}
    sides = ("Left", "Right")
    for side in sides:
        for end, piece in pieces.items():
            bones = split(bones, side + end, side + piece, 0.5)
    found = mobility_of(skeleton_of(bones))
    assert {found.pop(side + piece) for side in sides for piece in pieces.values()} == {INSIDE_BONE}
    assert found == mobility_of(SKELETON)


def test_names_do_not_matter():
    renamed = skeleton_of(rename=lambda name: "Hips" if name == "Hips" else f"x{[row[0] for row in BONES].index(name)}")
    np.testing.assert_array_equal(list(mobility_of(renamed).values()), list(mobility_of(SKELETON).values()))


def test_a_body_of_no_known_parts_gives_alike_but_where_it_travels():
    rope = skeleton_of([("Hips", None, (0, 0, 0)), ("A", "Hips", (0, 1, 0)), ("B", "A", (0, 1, 0))], {})
    found = mobility_of(rope)
    assert found.pop("Hips") == PELVIS
    assert set(found.values()) <= {1.0, SPINE, NECK}
