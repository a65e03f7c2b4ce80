"""The three styles of swing: values of every curve at the key instants."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
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
    "delivery",
    "hit",
    "after",
    "arms out",
    "fold",
    "finish",
    "end",
)

# Degrees and cm. Turns: positive toward the target. Lean: positive toward the target. Heights above the ground.
_CLASSIC: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (0, 0, -12, -32, -45, -18, 6, 17, 29, 39, 66, 76, 78, 77),
    "pelvis_tilt": (21, 21, 21, 22, 22, 21, 19, 17.62, 16, 14.38, 11, 6, 3, 3),
    "pelvis_lean": (0, 0, 0, 0, 1, 1, 0, -0.92, -2, -2.54, -3, -1, 0, 0),
    "pelvis_x": (4, 4, 2.5, -0.5, -2.5, 3, 7, 8, 9, 10, 14.5, 19.5, 21, 21),
    "pelvis_y": (99.5, 99.5, 99.5, 99.3, 99, 97.5, 98, 98.46, 99, 99.54, 100.5, 101.5, 102, 102),
    "pelvis_z": (-23, -23, -23, -22.5, -22, -22.5, -22, -21.54, -21, -20.46, -19, -16, -14, -14),
    "chest_turn": (0, 0, -28, -64, -88, -58, -28, -12, 6, 25, 86, 114, 126, 124),
    "chest_tilt": (30, 30, 30, 30, 29, 31, 31, 30.08, 29, 27.38, 20, 9, 2, 2),
    "chest_lean": (-8, -8, -5, 1, 4, -2, -10, -13, -17, -21, -22, -14, -7, -7),
    "left_protract": (6, 6, 8, 13, 16, 14, 10, 8, 6, 3, 2, 6, 8, 8),
    "left_elevate": (-4, -4, -3, 2, 6, 3, -2, -2.92, -4, -4, 0, 6, 8, 8),
    "right_protract": (12, 12, 7, -2, -8, -4, 6, 10, 16, 20, 20, 16, 10, 10),
    "right_elevate": (-6, -6, -4, 2, 6, 0, -6, -6.92, -8, -6.92, 0, 8, 10, 10),
    "plane": (55,) * 14,
    "plane_turn": (0,) * 14,
    "arm": (-110.5, -110.5, -137.5, -188, -236, -211, -162, -135.5, -101, -86.5, -27, 20, 50, 50),
    "arm_cone": (33, 33, 33, 33, 33, 35, 33, 31.7, 30, 23, -4, -8, -8, -8),
    "cock": (24, 24, -34, -80, -108, -101, -75, -42.5, 11, 54.5, 84, 122, 144, 142),
    "club_cone": (-5, -5, -4, -2, -1, 0, -1, -2.84, -5, -5.54, -8, -15, -21, -21),
    "face": (0, 0, -40, -62, -72, -74, -66, -46, -6, 24, 72, 104, 122, 121),
    "left_bend": (20, 20, 18, 18, 22, 19, 18, 18, 19, 21, 50, 78, 88, 88),
    "finish": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.08, 0.7, 1, 1),
    "finish_x": (9,) * 14,
    "finish_y": (16,) * 14,
    "finish_z": (20,) * 14,
    "left_elbow_out": (0.4, 0.4, 0.4, 0.35, 0.1, 0.25, 0.4, 0.4, 0.4, 0.45, 0.6, 0.6, 0.5, 0.5),
    "left_elbow_up": (-0.5, -0.5, -0.6, -0.9, -1, -0.9, -0.6, -0.55, -0.5, -0.5, -0.7, -1, -1, -1),
    "left_elbow_fore": (-0.8, -0.8, -0.6, -0.2, 0, -0.2, -0.6, -0.7, -0.8, -0.7, -0.4, -0.1, 0, 0),
    "right_elbow_out": (0.6, 0.6, 0.5, 0.3, 0.2, 0.2, 0.3, 0.35, 0.4, 0.4, 0.3, 0.1, 0, 0),
    "right_elbow_up": (-0.5, -0.5, -0.7, -1, -1, -1, -0.9, -0.81, -0.7, -0.65, -0.8, -1, -1, -1),
    "right_elbow_fore": (-0.6, -0.6, -0.5, -0.3, -0.2, -0.2, -0.3, -0.39, -0.5, -0.5, -0.3, 0, 0.1, 0.1),
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 27, 50, 60, 59),
    "heel_yaw": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 16, 38, 50, 50),
    "left_knee": (0, 0, -6, -14, -18, -10, -2, 0.76, 4, 5.08, 8, 10, 10, 10),
    "right_knee": (0, 0, 0, 0, 0, 4, 12, 15.68, 20, 24.32, 38, 58, 68, 68),
    "head_pitch": (0,) * 14,
    "head_yaw": (0, 0, -2, -5, -9, -7, -6, -5.54, -5, -4.46, 0, 0, 0, 0),
    "head_roll": (0,) * 14,
    "fingers": (60,) * 14,
    "slip": (0,) * 14,
}
PARAMETERS = tuple(_CLASSIC)

# What the other styles change: a compact, flat swing round the body ...
_FLAT: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (4, 4, -6, -22, -34, -10, 10, 20, 32, 40, 62, 71, 74, 73),
    "chest_turn": (2, 2, -24, -56, -74, -48, -22, -8, 9, 27, 80, 104, 114, 113),
    "pelvis_y": (97, 97, 97, 96.8, 96.5, 95, 95.5, 96.19, 97, 97.81, 99.5, 100.5, 101, 101),
    "chest_tilt": (33, 33, 33, 33, 32, 34, 34, 33.08, 32, 30.38, 23, 13, 7, 7),
    "arm": (-110.8, -110.8, -135.8, -177, -219, -199, -158, -134.5, -101, -86.5, -30, 14, 40, 40),
    "arm_cone": (39, 39, 39.5, 40, 39.5, 39, 38, 37.5, 36, 29, 2, -2, -2, -2),
    "cock": (24, 24, -30, -70, -94, -91, -72, -42.5, 11, 54.5, 82, 112, 130, 128),
    "plane": (52, 52, 50, 47, 46, 48, 51, 51.92, 53, 53, 52, 52, 52, 52),
    "finish_y": (11,) * 14,
    "finish_x": (14,) * 14,
    "finish_z": (24,) * 14,
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 20, 38, 46, 46),
    "right_knee": (0, 0, 0, 0, 0, 3, 9, 12.22, 16, 19.78, 31, 48, 58, 58),
    "pelvis_x": (4, 4, 3, 1.5, 1, 4.5, 7, 8, 8.5, 9.3, 13, 17, 18.5, 18.5),
}
# ... and a long, upright one with a wide turn of the hips and a weight shift that can be seen.
_LONG: dict[str, tuple[float, ...]] = {
    "pelvis_turn": (0, 0, -18, -42, -58, -26, 2, 14, 28, 39, 67, 77, 79, 78),
    "chest_turn": (0, 0, -34, -74, -100, -66, -32, -14, 5, 25, 88, 118, 132, 130),
    "pelvis_x": (3, 3, 0, -5.5, -9, -1, 5.5, 7.7, 10, 11.4, 17, 22, 23.5, 23.5),
    "chest_lean": (-8, -8, -3, 5, 9, 2, -9, -12.68, -17, -19.16, -22, -14, -8, -8),
    "chest_tilt": (27, 27, 27, 27, 26, 28, 28, 27.08, 26, 24.38, 17, 5, -2, -2),
    "arm": (-110.3, -110.3, -139.3, -193, -245, -216, -164, -136, -101, -90, -28, 25, 56, 56),
    "arm_cone": (30.5, 30.5, 29.5, 27.5, 25.5, 30.5, 30.5, 29, 27.5, 21, -6, -10, -10, -10),
    "cock": (24, 24, -30, -79, -112, -105, -77, -43, 11, 58, 90, 126, 150, 148),
    "plane": (56, 56, 57, 59, 61, 59, 57, 56.08, 55, 55, 56, 57, 58, 58),
    "left_bend": (20, 20, 18, 20, 31, 23, 18, 18, 19, 21, 50, 78, 88, 88),
    "finish_y": (21,) * 14,
    "heel_up": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 31, 54, 64, 63),
    "face": (0, 0, -42, -66, -78, -78, -68, -47, -6, 25, 74, 106, 124, 123),
    "right_protract": (12, 12, 7, -2, -8, -4, 7, 12, 18, 22, 20, 16, 10, 10),
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
    "hit": (1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0.92, 0.75, 0.6, 0.6),
    "address": (1, 1, 0.5, 0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
}


def key_values(style: dict[str, tuple[float, ...]]) -> FloatArray:
    """Return a style's table, shape (K, P)."""
    return np.array([style[name] for name in PARAMETERS], dtype=float).T
