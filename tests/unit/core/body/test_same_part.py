"""Names that others give one part of a body."""

import pytest

from motionedit.core.body.same_part import same_part

MIXAMO = (
    *("Hips", "Spine", "Neck", "Head", "HeadTop_End"),
    *("LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "LeftHandThumb1"),
    *("RightShoulder", "RightArm", "RightForeArm", "RightHand"),
    *("LHipJoint", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"),
    *("RHipJoint", "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"),
)
JOINTS = (
    *("Pelvis", "Chest", "LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist", "LeftHip", "LeftKnee", "LeftAnkle"),
    *("RightCollar", "RightShoulder", "RightElbow", "RightWrist", "RightHip", "RightKnee", "RightAnkle"),
)
REALLUSION = (
    *("RL_BoneRoot", "CC_Base_Hip", "CC_Base_Pelvis", "CC_Base_L_ThighTwist01", "CC_Base_L_Thigh", "CC_Base_L_Calf"),
    *("CC_Base_L_Foot", "CC_Base_L_ToeBaseShareBone", "CC_Base_L_ToeBase", "CC_Base_L_Clavicle", "CC_Base_L_Upperarm"),
)


@pytest.mark.parametrize(
    ("asked", "names", "meant"),
    [
        ("LeftWrist", MIXAMO, "LeftHand"),
        ("lhand", MIXAMO, "LeftHand"),
        ("righthand", MIXAMO, "RightHand"),
        ("R_Knee", MIXAMO, "RightLeg"),
        ("l_calf", MIXAMO, "LeftLeg"),
        ("shin.R", MIXAMO, "RightLeg"),
        ("LeftHip", MIXAMO, "LeftUpLeg"),
        ("mixamorig:LeftAnkle", MIXAMO, "LeftFoot"),
        ("RightUpperArm", MIXAMO, "RightArm"),
        ("LeftCollar", MIXAMO, "LeftShoulder"),
        ("pelvis", MIXAMO, "Hips"),
        ("Skull", MIXAMO, "Head"),
        ("LeftHand", JOINTS, "LeftWrist"),
        ("LeftFoot", JOINTS, "LeftAnkle"),
        ("RightUpLeg", JOINTS, "RightHip"),
        ("RightArm", JOINTS, "RightShoulder"),
        ("RightForeArm", JOINTS, "RightElbow"),
        ("LeftClavicle", JOINTS, "LeftCollar"),
        ("LeftUpLeg", REALLUSION, "CC_Base_L_Thigh"),
        ("LeftToe", REALLUSION, "CC_Base_L_ToeBase"),
        ("LeftShoulder", REALLUSION, "CC_Base_L_Upperarm"),
        ("Hips", REALLUSION, "CC_Base_Hip"),
    ],
)
def test_a_part_by_another_name_is_found_on_its_side(asked, names, meant):
    assert same_part(asked, names) == meant


@pytest.mark.parametrize("asked", ["Arm", "Hand", "RigthHand", "LeftEye", "Club", "Left", "", "Spine", "RightThumb"])
def test_a_name_without_a_side_or_of_no_part_of_a_limb_is_left_to_its_letters(asked):
    assert same_part(asked, MIXAMO) is None


def test_what_the_body_does_not_have_is_not_found():
    assert same_part("LeftToe", JOINTS) is None
    assert same_part("Head", JOINTS) is None
    assert same_part("RightFoot", REALLUSION) is None
