"""The golf swing: curves of posture, a tilted plane for arm and club, and the ball as the one goal."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from data.generator import curves, figure
from data.generator.figure import Figure, axis_turn, unit
from data.generator.grip import HEAD_IN_CLUB, IN_HAND, UP_SHAFT, above_ground, grips, within_reach, wrist_of
from data.generator.styles import ENVELOPES, NOISE, PARAMETERS, RESPONSE, STYLES, key_values
from motionedit.core import rotations as rot
from motionedit.core.slerp import slerp

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion

# The feet, in cm and degrees: ankles this far left and right of the origin, toes turned out by so much.
ANKLES = {
    "Left": np.array([21.0, figure.ANKLE_HEIGHT, -15.0]),
    "Right": np.array([-21.0, figure.ANKLE_HEIGHT, -15.0]),
}
TOES_OUT = {"Left": 22.0, "Right": -10.0}
# How the noise splits: what is a person's own throughout, and what changes in the course of the swing.
PERSON, MOMENT = 0.25, 0.9
# The ball the tables of the styles are written for: (x, z), cm.
USUAL_BALL = np.array([4.0, 64.0])
# The club's head at the hit stands this high: the middle of a ball on the ground.
BALL_HEIGHT = 2.1
# At the address the head rests this far behind the ball, cm.
_ADDRESS_GAP = 3.5
# A posture that gives way to the ball by more than this (degrees, cm) is no swing any more.
_FARTHEST = 45.0


class Timing(NamedTuple):
    """Instants of a swing in seconds from the clip's first frame."""

    takeaway: float
    top: float
    hit: float
    finish: float
    end: float


USUAL_TIMING = Timing(2.04, 3.20, 3.76, 4.72, 5.24)


@dataclass(frozen=True, eq=False)
class Swing:
    """One swing to make: what the generator is told, each on its own.

    Attributes
    ----------
    ball : (x, z) on the ground, cm
    timing : instants, seconds
    style : weights of the three styles, summing to 1
    person : shape (P,), offsets of each parameter in units of its noise, constant over the clip
    seed : of the noise in time
    noise : its scale; 0 leaves a smooth swing of the bare style
    """

    ball: tuple[float, float]
    timing: Timing = USUAL_TIMING
    style: tuple[float, float, float] = (1.0, 0.0, 0.0)
    seed: int = 0
    noise: float = 1.0
    person: FloatArray = field(default_factory=lambda: np.zeros(len(PARAMETERS)))


def make_swing(swing: Swing, *, rate: float = 25.0) -> Motion:
    """Return the motion of a swing sampled at `rate` Hz from time 0 to its end, both in."""
    model = SwingModel(swing)
    count = int(np.floor(swing.timing.end * rate + 1e-6)) + 1
    return model.figure(np.arange(count) / rate).motion(1.0 / rate)


def with_ball(swing: Swing, ball: tuple[float, float]) -> Swing:
    """Return the same swing, noise and timing at another ball: the truth an edit is compared with."""
    return replace(swing, ball=ball)


