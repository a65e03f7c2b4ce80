"""How two hands hold the club: each hand's pose from the club's, within the arms' reach and above the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator import curves, figure
from data.generator.figure import axis_turn
from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# The left hand holds the shaft this far above the right, cm.
HANDS_APART = 9.0
# How each hand holds the club, degrees: the shaft's angle off square in the palm, the hand's turn about the shaft.
GRIP_ANGLE = 28.0
GRIP_TURN = {"Left": -25.0, "Right": 0.0}
# Where the shaft lies in each hand's frame, cm.
IN_HAND = {"Left": np.array(figure.GRIP_IN_HAND) * np.array([-1.0, 1.0, 1.0]), "Right": np.array(figure.GRIP_IN_HAND)}
UP_SHAFT = np.array([0.0, HANDS_APART, 0.0])
HEAD_IN_CLUB = np.array([0.0, -figure.CLUB_LENGTH, 0.0])


def grips(slip: FloatArray) -> dict[str, FloatArray]:
    """Return the club's rotation in each hand's frame, (F, 4): the right hand lets it slip by `slip` degrees."""
    c, s = np.cos(np.radians(GRIP_ANGLE)), np.sin(np.radians(GRIP_ANGLE))
    right = rot.from_matrix(np.array([[c, 0.0, s], [s, 0.0, -c], [0.0, 1.0, 0.0]]).T)
    left = rot.from_matrix(np.array([[-c, 0.0, s], [-s, 0.0, -c], [0.0, -1.0, 0.0]]).T)
    out = {}
    for side, grip in (("Left", left), ("Right", right)):
        turned = rot.multiply(grip, axis_turn("y", np.full_like(slip, GRIP_TURN[side])))
        out[side] = rot.multiply(turned, axis_turn("z", slip)) if side == "Right" else turned
    return out


def wrist_of(side: str, grip: FloatArray, club: FloatArray, hand: FloatArray) -> FloatArray:
    """Return where a hand's wrist is when it holds the club, (F, 3)."""
    held = grip + rot.rotate(club, UP_SHAFT) if side == "Left" else grip
    return held - rot.rotate(hand, IN_HAND[side])


def above_ground(grip: FloatArray, club: FloatArray) -> FloatArray:
    """Lift the grip softly where the club's head would graze the ground; at the ball it changes nothing."""
    head = grip + rot.rotate(club, HEAD_IN_CLUB)
    lift = curves.soft_excess(1.0 - head[:, 1], 0.08)
    lifted: FloatArray = grip + lift[:, None] * np.array([0.0, 1.0, 0.0])
    return lifted


def within_reach(
    grip: FloatArray, club: FloatArray, hands: dict[str, FloatArray], shoulders: dict[str, FloatArray]
) -> FloatArray:
    """Draw the grip softly toward a shoulder whose elbow would be bent by less than 9 degrees."""
    longest = figure.reach_at(figure.UPPER_ARM, figure.FOREARM, 9.0)
    for side in ("Right", "Left", "Right"):
        gap = wrist_of(side, grip, club, hands[side]) - shoulders[side]
        far = np.linalg.norm(gap, axis=-1)
        grip = grip - (curves.soft_excess(far - longest, 0.6) / far)[:, None] * gap
    return grip
