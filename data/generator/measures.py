"""What is measured on real and generated clips alike: timing, turns, bends, paths; angles in degrees, lengths in cm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator.figure import unit
from motionedit.core import kinematics
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion

# Lengths are given for a leg of so many cm, whatever the clip's unit and the person's size.
LEG = 1e2 * STANDARD_LEG


class Track:
    """Joint positions of a motion, scaled to a leg of `LEG` cm; `names` maps our joint names to the clip's."""

    def __init__(self, motion: Motion, *, first: int = 0, names: Mapping[str, str] | None = None) -> None:
        self.names = dict(names or {})
        self.joints = motion.skeleton.names
        self.rate = motion.frame_rate
        positions = kinematics.forward(motion).positions[first:]
        offsets = np.linalg.norm(motion.skeleton.offsets, axis=-1)
        leg = sum(offsets[self._index(f"{side}{part}")] for side in ("Left", "Right") for part in ("Leg", "Foot"))
        self.positions: FloatArray = positions * (2.0 * LEG / leg)

    def _index(self, name: str) -> int:
        return self.joints.index(self.names.get(name, name))

    def __getitem__(self, name: str) -> FloatArray:
        return self.positions[:, self._index(name)]

    def bend(self, a: str, b: str, c: str) -> FloatArray:
        """Return how far a joint `b` is bent away from straight, (F,)."""
        cosine = np.sum(unit(self[b] - self[a]) * unit(self[c] - self[b]), axis=-1)
        angle: FloatArray = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        return angle

    def knee(self, side: str) -> FloatArray:
        """Return the bend of a knee."""
        return self.bend(f"{side}UpLeg", f"{side}Leg", f"{side}Foot")

    def elbow(self, side: str) -> FloatArray:
        """Return the bend of an elbow."""
        return self.bend(f"{side}Arm", f"{side}ForeArm", f"{side}Hand")

    def speed(self, path: FloatArray) -> FloatArray:
        """Return the speed along a path (F, 3), cm/s."""
        rate: FloatArray = np.linalg.norm(np.gradient(path, 1.0 / self.rate, axis=0), axis=-1)
        return rate


def swing_measures(motion: Motion, *, hit: int) -> dict[str, float]:
    """Return the measures of a right-handed golf swing whose hit is known."""
    track = Track(motion)
    hands = 0.5 * (track["LeftHand"] + track["RightHand"])
    speed = track.speed(hands)
    top = _slowest(speed, hit - round(1.0 * track.rate), hit - round(0.25 * track.rate))
    still = np.flatnonzero(speed[:top] < 0.06 * speed[top:].max())
    takeaway = int(still[still < top - round(0.3 * track.rate)].max())
    after = speed[hit + round(0.3 * track.rate) :]
    finish = hit + round(0.3 * track.rate) + int(np.argmax(after < 0.15 * speed.max()))
    left = unit((track["LeftFoot"] - track["RightFoot"])[takeaway] * np.array([1.0, 0.0, 1.0]))
    forward = np.cross(left, [0.0, 1.0, 0.0])
    hips = _turn(track["LeftUpLeg"] - track["RightUpLeg"], left, forward)
    shoulders = _turn(track["LeftArm"] - track["RightArm"], left, forward)
    hips, shoulders = hips - hips[takeaway], shoulders - shoulders[takeaway]
    shift = (track["Hips"] - track["Hips"][takeaway]) @ left
    head = np.linalg.norm(track["Head"] - track["Head"][takeaway], axis=-1)
    down = hands[top : hit + 1] - hands[top : hit + 1].mean(axis=0)
    normal = np.linalg.svd(down)[2][2]
    hub = 0.5 * (track["LeftArm"] + track["RightArm"])
    shoulder_height = hub[takeaway, 1]
    return {
        "backswing, s": (top - takeaway) / track.rate,
        "downswing, s": (hit - top) / track.rate,
        "backswing / downswing": (top - takeaway) / (hit - top),
        "hit to finish, s": (finish - hit) / track.rate,
        "fastest hands, cm/s": float(speed.max()),
        "hands fastest before the hit, s": (hit - int(np.argmax(speed))) / track.rate,
        "plane of the hands' way down, from level": float(np.degrees(np.arccos(abs(normal[1])))),
        "hands to shoulder centre, way down": float(np.linalg.norm(hands - hub, axis=-1)[top : hit + 1].mean()),
        "hands over shoulders' height, top": float(hands[top, 1] - shoulder_height),
        "hips turned, top": float(hips[top]),
        "hips turned, hit": float(hips[hit]),
        "hips turned, finish": float(hips[finish]),
        "shoulders turned, top": float(shoulders[top]),
        "shoulders turned, hit": float(shoulders[hit]),
        "shoulders turned, finish": float(shoulders[finish]),
        "hips lead shoulders at the hit": float(hips[hit] - shoulders[hit]),
        "hips toward target, top": float(shift[top]),
        "hips toward target, hit": float(shift[hit]),
        "hips toward target, finish": float(shift[finish]),
        "head moved until the hit, most": float(head[takeaway : hit + 1].max()),
        "left knee, address": float(track.knee("Left")[takeaway]),
        "left knee, top": float(track.knee("Left")[top]),
        "left knee, hit": float(track.knee("Left")[hit]),
        "right knee, address": float(track.knee("Right")[takeaway]),
        "left elbow, top": float(track.elbow("Left")[top]),
        "left elbow, hit": float(track.elbow("Left")[hit]),
        "right elbow, top": float(track.elbow("Right")[top]),
        "right elbow, hit": float(track.elbow("Right")[hit]),
        "right heel up, hit": float((track["RightFoot"][hit] - track["RightFoot"][takeaway])[1]),
        "right heel up, finish": float((track["RightFoot"][finish] - track["RightFoot"][takeaway])[1]),
    }


