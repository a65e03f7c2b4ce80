"""Rows (name, parent, offset) of what hangs on a body and stands beside it, and of a dog; left is +x, metres."""

from human import THIGH
from takes import SIDES


def _chain(name, parent, count, first, bone):
    """Return the rows of a chain: its first offset, then `count` - 1 bones."""
    rows = [(f"{name}1", parent, first)]
    return [*rows, *((f"{name}{i}", f"{name}{i - 1}", bone) for i in range(2, count + 1))]


def _pair(name, parent, count, first, bone):
    """Return the rows of a chain on each side, x mirrored; a `*` in names is the side."""
    rows = []
    for side, sign in SIDES.items():
        ways = [(sign * x, y, z) for x, y, z in (first, bone)]
        rows += _chain(name.replace("*", side), parent.replace("*", side), count, *ways)
    return rows


EXTRAS = {
    "tail": _chain("Tail", "Hips", 5, (0.0, 0.02, -0.1), (0.0, -0.1, -0.3)),
    "skirt": _pair("*Skirt", "Hips", 6, (0.15, 0.0, 0.05), (0.01, -0.22, 0.0)),
    "cape": _pair("*Cape", "Spine1", 8, (0.15, 0.0, -0.05), (0.01, -0.2, 0.0)),
    "twin tails": _pair("*Hair", "Head", 6, (0.08, 0.15, -0.05), (0.03, -0.27, -0.02)),
    "wings": _pair("*Wing", "Spine1", 3, (0.08, 0.1, -0.1), (0.8, 0.2, -0.1)),
    "ears": _pair("*Ear", "Head", 3, (0.06, 0.12, 0.0), (0.02, 0.09, 0.0)),
    "eyes": _pair("*Eye", "Head", 1, (0.03, 0.1, 0.1), (0.0, 0.0, 0.0)),
    "breasts": _pair("*Breast", "Spine1", 2, (0.08, 0.05, 0.1), (0.0, 0.0, 0.05)),
    "swords": _pair("*Sword", "*Hand", 2, (0.0, -0.08, 0.0), (0.0, 0.0, 1.1)),
    "club": [("Club", "RightHand", (0.0, -0.08, 0.0)), ("ClubHead", "Club", (0.0, -0.7, 0.5))],
    "skis": _pair("*Ski", "*ToeBase", 2, (0.0, -0.02, 0.0), (0.0, 0.0, 1.2)),
    "fingers": [
        row
        for n, (across, down) in enumerate([(0.03, -0.03), (0.03, -0.08), (0.0, -0.09), (-0.02, -0.08)])
        for row in _pair(f"*HandFinger{n}_", "*Hand", 3, (0.01, down, across), (0.0, -0.03, 0.0))
    ],
    "twists": [
        *_pair("*UpLegTwist", "*UpLeg", 1, (0.0, -0.5 * THIGH, 0.0), (0.0, 0.0, 0.0)),
        *_pair("*ArmTwist", "*Arm", 1, (0.0, -0.14, 0.0), (0.0, 0.0, 0.0)),
    ],
}
# Those that are parts of the body.
PARTS = ("fingers", "twists")
# Joints at the ends, with End Sites as long again, as importers and exporters in turn make them.
DOUBLED = [
    ("Head_End", "Head", (0.0, 0.18, 0.0)),
    *_pair("*Toe_End", "*ToeBase", 1, (0.0, 0.0, 0.06), (0.0, 0.0, 0.0)),
    *_pair("*HandNub", "*Hand", 1, (0.0, -0.15, 0.0), (0.0, 0.0, 0.0)),
]
# Controls that an animator's rig keeps beside the body, under its root.
CONTROLS = [
    *_pair("IK_*Foot", "Root", 2, (0.1, 0.08, 0.0), (0.0, -0.06, 0.13)),
    *_pair("*KneePole", "Root", 1, (0.1, 0.5, 0.6), (0.0, 0.0, 0.0)),
]
# A dog: the spine lies, the fore legs hang on the chest, a tail on the hips. `*` stands for both sides, left is +x.
DOG = [
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("*Thigh", "Hips", (0.08, -0.03, -0.02)),
    ("*Knee", "*Thigh", (0.0, -0.2, 0.07)),
    ("*Foot", "*Knee", (0.0, -0.19, -0.12)),
    ("*Toe", "*Foot", (0.0, -0.1, 0.04)),
    ("Tail1", "Hips", (0.0, 0.04, -0.08)),
    ("Tail2", "Tail1", (0.0, -0.05, -0.2)),
    ("Tail3", "Tail2", (0.0, -0.08, -0.2)),
    ("Spine", "Hips", (0.0, 0.02, 0.2)),
    ("Chest", "Spine", (0.0, 0.0, 0.22)),
    ("*Scapula", "Chest", (0.06, -0.02, 0.06)),
    ("*Arm", "*Scapula", (0.0, -0.13, 0.06)),
    ("*Elbow", "*Arm", (0.0, -0.18, -0.08)),
    ("*Wrist", "*Elbow", (0.0, -0.2, 0.02)),
    ("Neck", "Chest", (0.0, 0.06, 0.12)),
    ("Head", "Neck", (0.0, 0.12, 0.14)),
]
