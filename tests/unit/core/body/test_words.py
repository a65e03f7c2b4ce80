"""What the names of joints say, in the spellings of many programs."""

import pytest
from human import skeleton_of
from rig_names import CONVENTIONS, STYLES
from rig_rows import EXTRAS
from rigs import Rig, file_names

from motionedit.core.body.bones import hanging
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.words import (
    bare_names,
    hangs_on,
    is_end,
    is_hand_or_foot,
    is_head,
    is_toe,
    leg_or_arm,
    words_of,
)

NAMES = {
    (convention, joint): name for convention in CONVENTIONS for joint, name in file_names(Rig(names=convention)).items()
}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("J_Sec_HairTip1_L", "j sec hair tip l"),
        ("mixamorig:LeftUpLeg", "mixamorig left up leg"),
        ("CC_Base_L_BigToe1", "cc base l big toe"),
        ("Bip01 L Toe0Nub", "bip l toe nub"),
        ("upperarm01.L", "upperarm l"),
        ("lForeArm", "l fore arm"),
        ("FKFoot", "fk foot"),
        ("左足首", "左足首"),
        ("_12_", ""),
    ],
)
def test_a_name_is_words(name, words):
    assert words_of(name) == tuple(words.split())


@pytest.mark.parametrize("joint", sorted({joint for _, joint in NAMES}))
def test_no_program_calls_a_joint_of_the_body_what_hangs_on_one(joint):
    called = [name for (_, other), name in NAMES.items() if other == joint]
    assert [name for name in called if hangs_on(name) or is_end(name)] == []


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("extra", ["tail", "skirt", "cape", "twin tails", "wings", "breasts", "swords"])
def test_hair_clothes_and_weapons_hang_on_a_body_however_they_are_written(extra, style):
    rig = Rig(extras=(extra,), style=style)
    called = [file_names(rig)[name] for name, _, _ in EXTRAS[extra]]
    assert [name for name in called if not hangs_on(name)] == []


@pytest.mark.parametrize(
    ("name", "hangs"),
    [
        *((name, True) for name in ("J_Sec_L_Bust1", "LeftEye", "jaw", "ponytail.003", "IK_Foot.L", "knee_pole_r")),
        *((name, True) for name in ("CC_Base_Tongue01", "prop.R", "Golf Club", "ski_l", "antenna2", "jiggle_chest")),
        *((name, False) for name in ("LeftForeArm", "elbow.L", "Swing", "LeftHeel", "spine_01", "Toe", "")),
    ],
)
def test_what_hangs_on_a_body_is_told_by_whole_words(name, hangs):
    assert hangs_on(name) is hangs


@pytest.mark.parametrize(
    ("name", "end"),
    [
        *(
            (name, True)
            for name in ("HeadTop_End", "head_end", "LeftToe_End", "Bip01 L Toe0Nub", "L_FingerTip", "HeadNub")
        ),
        *((name, False) for name in ("Head", "LeftToeBase", "LeftFingerBase", "Tendon", "Stop", "LeftHand")),
    ],
)
def test_ends_of_chains_are_called_so(name, end):
    assert is_end(name) is end


@pytest.mark.parametrize(
    ("name", "head"),
    [
        *(
            (name, True)
            for name in ("Head", "mixamorig:Head", "CC_Base_Head", "J_Bip_C_Head", "Bip01 Head", "head.001", "頭")
        ),
        *(
            (name, False)
            for name in ("HeadTop_End", "Head_End", "Forehead", "headband", "LeftHead", "femur_head_l", "Neck")
        ),
    ],
)
def test_a_head_is_called_head_and_has_no_side(name, head):
    assert is_head(name) is head


def test_ends_of_limbs_and_toes_are_known_in_every_program():
    for (convention, joint), name in NAMES.items():
        if convention != "hip knee ankle" or not joint.endswith("Shoulder"):
            assert is_hand_or_foot(name) == joint.endswith(("Foot", "Hand")), (convention, name)
        assert is_toe(name) == joint.endswith("ToeBase"), (convention, name)
    assert not is_hand_or_foot("LeftFootIK_ctrl")
    assert not is_toe("Bip01 L Toe0Nub")


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_legs_and_arms_are_told_apart_by_what_they_are_called(convention):
    for side in ("Left", "Right"):
        legs, arms = (
            tuple(NAMES[convention, side + part] for part in parts)
            for parts in (("UpLeg", "Leg", "Foot"), ("Arm", "ForeArm", "Hand"))
        )
        assert leg_or_arm(legs, (0, 1, 2)) > 0
        assert leg_or_arm(arms, (0, 1, 2)) < 0


def test_a_front_leg_is_an_arm():
    assert leg_or_arm(("FrontLeg", "front_knee", "ForeFoot"), (0, 1, 2)) == -3
    assert leg_or_arm(("HindLeg", "hind_knee", "HindFoot"), (0, 1, 2)) == 3
    assert leg_or_arm(("joint1", "joint2"), (0, 1)) == 0


@pytest.mark.parametrize("prefix", ["Bat:", "Staff_", "Tail_", "EAR_", "Dress", "My Sword ", "rig|Hair:"])
def test_what_all_names_begin_with_says_nothing(prefix):
    skeleton = skeleton_of(rename=lambda name: prefix + name)
    assert find_anatomy(skeleton) == find_anatomy(skeleton_of())
    assert not hanging(skeleton).any()


@pytest.mark.parametrize(
    ("names", "bare"),
    [
        (("mixamorig:Hips", "mixamorig:LeftLeg", "x"), ("Hips", "LeftLeg", "x")),
        (("Bat_Hips", "Bat_Head", "Bat_Hair"), ("Hips", "Head", "Hair")),
        (("Hips", "Head", "Hand"), ("Hips", "Head", "Hand")),
        (("LeftLeg", "LeftFoot"), ("LeftLeg", "LeftFoot")),
        (("a", "a", "a"), ("a", "a", "a")),
        (("ns:", "ns:b", "ns:c"), ("ns:", "b", "c")),
    ],
)
def test_names_are_bare_of_namespaces_and_of_what_all_share(names, bare):
    assert bare_names(names) == bare


def test_what_most_joints_hang_on_is_the_body_whatever_it_is_called():
    skeleton = skeleton_of(rename=lambda name: "rig_ctrl" if name == "Hips" else name)
    assert not hanging(skeleton).any()
