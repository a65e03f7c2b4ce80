"""What programs call the joints of human.py's body, and how they write the names of what hangs on it."""

import re

from human import BONES
from takes import SIDES


def _by_parts(middle, side, parts):
    """Return new names: `middle` lists Hips, Spine, Spine1, Neck, Head, `parts` what stands for leg and arm."""
    names = dict(zip(("Hips", "Spine", "Spine1", "Neck", "Head"), middle, strict=True))
    old = ("UpLeg", "Leg", "Foot", "ToeBase", "Shoulder", "Arm", "ForeArm", "Hand")
    for whose in SIDES:
        names |= {whose + part: side(whose, new) for part, new in zip(old, parts, strict=True)}
    return names


CONVENTIONS = {
    "plain": {},
    "mixamo": {name: "mixamorig:" + name for name, _, _ in BONES},
    "hip knee ankle": _by_parts(
        ("Hips", "Chest", "Chest2", "Neck", "Head"),
        lambda side, part: side + part,
        ("Hip", "Knee", "Ankle", "Toe", "Collar", "Shoulder", "Elbow", "Wrist"),
    ),
    "rigify": _by_parts(
        ("spine", "spine.001", "spine.003", "spine.005", "spine.006"),
        lambda side, part: f"{part}.{side[0]}",
        ("thigh", "shin", "foot", "toe", "shoulder", "upper_arm", "forearm", "hand"),
    ),
    "makehuman": _by_parts(
        ("root", "spine05", "spine01", "neck01", "head"),
        lambda side, part: f"{part}.{side[0]}",
        ("upperleg01", "lowerleg01", "foot", "toe1-1", "clavicle", "upperarm01", "lowerarm01", "wrist"),
    ),
    "L_Thigh": _by_parts(
        ("Pelvis", "Spine_01", "Spine_02", "Neck", "Head"),
        lambda side, part: f"{side[0]}_{part}",
        ("Thigh", "Calf", "Foot", "Toe", "Clavicle", "UpperArm", "Forearm", "Hand"),
    ),
    "character creator": _by_parts(
        ("CC_Base_Hip", "CC_Base_Waist", "CC_Base_Spine02", "CC_Base_NeckTwist01", "CC_Base_Head"),
        lambda side, part: f"CC_Base_{side[0]}_{part}",
        ("Thigh", "Calf", "Foot", "ToeBase", "Clavicle", "Upperarm", "Forearm", "Hand"),
    ),
    "unreal": _by_parts(
        ("pelvis", "spine_01", "spine_03", "neck_01", "head"),
        lambda side, part: f"{part}_{side[0].lower()}",
        ("thigh", "calf", "foot", "ball", "clavicle", "upperarm", "lowerarm", "hand"),
    ),
    "poser": _by_parts(
        ("hip", "abdomen", "chest", "neck", "head"),
        lambda side, part: side[0].lower() + part,
        ("Thigh", "Shin", "Foot", "Toe", "Collar", "Shldr", "ForeArm", "Hand"),
    ),
    "acclaim": _by_parts(
        ("root", "lowerback", "thorax", "lowerneck", "head"),
        lambda side, part: side[0].lower() + part,
        ("femur", "tibia", "foot", "toes", "clavicle", "humerus", "radius", "wrist"),
    ),
    "biped": _by_parts(
        ("Bip01", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head"),
        lambda side, part: f"Bip01 {side[0]} {part}",
        ("Thigh", "Calf", "Foot", "Toe0", "Clavicle", "UpperArm", "Forearm", "Hand"),
    ),
    "vrm": _by_parts(
        ("J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_Neck", "J_Bip_C_Head"),
        lambda side, part: f"J_Bip_{side[0]}_{part}",
        ("UpperLeg", "LowerLeg", "Foot", "ToeBase", "Shoulder", "UpperArm", "LowerArm", "Hand"),
    ),
    "japanese": _by_parts(
        ("センター", "上半身", "上半身2", "首", "頭"),
        lambda side, part: ("左" if side == "Left" else "右") + part,
        ("足", "ひざ", "足首", "つま先", "肩", "腕", "ひじ", "手首"),
    ),
}
# By what becomes of LeftSkirt1.
STYLES = {
    "LeftSkirt1": lambda side, word, number: side + word + number,
    "left_skirt_01": lambda side, word, number: "_".join(filter(None, (side, word, number.zfill(2)))).lower(),
    "skirt.L.001": lambda side, word, number: ".".join(filter(None, (word.lower(), side[:1], number.zfill(3)))),
    "J_Sec_L_Skirt1": lambda side, word, number: "_".join(filter(None, ("J_Sec", side[:1], word + number))),
    "leftskirt1": lambda side, word, number: (side + word + number).lower(),
}


def styled(name, style):
    """Return a name such as LeftSkirt1 as one of `STYLES` writes it."""
    return STYLES[style](*re.fullmatch(r"(Left|Right|)(.*?)(\d*)", name).groups())
