"""The three styles of swing: values of every curve at the key instants."""

from __future__ import annotations

import numpy as np

from motionedit.core.arrays import FloatArray

# The instants the tables below are written for.
KEYS = (
    "start",
    "takeaway",
    "shaft level",
    "arm level",
    "top",
    "arm down",
    "shaft down",
    "hit",
    "release",
    "arms out",
    "fold",
    "finish",
    "end",
)

# Degrees and cm. Turns: positive toward the target. Lean: positive toward the target. Heights above the ground.
#                    start take  shaft  arm   top  armdn shdn  hit   rel  out  fold  fin  end
_CLASSIC: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (0, 0, -12, -32, -45, -18, 8, 29, 42, 55, 70, 81, 80),
    "pelvis_tilt": (21, 21, 21, 22, 22, 21, 19, 16, 13, 11, 6, 3, 3),
    "pelvis_lean": (0, 0, 0, 0, 1, 1, 0, -2, -3, -3, -1, 0, 0),
    "pelvis_x": (4, 4, 2.5, -0.5, -1, 4, 7, 9, 11, 13, 15, 17, 17),
    "pelvis_y": (99.5, 99.5, 99.5, 99.3, 99, 97.5, 98, 99, 100, 100.5, 101.5, 102, 102),
    "pelvis_z": (-23, -23, -23, -22.5, -22, -22.5, -22, -21, -20, -19, -16, -14, -14),
    "chest_turn": (0, 0, -28, -64, -88, -56, -24, 6, 28, 58, 100, 124, 122),
    "chest_tilt": (30, 30, 30, 30, 29, 31, 31, 29, 26, 20, 9, 2, 2),
    "chest_lean": (-8, -8, -5, 1, 4, -2, -10, -15, -18, -19, -12, -6, -6),
    "left_protract": (6, 6, 8, 13, 16, 14, 10, 6, 4, 2, -4, -6, -6),
    "left_elevate": (-4, -4, -3, 2, 6, 3, -2, -4, -4, 0, 6, 8, 8),
    "right_protract": (12, 12, 7, -2, -8, -4, 6, 14, 20, 20, 18, 14, 14),
    "right_elevate": (-6, -6, -4, 2, 6, 0, -6, -8, -6, 0, 8, 10, 10),
    "plane": (55,) * 13,
    "plane_turn": (0,) * 13,
    "arm": (-110.5, -110.5, -137.5, -182.5, -222.5, -186.5, -141.5, -102.5, -74.5, -36.5, 26.5, 61.5, 61.5),
    "arm_cone": (33, 33, 33, 33, 33, 35, 33, 30, 28, 22, 12, 2, 2),
    "cock": (24, 24, -35, -86, -128, -118, -82, 12, 38, 56, 105, 160, 158),
    "club_cone": (-5, -5, -4, -2, -1, 0, -1, -5, -6, -8, -15, -21, -21),
    "face": (-56, -56, -48, -32, -25, -25, -30, -44, -40, -32, -25, -25, -25),
    "left_bend": (16, 16, 14, 14, 20, 15, 12, 12, 16, 24, 40, 60, 60),
    "finish": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0.12, 0.72, 1, 1),
    "finish_x": (9,) * 13,
    "finish_y": (16,) * 13,
    "finish_z": (20,) * 13,
    "left_elbow_out": (0.6, 0.6, 0.6, 0.4, 0.1, 0.3, 0.5, 0.6, 0.7, 0.7, 0.6, 0.5, 0.5),
    "left_elbow_up": (-0.5, -0.5, -0.6, -0.9, -1, -0.9, -0.6, -0.5, -0.5, -0.7, -1, -1, -1),
    "left_elbow_fore": (-0.6, -0.6, -0.4, -0.1, 0.1, -0.1, -0.4, -0.6, -0.5, -0.3, -0.1, 0, 0),
    "right_elbow_out": (0.6, 0.6, 0.5, 0.3, 0.2, 0.2, 0.3, 0.4, 0.4, 0.3, 0.1, 0.0, 0.0),
    "right_elbow_up": (-0.5, -0.5, -0.7, -1, -1, -1, -0.9, -0.7, -0.6, -0.8, -1, -1, -1),
    "right_elbow_fore": (-0.6, -0.6, -0.5, -0.3, -0.2, -0.2, -0.3, -0.5, -0.5, -0.3, 0.0, 0.1, 0.1),
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 10, 26, 48, 58, 57),
    "heel_yaw": (0, 0, 0, 0, 0, 0, 0, 0, 6, 16, 38, 50, 50),
    "left_knee": (0, 0, -6, -14, -18, -10, -2, 4, 6, 8, 10, 10, 10),
    "right_knee": (0, 0, 0, 0, 0, 4, 12, 20, 28, 38, 58, 68, 68),
    "head_pitch": (0,) * 13,
    "head_yaw": (0, 0, -2, -5, -9, -7, -6, -5, -4, 0, 0, 0, 0),
    "head_roll": (0,) * 13,
    "fingers": (60,) * 13,
    "slip": (0,) * 13,
}
PARAMETERS = tuple(_CLASSIC)