def walk_measures(motion: Motion, *, first: int = 0) -> dict[str, float]:
    """Return the measures of a straight walk."""
    track = Track(motion, first=first)
    hips = track["Hips"]
    way = (hips[-1] - hips[0]) * np.array([1.0, 0.0, 1.0])
    forward = unit(way)
    left = np.cross([0.0, 1.0, 0.0], forward)
    gap = {side: (track[f"{side}Foot"] - hips) @ forward for side in ("Left", "Right")}
    landings = sorted(frame for side in gap for frame in _peaks(gap[side], round(0.4 * track.rate)))
    seconds = np.diff(landings) / track.rate
    pace = float(np.linalg.norm(way)) / ((len(hips) - 1) / track.rate)
    thigh = {side: _pitch(track[f"{side}Leg"] - track[f"{side}UpLeg"], forward) for side in gap}
    arm = {side: _pitch(track[f"{side}ForeArm"] - track[f"{side}Arm"], forward) for side in gap}
    sway = hips @ left
    sway = sway - np.polyval(np.polyfit(np.arange(len(sway)), sway, 3), np.arange(len(sway)))
    yaw = _turn(track["LeftUpLeg"] - track["RightUpLeg"], left, forward)
    chest = _turn(track["LeftArm"] - track["RightArm"], left, forward)
    height = hips[:, 1] - np.polyval(np.polyfit(np.arange(len(hips)), hips[:, 1], 1), np.arange(len(hips)))
    lift = [track[f"{side}Foot"][:, 1] for side in gap]
    return {
        "pace, cm/s": pace,
        "steps a minute": float(60.0 / np.mean(seconds)),
        "step length, cm": pace * float(np.mean(seconds)),
        "knee, most (swing)": _mean(track.knee(side).max() for side in gap),
        "knee, least": _mean(track.knee(side).min() for side in gap),
        "knee as the heel lands": float(
            np.mean([min(track.knee(s)[f] for s in gap if gap[s][f] > 0) for f in landings])
        ),
        "thigh, foremost": _mean(thigh[side].max() for side in gap),
        "thigh, rearmost": _mean(thigh[side].min() for side in gap),
        "upper arm swings over": _mean(np.ptp(arm[side]) for side in gap),
        "elbow, least to most": _mean(np.ptp(track.elbow(side)) for side in gap),
        "left arm with right thigh (correlation)": float(np.corrcoef(arm["Left"], thigh["Right"])[0, 1]),
        "hips up and down, cm": float(np.ptp(height)),
        "hips side to side, cm": float(np.ptp(sway)),
        "hips turn to and fro": float(np.ptp(yaw)),
        "shoulders turn to and fro": float(np.ptp(chest)),
        "ankle lifted, cm": _mean(np.ptp(path) for path in lift),
        "fastest ankle, cm/s": _mean(track.speed(track[f"{side}Foot"]).max() for side in gap),
    }


def kick_measures(motion: Motion, *, side: str, names: Mapping[str, str] | None = None) -> dict[str, float]:
    """Return the measures of a kick by the leg of that side; feet are measured from the hips."""
    track = Track(motion, names=names)
    foot = track[f"{side}Foot"] - track["Hips"]
    speed = track.speed(foot)
    knee = track.knee(side)
    fast = int(np.argmax(speed))
    near = round(0.3 * track.rate)
    out = fast + int(np.argmin(knee[fast : fast + near]))
    folded = out - near + int(np.argmax(knee[out - near : out]))
    pulled = out + int(np.argmax(knee[out : out + 2 * near]))
    other = "Left" if side == "Right" else "Right"
    return {
        "fastest foot, cm/s": float(speed.max()),
        "knee folded before": float(knee[folded]),
        "knee at the hit": float(knee[out]),
        "knee folded again": float(knee[pulled]),
        "folded to hit, s": (out - folded) / track.rate,
        "hit to folded, s": (pulled - out) / track.rate,
        "supporting knee at the hit": float(track.knee(other)[out]),
        "foot over the hips at the hit, cm": float(foot[out, 1]),
    }


def _mean(values: object) -> float:
    return float(np.mean(list(values)))  # type: ignore[call-overload]


def _slowest(speed: FloatArray, begin: int, end: int) -> int:
    return begin + int(np.argmin(speed[begin:end]))


def _turn(line: FloatArray, left: FloatArray, forward: FloatArray) -> FloatArray:
    """Return how far a line from right to left is turned to the left, unwrapped."""
    angle: FloatArray = np.degrees(np.unwrap(np.arctan2(-line @ forward, line @ left)))
    return angle


def _pitch(bone: FloatArray, forward: FloatArray) -> FloatArray:
    angle: FloatArray = np.degrees(np.arctan2(bone @ forward, -bone[:, 1]))
    return angle


def _peaks(signal: FloatArray, apart: int) -> list[int]:
    """Return frames that are the largest within `apart` frames on both sides."""
    return [
        i
        for i in range(apart, len(signal) - apart)
        if signal[i] == signal[i - apart : i + apart + 1].max() and signal[i] > 0.0
    ]
