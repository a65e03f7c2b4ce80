"""The kick: a mae geri of the right leg from a guard, the left foot planted throughout."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator import curves, figure
from data.generator.figure import Figure, axis_turn, unit
from motionedit.core import rotations as rot
from motionedit.core.slerp import slerp

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion

FRAMES, RATE = 84, 30.0
# The ankles in the guard, cm, and where the feet point, degrees to the left.
_ANKLES = {"Left": np.array([9.0, figure.ANKLE_HEIGHT, 24.0]), "Right": np.array([-12.0, figure.ANKLE_HEIGHT, -28.0])}
_TOES = {"Left": 4.0, "Right": -32.0}
_TOE_IN_FOOT = np.array([0.0, -6.0, 13.0])

#         guard  load  push   off   knee   snap   hit   hold   pull   knee   down   land  guard   end
_TIMES = (0.00, 0.45, 0.66, 0.80, 1.00, 1.10, 1.18, 1.23, 1.33, 1.46, 1.68, 1.92, 2.25, 2.80)
_KEYS: dict[str, tuple[float, ...]] = {
    "x": (-1, -1, 2, 5, 7, 7.5, 8, 8, 8, 8, 6, 2, -1, -1),
    "y": (91, 90.5, 90.5, 93, 96.5, 97.5, 98, 98, 97.5, 97, 94, 91.5, 91, 91),
    "z": (0, 0, 6, 13, 19, 21, 23, 23, 21, 18, 12, 4, 0, 0),
    "turn": (-30, -32, -20, -8, 2, 14, 26, 26, 14, 2, -14, -26, -30, -30),
    "tilt": (4, 5, 6, 4, -6, -13, -18, -18, -12, -5, 3, 5, 4, 4),
    "chest_turn": (-34, -37, -33, -26, -22, -20, -17, -17, -19, -24, -28, -33, -34, -34),
    "chest_tilt": (7, 9, 10, 7, 0, -8, -14, -14, -8, 0, 6, 9, 7, 7),
    "chest_lean": (0, 0, 1, 3, 4, 4, 4, 4, 4, 4, 3, 1, 0, 0),
    "heel": (8, 10, 32, 55, 55, 55, 55, 55, 55, 55, 45, 16, 8, 8),
    "free": (0, 0, 0.03, 0.55, 1, 1, 1, 1, 1, 1, 0.85, 0.1, 0, 0),
    "thigh": (0, 0, 10, 45, 98, 100, 97, 97, 99, 94, 62, 30, 10, 0),
    "knee": (60, 60, 75, 105, 124, 112, 4, 4, 75, 118, 104, 84, 60, 60),
    "ankle": (0, 0, 5, 15, 30, 38, 42, 42, 36, 28, 0, 0, 0, 0),
    "toes": (0, 0, 0, 0, -10, -25, -34, -34, -25, -10, 0, 0, 0, 0),
    "left_x": (8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8),
    "left_y": (14, 14, 14, 15, 15, 15, 15, 15, 15, 15, 15, 14, 14, 14),
    "left_z": (36, 36, 36, 35, 34, 33, 32, 32, 33, 34, 35, 36, 36, 36),
    "right_x": (-7, -7, -8, -12, -18, -22, -26, -26, -22, -17, -12, -8, -7, -7),
    "right_y": (12, 12, 11, 8, 3, -3, -8, -8, -4, 3, 8, 11, 12, 12),
    "right_z": (24, 24, 23, 21, 18, 13, 8, 8, 12, 17, 21, 23, 24, 24),
}
_NOISE = {"x": 0.2, "y": 0.12, "z": 0.2, "turn": 0.5, "chest_turn": 0.6, "chest_tilt": 0.4, "chest_lean": 0.4} | {
    f"{side}_{axis}": 0.4 for side in ("left", "right") for axis in "xyz"
}


def make_kick(*, frames: int = FRAMES, rate: float = RATE, seed: int = 3) -> Motion:
    """Return the kick along z."""
    times = np.arange(frames) / rate
    p = _curves(times, seed)
    body = Figure(figure.body_skeleton())
    root = np.stack((p["x"], p["y"], p["z"]), axis=-1)
    body.root(root, rot.multiply(axis_turn("y", p["turn"]), axis_turn("x", p["tilt"])))
    chest = rot.multiply(axis_turn("z", -p["chest_lean"]), axis_turn("x", p["chest_tilt"]))
    body.share(("LowerBack", "Spine", "Spine1"), rot.multiply(chest, axis_turn("y", p["chest_turn"])))
    body.share(("Neck", "Neck1", "Head"), axis_turn("x", 3.0 + 0.3 * p["chest_tilt"]))
    _support(body, times)
    _kicking_leg(body, p)
    for side in ("Left", "Right"):
        _guard(body, side, p)
    return body.motion(1.0 / rate)


def _curves(times: FloatArray, seed: int) -> dict[str, FloatArray]:
    stop = max(float(times[-1]), _TIMES[-1])
    values = curves.through_keys(_TIMES, np.array(list(_KEYS.values())).T, start=0.0, stop=stop)(times)
    drift = curves.noise(np.random.default_rng(seed), len(_KEYS), start=0.0, stop=stop, period=0.45)(times)
    scale = np.array([_NOISE.get(name, 0.0) for name in _KEYS])
    return dict(zip(_KEYS, (values + scale * drift).T, strict=True))


def _facing(side: str) -> FloatArray:
    """Return the rotation of a foot flat on the ground, shape (4,)."""
    return axis_turn("y", np.array(_TOES[side]))


def _knee_aim(degrees: FloatArray) -> FloatArray:
    a = np.radians(degrees)
    return np.stack((np.sin(a), np.zeros_like(a), np.cos(a)), axis=-1)


def _support(body: Figure, times: FloatArray) -> None:
    flat = np.broadcast_to(_facing("Left"), (len(times), 4))
    body.leg("Left", np.broadcast_to(_ANKLES["Left"], (len(times), 3)), knee_to=_knee_aim(np.full_like(times, 10.0)))
    body.turn("LeftFoot", flat)
    body.turn("LeftToeBase", flat)


def _kicking_leg(body: Figure, p: dict[str, FloatArray]) -> None:
    """Roll the foot off its ball, lift the knee, snap, pull back, and set the foot down where it was."""
    flat = _facing("Right")
    toe = _ANKLES["Right"] + rot.rotate(flat, _TOE_IN_FOOT)
    rolled = rot.multiply(flat, axis_turn("x", p["heel"]))
    planted = toe - rot.rotate(rolled, _TOE_IN_FOOT)
    hip = body.origin("RightUpLeg")

    def along(angle: FloatArray) -> FloatArray:
        a = np.radians(angle)
        return np.stack((-0.06 + 0.0 * a, -np.cos(a), np.sin(a)), axis=-1)

    lifted = hip + figure.THIGH * unit(along(p["thigh"])) + figure.SHIN * unit(along(p["thigh"] - p["knee"]))
    w = p["free"][:, None]
    aim = unit((1.0 - w) * _knee_aim(np.full_like(p["free"], -22.0)) + w * along(p["thigh"] - 0.5 * p["knee"] + 90.0))
    body.leg("Right", planted + w * (lifted - planted), knee_to=aim)
    shin = rot.multiply(body.rotations["RightLeg"], axis_turn("x", p["ankle"]))
    foot = slerp(rolled, shin, p["free"])
    body.turn("RightFoot", foot)
    standing = rot.multiply(rot.conjugate(rolled), np.broadcast_to(flat, rolled.shape))
    body.turn_local("RightToeBase", slerp(standing, axis_turn("x", p["toes"]), p["free"]))


def _guard(body: Figure, side: str, p: dict[str, FloatArray]) -> None:
    """Hold a fist up before the chest."""
    sign = 1.0 if side == "Left" else -1.0
    name = side.lower()
    still = np.zeros_like(p["x"])
    body.turn_local(f"{side}Shoulder", axis_turn("y", still - sign * 8.0))
    chest = body.rotations["Spine1"]
    local = np.stack((p[f"{name}_x"], p[f"{name}_y"], p[f"{name}_z"]), axis=-1)
    wrist = body.positions["Spine1"] + rot.rotate(chest, local)
    pole = rot.rotate(chest, unit(np.array([sign * 0.5, -1.0, -0.25])))
    body.arm(side, wrist, elbow_to=pole)
    body.turn_local(f"{side}Hand", axis_turn("x", still - 12.0))
    for finger, curl in (("FingerBase", 72.0), ("HandIndex1", 78.0)):
        body.turn_local(f"{side}{finger}", axis_turn("z", still - sign * curl))
    body.turn_local("LThumb" if side == "Left" else "RThumb", axis_turn("y", still + sign * 35.0))