# What the other styles change: a compact, flat swing round the body ...
_FLAT: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (4, 4, -6, -22, -34, -10, 12, 32, 44, 55, 68, 76, 75),
    "chest_turn": (2, 2, -24, -56, -74, -46, -20, 8, 30, 56, 92, 112, 111),
    "pelvis_y": (97, 97, 97, 96.8, 96.5, 95, 95.5, 97, 98.5, 99.5, 100.5, 101, 101),
    "chest_tilt": (33, 33, 33, 33, 32, 34, 34, 32, 29, 23, 13, 7, 7),
    "arm": (-110.8, -110.8, -135.8, -172.8, -204.8, -176.8, -139.8, -102.8, -74.8, -38.8, 19.2, 47.2, 47.2),
    "arm_cone": (39, 39, 40, 42, 43, 43, 40, 36, 34, 28, 17, 7, 7),
    "cock": (24, 24, -30, -76, -106, -104, -78, 12, 36, 52, 92, 138, 136),
    "plane": (52, 52, 50, 47, 46, 48, 51, 53, 53, 52, 52, 52, 52),
    "finish_y": (11,) * 13,
    "finish_x": (14,) * 13,
    "finish_z": (24,) * 13,
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 7, 20, 38, 46, 46),
    "right_knee": (0, 0, 0, 0, 0, 3, 9, 16, 23, 31, 48, 58, 58),
}
# ... and a long, upright one with a wide turn of the hips and a weight shift that can be seen.
_LONG: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (0, 0, -18, -42, -58, -26, 4, 27, 41, 55, 72, 83, 82),
    "chest_turn": (0, 0, -34, -74, -100, -64, -28, 5, 27, 58, 104, 130, 128),
    "pelvis_x": (3, 3, 0, -5, -7, 1, 6, 10, 13, 15, 18, 20, 20),
    "chest_lean": (-8, -8, -3, 5, 9, 2, -9, -17, -21, -22, -14, -8, -8),
    "chest_tilt": (27, 27, 27, 27, 26, 28, 28, 26, 23, 17, 5, -2, -2),
    "arm": (-110.3, -110.3, -139.3, -189.3, -235.3, -195.3, -144.3, -102.3, -73.3, -34.3, 31.7, 67.7, 67.7),
    "arm_cone": (30.5, 30.5, 29.5, 27.5, 25.5, 30.5, 30.5, 27.5, 25.5, 18.5, 8.5, -1.5, -1.5),
    "cock": (24, 24, -28, -82, -134, -122, -82, 12, 38, 58, 108, 166, 164),
    "plane": (56, 56, 57, 59, 61, 59, 57, 55, 55, 56, 57, 58, 58),
    "left_bend": (16, 16, 14, 17, 30, 20, 13, 12, 16, 24, 40, 60, 60),
    "finish_y": (21,) * 13,
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 12, 30, 54, 64, 63),
}
STYLES = (_CLASSIC, {**_CLASSIC, **_FLAT}, {**_CLASSIC, **_LONG})

# Standard deviation of the noise, degrees or cm.
_NOISE = {
    "pelvis_turn": 1.0,
    "pelvis_tilt": 0.5,
    "pelvis_lean": 0.7,
    "pelvis_x": 0.4,
    "pelvis_y": 0.3,
    "pelvis_z": 0.4,
    "chest_turn": 1.0,
    "chest_tilt": 0.5,
    "chest_lean": 0.6,
    "left_protract": 1.0,
    "left_elevate": 1.2,
    "right_protract": 1.0,
    "right_elevate": 1.2,
    "plane": 0.5,
    "plane_turn": 0.7,
    "arm": 0.8,
    "arm_cone": 0.6,
    "cock": 1.2,
    "club_cone": 0.6,
    "face": 3.0,
    "left_bend": 1.5,
    "finish_x": 1.5,
    "finish_y": 1.5,
    "finish_z": 1.5,
    "left_elbow_out": 0.05,
    "left_elbow_up": 0.05,
    "left_elbow_fore": 0.05,
    "right_elbow_out": 0.05,
    "right_elbow_up": 0.05,
    "right_elbow_fore": 0.05,
    "left_knee": 3.0,
    "right_knee": 3.0,
    "head_pitch": 3.0,
    "head_yaw": 3.5,
    "head_roll": 2.5,
    "fingers": 4.0,
    "slip": 2.0,
}
NOISE: FloatArray = np.array([_NOISE.get(name, 0.0) for name in PARAMETERS])

# How a player meets a ball 1 cm further toward the target, and 1 cm further out, before the rest is solved for:
# degrees or cm.
_RESPONSE = {
    "pelvis_x": (0.18, 0.0),
    "pelvis_turn": (0.68, 0.0),
    "chest_turn": (1.12, 0.0),
    "chest_lean": (-0.45, 0.0),
    "arm": (0.75, 0.0),
    "left_knee": (0.6, 0.0),
    "right_knee": (0.6, 0.0),
    "head_yaw": (0.45, 0.0),
    "pelvis_tilt": (0.0, 0.75),
    "pelvis_y": (0.0, -0.22),
    "pelvis_z": (0.0, -0.15),
    "chest_tilt": (0.0, 0.98),
    "plane": (0.0, -1.05),
    "arm_cone": (0.0, 0.22),
    "left_elevate": (0.0, -0.45),
    "right_elevate": (0.0, -0.45),
    "left_protract": (0.0, 0.6),
    "right_protract": (0.0, 0.6),
}
RESPONSE: FloatArray = np.array([_RESPONSE.get(name, (0.0, 0.0)) for name in PARAMETERS]).T

# How much of the adaptation to the ball holds at each key: that of the hit, and that of the address.
ENVELOPES: dict[str, tuple[float, ...]] = {
    "hit": (1, 1, 1, 1, 1, 1, 1, 1, 1, 0.95, 0.75, 0.6, 0.6),
    "address": (1, 1, 0.5, 0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0),
}


def key_values(style: dict[str, tuple[float, ...]]) -> FloatArray:
    """Return a style's table, shape (K, P)."""
    return np.array([style[name] for name in PARAMETERS], dtype=float).T