class SwingModel:
    """The swing as a function of time, solved so that the club's head passes through the ball at the hit."""

    def __init__(self, swing: Swing) -> None:
        self.swing = swing
        t = swing.timing
        down = t.hit - t.top
        back = t.top - t.takeaway
        through = t.finish - t.hit
        keys = (
            min(0.0, t.takeaway - 0.5),
            t.takeaway,
            t.takeaway + 0.30 * back,
            t.takeaway + 0.62 * back,
            t.top,
            t.top + 0.42 * down,
            t.top + 0.74 * down,
            t.top + 0.86 * down,
            t.hit,
            t.hit + 0.07 * through,
            t.hit + 0.30 * through,
            t.hit + 0.58 * through,
            t.finish,
            max(t.end, t.finish + 0.2),
        )
        values = np.tensordot(np.array(swing.style), np.array([key_values(style) for style in STYLES]), axes=1)
        self._base = curves.through_keys(keys, values, start=0.0, stop=t.end)
        self._envelopes = curves.through_keys(keys, np.array(list(ENVELOPES.values())).T, start=0.0, stop=t.end)
        rng = np.random.default_rng(swing.seed)
        self._noise = curves.noise(rng, len(PARAMETERS), start=0.0, stop=t.end, period=0.5)
        self._adapt = np.zeros((2, len(PARAMETERS)))
        self._adapt[0] = (np.array(swing.ball) - USUAL_BALL) @ RESPONSE
        self._solve()

    # -- the goal --------------------------------------------------------------------------------------------------

    def _solve(self) -> None:
        """Find the least change of posture that brings the head to the ball at the hit and behind it at the address."""
        ball = np.array([self.swing.ball[0], BALL_HEIGHT, self.swing.ball[1]])
        goals = (ball, ball - np.array([_ADDRESS_GAP, 0.4, 0.0]))
        for row, time in enumerate((self.swing.timing.hit, self.swing.timing.takeaway * 0.5)):
            weights = np.array([_ADAPT[row].get(name, 0.0) for name in PARAMETERS])
            free = np.flatnonzero(weights)
            for _ in range(30):
                if np.abs(self._adapt).max() > _FARTHEST:
                    message = f"no swing reaches a ball at {self.swing.ball}"
                    raise ValueError(message)
                steps = np.zeros((len(free) + 1, len(PARAMETERS)))
                steps[np.arange(1, len(free) + 1), free] = 1e-4
                heads = self._head(np.full(len(steps), time), row, steps)
                error = goals[row] - heads[0]
                if np.linalg.norm(error) < 1e-10:
                    break
                J = ((heads[1:] - heads[0]) / 1e-4).T * weights[free]
                y = np.linalg.lstsq(J, error, rcond=None)[0]
                y *= min(1.0, 10.0 / np.linalg.norm(error))
                self._adapt[row, free] += weights[free] * y

    def _head(self, times: FloatArray, row: int, steps: FloatArray) -> FloatArray:
        parameters = self.parameters(times)
        parameters += self._envelopes(times)[:, row : row + 1] * steps
        pose = self._torso(parameters)
        _, club, grip = self._club(parameters, pose)
        return grip + rot.rotate(club, HEAD_IN_CLUB)

    def parameters(self, times: FloatArray) -> FloatArray:
        """Return the values of all curves at times (F,), shape (F, P)."""
        noise = NOISE * (PERSON * self.swing.person + MOMENT * self._noise(times))
        return self._base(times) + self.swing.noise * noise + self._envelopes(times) @ self._adapt

    # -- the body --------------------------------------------------------------------------------------------------

    def _torso(self, parameters: FloatArray) -> Figure:
        p = dict(zip(PARAMETERS, parameters.T, strict=True))
        body = Figure(figure.golfer_skeleton())
        pelvis = _tilted(p["pelvis_tilt"], p["pelvis_lean"], p["pelvis_turn"])
        chest = _tilted(p["chest_tilt"], p["chest_lean"], p["chest_turn"])
        root = np.stack((p["pelvis_x"], p["pelvis_y"], p["pelvis_z"]), axis=-1)
        body.root(root, pelvis)
        self._lower_pelvis(body, p)
        body.share(("LowerBack", "Spine", "Spine1"), chest)
        for side, sign in (("Left", 1.0), ("Right", -1.0)):
            forward, up = p[f"{side.lower()}_protract"], p[f"{side.lower()}_elevate"]
            turn = rot.multiply(axis_turn("y", -sign * forward), axis_turn("z", sign * up))
            body.turn_local(f"{side}Shoulder", turn)
        return body

    def _lower_pelvis(self, body: Figure, p: dict[str, FloatArray]) -> None:
        """Lower the pelvis softly where a leg would be stretched beyond a knee bent by 10 degrees."""
        longest = figure.reach_at(figure.THIGH, figure.SHIN, 10.0)
        root = body.positions["Hips"]
        for side in ("Left", "Right"):
            ankle = self._foot(side, p)[0]
            hip = root + rot.rotate(body.rotations["Hips"], np.array([9.0 if side == "Left" else -9.0, -8.0, 0.0]))
            flat = np.sum((hip - ankle)[:, [0, 2]] ** 2, axis=-1)
            highest = ankle[:, 1] + np.sqrt(longest**2 - flat)
            root[:, 1] -= curves.soft_excess(hip[:, 1] - highest, 0.35)

    def _foot(self, side: str, p: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the ankle's place, the foot's rotation and the toes' rotation."""
        flat = np.radians(TOES_OUT[side])
        toe = ANKLES[side] + np.array([13.0 * np.sin(flat), -6.0, 13.0 * np.cos(flat)])
        yaw = TOES_OUT[side] + (p["heel_yaw"] if side == "Right" else 0.0 * p["heel_yaw"])
        up = p["heel_up"] if side == "Right" else 0.0 * p["heel_up"]
        toes = axis_turn("y", yaw)
        foot = rot.multiply(toes, axis_turn("x", up))
        return toe - rot.rotate(foot, np.array([0.0, -6.0, 13.0])), foot, toes

    # -- arms and club ---------------------------------------------------------------------------------------------

    def _club(self, parameters: FloatArray, body: Figure) -> tuple[dict[str, FloatArray], FloatArray, FloatArray]:
        """Return the hands' rotations, the club's rotation and the place of its grip."""
        p = dict(zip(PARAMETERS, parameters.T, strict=True))
        tilt, turn = np.radians(p["plane"]), np.radians(p["plane_turn"])
        zero = np.zeros_like(tilt)
        e1 = np.stack((np.cos(turn), zero, -np.sin(turn)), axis=-1)
        back = np.stack((-np.sin(turn), zero, -np.cos(turn)), axis=-1)
        e2 = np.cos(tilt)[:, None] * back + np.sin(tilt)[:, None] * np.array([0.0, 1.0, 0.0])
        normal = rot.cross(e1, e2)

        def on_cone(angle: FloatArray, below: FloatArray) -> FloatArray:
            a, b = np.radians(angle)[:, None], np.radians(below)[:, None]
            direction: FloatArray = np.cos(b) * (np.cos(a) * e1 + np.sin(a) * e2) - np.sin(b) * normal
            return direction

        arm = on_cone(p["arm"], p["arm_cone"])
        shaft = on_cone(p["arm"] + p["cock"], p["club_cone"])
        left, right = body.origin("LeftArm"), body.origin("RightArm")
        hub = 0.5 * (left + right)
        local = np.stack((p["finish_x"], p["finish_y"], p["finish_z"]), axis=-1)
        finish = hub + rot.rotate(body.rotations["Spine1"], local)
        # The face stands square to the path in the plane, turned about the shaft by the forearms' roll.
        turn = np.radians(p["arm"] + p["cock"])[:, None]
        path = -np.sin(turn) * e1 + np.cos(turn) * e2
        club = rot.multiply(figure.frame_of(rot.cross(shaft, path), -shaft), axis_turn("y", p["face"]))
        hands = {side: rot.multiply(club, rot.conjugate(held)) for side, held in grips(p["slip"]).items()}
        wrist = left + figure.reach_at(figure.UPPER_ARM, figure.FOREARM, p["left_bend"])[:, None] * arm
        grip = wrist + rot.rotate(hands["Left"], IN_HAND["Left"]) - rot.rotate(club, UP_SHAFT)
        grip = grip + p["finish"][:, None] * (finish - grip)
        grip = within_reach(grip, club, hands, {"Left": left, "Right": right})
        return hands, club, grip

    # -- the whole figure ------------------------------------------------------------------------------------------

    def figure(self, times: FloatArray) -> Figure:
        """Return the poses at times (F,)."""
        parameters = self.parameters(times)
        p = dict(zip(PARAMETERS, parameters.T, strict=True))
        body = self._torso(parameters)
        hands, club, grip = self._club(parameters, body)
        grip = above_ground(grip, club)
        for side in ("Left", "Right"):
            self._leg(body, side, p)
            wrist = wrist_of(side, grip, club, hands[side])
            sign = 1.0 if side == "Left" else -1.0
            body.arm(side, wrist, elbow_to=_elbow_pole(body, p, side))
            body.turn(f"{side}Hand", hands[side])
            body.turn_local(f"{side}FingerBase", axis_turn("z", -sign * p["fingers"]))
            body.turn_local(f"{side}HandIndex1", axis_turn("z", -sign * (p["fingers"] + 8.0)))
        body.turn("Club", club)
        self._look(body, times, p)
        return body

    def _leg(self, body: Figure, side: str, p: dict[str, FloatArray]) -> None:
        ankle, foot, toes = self._foot(side, p)
        knee = TOES_OUT[side] + p[f"{side.lower()}_knee"]
        aim = np.stack((np.sin(np.radians(knee)), np.zeros_like(knee), np.cos(np.radians(knee))), axis=-1)
        body.leg(side, ankle, knee_to=aim)
        body.turn(f"{side}Foot", foot)
        body.turn(f"{side}ToeBase", toes)

    def _look(self, body: Figure, times: FloatArray, p: dict[str, FloatArray]) -> None:
        """Turn neck and head to the ball; after the hit let them follow to the finish."""
        eyes = body.origin("Neck") + np.array([0.0, 14.0, 6.0])
        x, y, z = (np.array([self.swing.ball[0], 0.0, self.swing.ball[1]]) - eyes).T
        pitch = np.degrees(np.arctan2(-y, z)) - 20.0
        cos, sin = np.cos(np.radians(pitch)), np.sin(np.radians(pitch))
        yaw = np.degrees(np.arctan2(x, z * cos - y * sin))
        down = rot.multiply(axis_turn("x", pitch + p["head_pitch"]), axis_turn("y", yaw + p["head_yaw"]))
        down = rot.multiply(down, axis_turn("z", p["head_roll"]))
        t = self.swing.timing
        free = curves.smooth_step(times, t.hit + 0.02, t.finish - 0.05)
        after = rot.multiply(axis_turn("y", 78.0 + p["head_yaw"]), axis_turn("x", 6.0 + p["head_pitch"]))
        after = rot.multiply(after, axis_turn("z", p["head_roll"]))
        body.share(("Neck", "Neck1", "Head"), slerp(down, after, free))


def _elbow_pole(body: Figure, p: dict[str, FloatArray], side: str) -> FloatArray:
    """Return where an elbow points, (F, 3)."""
    name = side.lower()
    sign = 1.0 if side == "Left" else -1.0
    local = (sign * p[f"{name}_elbow_out"], p[f"{name}_elbow_up"], p[f"{name}_elbow_fore"])
    return rot.rotate(body.rotations["Spine1"], unit(np.stack(local, axis=-1)))


def _tilted(tilt: FloatArray, lean: FloatArray, turn: FloatArray) -> FloatArray:
    """Return a turn about the body's own long axis, which is then tilted forward and leant to the left."""
    return rot.multiply(rot.multiply(axis_turn("x", tilt), axis_turn("z", -lean)), axis_turn("y", turn))


# By how much each parameter gives way to the ball (hit), and to the ball at the address: degrees or cm.
_ADAPT = (
    {
        "chest_tilt": 3.0,
        "pelvis_tilt": 1.2,
        "chest_lean": 2.0,
        "pelvis_x": 0.8,
        "arm": 3.0,
        "arm_cone": 3.0,
        "club_cone": 2.0,
        "cock": 1.5,
        "left_bend": 1.5,
        "chest_turn": 1.0,
        "pelvis_y": 0.5,
    },
    {"arm": 3.0, "arm_cone": 3.0, "club_cone": 3.0, "cock": 3.0, "left_bend": 4.0, "chest_tilt": 0.6},
)
