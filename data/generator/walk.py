"""The walk: feet that roll from heel to toe on their prints, the body above them, arms against the legs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator import curves, figure
from data.generator.figure import Figure, axis_turn
from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion

FRAMES, RATE = 145, 24.0
# One stride (two steps) takes so many seconds and goes so far, cm; a foot stands for so much of it.
STRIDE_TIME, STRIDE, STANCE = 1.2, 120.0, 0.62
# The hips pass over the ankle at this part of the stride; the ankles stand so far from the middle line, cm.
_OVER_FOOT = 0.19
_TRACK = 7.5
_TOES_OUT = 7.0
# Pitch of the foot, degrees, toes down: as the heel lands, and as the toes leave.
_LANDING, _PUSH = -18.0, 90.0
_TOE_IN_FOOT = np.array([0.0, -6.0, 13.0])
_HEEL_IN_FOOT = np.array([0.0, -figure.ANKLE_HEIGHT, -4.5])


def make_walk(*, frames: int = FRAMES, rate: float = RATE, seed: int = 5) -> Motion:
    """Return a straight walk along z at a steady pace; `seed` makes every step a little different."""
    times = np.arange(frames) / rate
    sway = curves.noise(np.random.default_rng(seed), 12, start=0.0, stop=float(times[-1]), period=0.6)(times)
    body = Figure(figure.body_skeleton())
    feet = {side: _foot(side, times, seed) for side in ("Left", "Right")}
    _torso(body, times, sway, feet)
    for side, (ankle, foot, toes, yaw) in feet.items():
        aim = np.stack((np.sin(np.radians(yaw)), np.zeros_like(yaw), np.cos(np.radians(yaw))), axis=-1)
        body.leg(side, ankle, knee_to=aim)
        body.turn(f"{side}Foot", foot)
        body.turn(f"{side}ToeBase", toes)
        _arm(body, side, times, sway)
    return body.motion(1.0 / rate)


def phase(side: str, times: FloatArray) -> FloatArray:
    """Return strides since a landing of that foot: whole numbers are landings."""
    return times / STRIDE_TIME + (0.30 if side == "Left" else 0.80)


def _foot(side: str, times: FloatArray, seed: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the ankle's place, the rotations of foot and toes, and where the foot points (degrees)."""
    strides = phase(side, times)
    count = np.floor(strides).astype(np.intp)
    u = strides - count
    prints = _prints(side, int(count[-1]) + 2, seed)
    here, following = prints[count], prints[count + 1]
    step = _even_travel(u, STANCE, 1.0, rise=0.10, fall=0.13)
    x, z, yaw = (here + step[:, None] * (following - here)).T
    pitch = (
        _LANDING * (1.0 - curves.smooth_step(u, 0.0, 0.11))
        + _PUSH * curves.smooth_step(u, 0.385, 0.82)
        + (_LANDING - _PUSH) * curves.smooth_step(u, 0.69, 0.995)
    )
    foot = rot.multiply(axis_turn("y", yaw), axis_turn("x", pitch))
    # The ball of the foot stays in place, but for the first moment, when the foot rolls on its heel.
    landing = _LANDING * np.where(u < 0.5, 1.0 - curves.smooth_step(u, 0.0, 0.11), curves.smooth_step(u, 0.80, 0.995))
    flat = axis_turn("y", yaw)
    rolled = rot.rotate(rot.multiply(flat, axis_turn("x", landing)), _TOE_IN_FOOT - _HEEL_IN_FOOT)
    toe = np.stack((x, np.full_like(x, figure.TOE_HEIGHT), z), axis=-1)
    toe = toe + rolled - rot.rotate(flat, _TOE_IN_FOOT - _HEEL_IN_FOOT)
    s = np.clip((u - STANCE) / (1.0 - STANCE), 0.0, 1.0)
    toe[:, 1] += 8.0 * s**3 * (1.0 - s) ** 4 * (7.0**7 / (3.0**3 * 4.0**4))
    bend = curves.smooth_step(u, 0.36, 0.60) * (1.0 - curves.smooth_step(u, 0.60, 0.80))
    toes = rot.multiply(foot, axis_turn("x", -np.maximum(pitch, 0.0) * bend))
    return toe - rot.rotate(foot, _TOE_IN_FOOT), foot, toes, yaw


def _prints(side: str, count: int, seed: int) -> FloatArray:
    """Return the prints of a foot: x and z of its ball, cm, and its yaw, degrees; shape (count, 3)."""
    sign = 1.0 if side == "Left" else -1.0
    rng = np.random.default_rng((seed, side == "Left"))
    wander = rng.uniform(-1.0, 1.0, (count, 3)) * np.array([0.5, 1.2, 0.8])
    start = STRIDE * (np.arange(count) - phase(side, np.zeros(1))[0] + _OVER_FOOT)
    yaw = np.full(count, sign * _TOES_OUT)
    x = sign * _TRACK + 13.0 * np.sin(np.radians(yaw))
    prints: FloatArray = np.stack((x, start + 13.0, yaw), axis=-1) + wander
    return prints


def _even_travel(u: FloatArray, begin: float, end: float, *, rise: float, fall: float) -> FloatArray:
    """Return travel from 0 to 1 at an even speed that comes and goes smoothly."""

    def area(x: FloatArray, ramp: float) -> FloatArray:
        inside = np.clip(x / ramp, 0.0, 1.0)
        whole: FloatArray = ramp * inside**4 * (2.5 - 3.0 * inside + inside**2) + np.maximum(x - ramp, 0.0)
        return whole

    travel: FloatArray = area(u - begin, rise) - area(u - (end - fall), fall)
    return travel / (end - begin - 0.5 * (rise + fall))


def _torso(body: Figure, times: FloatArray, sway: FloatArray, feet: Mapping[str, tuple[FloatArray, ...]]) -> None:
    left = 2.0 * np.pi * phase("Left", times)
    # The left foot stands in the first 62 % of its stride: its middle is where the body sways over it.
    over = left - 2.0 * np.pi * (0.5 * STANCE)
    yaw = -5.0 * np.cos(left) + 0.5 * sway[:, 0]
    drop = 3.5 * np.cos(over - 0.35) + 0.3 * sway[:, 1]
    pelvis = rot.multiply(
        axis_turn("y", yaw), rot.multiply(axis_turn("z", drop), axis_turn("x", 5.0 + 0.5 * sway[:, 2]))
    )
    x = 2.7 * np.cos(over) + 0.2 * sway[:, 3]
    y = 98.3 - 1.4 * np.cos(2.0 * left - 0.5)
    z = STRIDE / STRIDE_TIME * times + 1.2 * np.sin(2.0 * left - 0.6)
    root = np.stack((x, y, z), axis=-1)
    body.root(root, pelvis)
    for side, (ankle, *_) in feet.items():
        hip = root + rot.rotate(pelvis, np.array([9.0 if side == "Left" else -9.0, -8.0, 0.0]))
        flat = np.sum((hip - ankle)[:, [0, 2]] ** 2, axis=-1)
        highest = ankle[:, 1] + np.sqrt(figure.reach_at(figure.THIGH, figure.SHIN, 5.0) ** 2 - flat)
        root[:, 1] -= curves.soft_excess(hip[:, 1] - highest, 0.5)
    twist = 4.8 * np.cos(left - 0.1) + 0.5 * sway[:, 4]
    lean = rot.multiply(
        axis_turn("z", -1.2 * np.cos(over)), axis_turn("x", 3.5 + 0.4 * sway[:, 5] + 0.8 * np.cos(2.0 * left))
    )
    body.share(("LowerBack", "Spine", "Spine1"), rot.multiply(axis_turn("y", twist), lean))
    gaze = rot.multiply(axis_turn("y", 0.3 * twist + 1.0 * sway[:, 6]), axis_turn("x", 4.0 + 0.7 * sway[:, 7]))
    body.share(("Neck", "Neck1", "Head"), gaze)


def _arm(body: Figure, side: str, times: FloatArray, sway: FloatArray) -> None:
    """Swing an arm with the other side's leg."""
    sign = 1.0 if side == "Left" else -1.0
    turn = 2.0 * np.pi * phase("Right" if side == "Left" else "Left", times)
    own = sway[:, 8 if side == "Left" else 9]
    raised = -3.0 + 14.5 * np.cos(turn - 0.25) + 0.8 * own
    bent = 27.0 + 10.0 * np.cos(turn - 0.6) + 1.0 * own
    body.turn_local(f"{side}Shoulder", axis_turn("y", -sign * 3.0 * np.cos(turn - 0.25)))
    chest = rot.multiply(body.rotations["Spine1"], axis_turn("z", sign * 9.0 + 0.0 * turn))

    def along(angle: FloatArray) -> FloatArray:
        a = np.radians(angle)
        return rot.rotate(chest, np.stack((np.zeros_like(a), -np.cos(a), np.sin(a)), axis=-1))

    elbow = body.origin(f"{side}Arm") + figure.UPPER_ARM * along(raised)
    wrist = elbow + figure.FOREARM * along(raised + bent)
    body.arm(side, wrist, elbow_to=-along(raised + 0.5 * bent + 90.0))
    body.turn_local(
        f"{side}Hand", rot.multiply(axis_turn("x", 12.0 + 2.0 * own), axis_turn("z", -sign * 6.0 + 0.0 * own))
    )
    for finger, curl in (("FingerBase", 22.0), ("HandIndex1", 26.0)):
        body.turn_local(f"{side}{finger}", axis_turn("z", np.full_like(own, -sign * curl)))
    thumb = "LThumb" if side == "Left" else "RThumb"
    body.turn_local(thumb, axis_turn("y", np.full_like(own, sign * 10.0)))
