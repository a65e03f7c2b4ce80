"""What bodies do, for any rig of human.py's body: turns of its joints and the path of its hips, at any frame rate."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from human import HIPS_HEIGHT, SHANK, THIGH

from motionedit.core import rotations as rot

SIDES = {"Left": 1.0, "Right": -1.0}


@dataclass(frozen=True, eq=False)
class Take:
    """What a body does: `turns` (F, 4) of joints by their names in human.py, and the path of its `hips` (F, 3).

    In metres, y up, facing z. `stands` has for each foot when it stands, (first, last) in seconds.
    """

    turns: dict
    hips: np.ndarray
    rate: float
    stands: dict | None = None


def clock(seconds, rate):
    """Return the times of the frames of a clip."""
    return np.arange(round(seconds * rate) + 1) / rate


def wave(t, size, hertz, phase=0.0):
    return size * np.sin(2.0 * np.pi * (hertz * t + phase))


def about(axis, angle, t):
    return rot.about_axis(axis, np.broadcast_to(np.asarray(angle, dtype=float), np.shape(t)))


def smooth(t, first, last):
    """Return 0 before `first`, 1 after `last`, and a smooth way in between."""
    s = np.clip((t - first) / (last - first), 0.0, 1.0)
    return s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi)


def waving(t):
    """Return the turns of arms and trunk of somebody who talks with their hands."""
    return {
        "LeftArm": about(2, 0.5 + wave(t, 0.4, 0.7), t),
        "RightArm": about(0, wave(t, 0.7, 0.5, 0.2) - 0.5, t),
        "RightForeArm": about(0, wave(t, 0.4, 0.8) - 0.6, t),
        "Spine": about(1, wave(t, 0.15, 0.4), t),
        "Neck": about(1, wave(t, 0.3, 0.3), t),
    }


def waving_in_front(t):
    """Return the same of somebody whose back stays where it is, on a floor, and no arm behind it."""
    still = waving(t) | {"RightArm": about(0, wave(t, 0.6, 0.5, 0.2) - 0.9, t)}
    return {name: turn for name, turn in still.items() if name != "Spine"}


def foot_path(t, stances, *, lift=0.12):
    """Return the path (F, 3) of a foot that stands at places (3,) from one time to another and steps in between."""
    path = np.tile(np.asarray(stances[0][2], dtype=float), (len(t), 1))
    for (_, off, here), (on, _, there) in pairwise(stances):
        way = smooth(t, off, on)
        path += way[:, None] * (np.asarray(there, dtype=float) - here)
        path[:, 1] += lift * np.sin(np.pi * np.clip((t - off) / (on - off), 0.0, 1.0)) ** 2
    return path


def footfalls(seconds, *, speed, cycle, duty, first, height=0.08, rise=0.0):
    """Return when and where a foot stands, as `foot_path` takes it, from `first` (s) on, each stance `rise` higher."""
    stances = []
    for n in range(-1, int(seconds / cycle) + 2):
        on = cycle * n + first
        stances.append((on, on + duty * cycle, (0.0, height + rise * n, speed * (on + 0.5 * duty * cycle))))
    return stances


def legs_to(hips, paths):
    """Return the turns of legs in the plane that brings each ankle to its path, the knee in front, the foot level."""
    turns = {}
    for side, path in paths.items():
        down, ahead = hips[:, 1] - 0.05 - path[:, 1], path[:, 2] - hips[:, 2]
        length = np.minimum(np.hypot(down, ahead), 0.9999 * (THIGH + SHANK))
        line = np.arctan2(-ahead, down)
        at_hip = np.arccos((THIGH**2 + length**2 - SHANK**2) / (2.0 * THIGH * length))
        at_ankle = np.arccos((SHANK**2 + length**2 - THIGH**2) / (2.0 * SHANK * length))
        turns[side + "UpLeg"] = rot.about_axis(0, line - at_hip)
        turns[side + "Leg"] = rot.about_axis(0, at_hip + at_ankle)
        turns[side + "Foot"] = rot.about_axis(0, -line - at_ankle)
    return turns


def stands(rate, seconds=2.0):
    t = clock(seconds, rate)
    hips = np.stack((wave(t, 0.01, 0.3), np.full(len(t), HIPS_HEIGHT), wave(t, 0.01, 0.2)), axis=1)
    whole = {foot: [(0.0, seconds)] for foot in ("left", "right")}
    return Take(waving(t), hips, rate, whole)


def steps(rate, seconds, *, speed, duty):
    t = clock(seconds, rate)
    hips = np.stack((np.zeros(len(t)), 0.9 + wave(t, 0.01, 2 / 1.1), speed * t), axis=1)
    falls = {
        side: footfalls(seconds, speed=speed, cycle=1.1, duty=duty, first=first)
        for side, first in (("Left", 0.3), ("Right", 0.85))
    }
    turns = waving(t) | legs_to(hips, {side: foot_path(t, stances) for side, stances in falls.items()})
    when = {side.lower(): within(stances, t[-1]) for side, stances in falls.items()}
    return Take(turns, hips, rate, when)


def within(stances, seconds):
    """Return the (first, last) times of stances that a clip of so many seconds has."""
    spans = [(max(on, 0.0), min(off, seconds)) for on, off, _ in stances]
    return [(on, off) for on, off in spans if off > on]


def walks(rate, seconds=3.0):
    return steps(rate, seconds, speed=0.9, duty=0.62)


def marches(rate, seconds=3.0):
    return steps(rate, seconds, speed=0.0, duty=0.6)


def sits(rate, seconds=2.0):
    t = clock(seconds, rate)
    turns = waving(t)
    for side in SIDES:
        turns |= {side + "UpLeg": about(0, -1.5, t), side + "Leg": about(0, 1.5, t)}
    return Take(turns, np.tile([0.0, 0.56, 0.0], (len(t), 1)), rate)


def lies(rate, seconds=2.0):
    """On the back, the head away from +z, the left knee drawn up a little now and then."""
    t = clock(seconds, rate)
    knee = 0.4 * np.sin(np.pi * t / seconds) ** 2
    turns = waving_in_front(t) | {
        "Hips": about(0, -np.pi / 2, t),
        "LeftUpLeg": about(0, -knee, t),
        "LeftLeg": about(0, knee, t),
    }
    return Take(turns, np.tile([0.0, 0.12, 0.0], (len(t), 1)), rate)


def crawls(rate, seconds=3.0):
    t = clock(seconds, rate)
    turns = {"Hips": about(0, np.pi / 2, t), "Neck": about(0, -0.7, t)}
    for side, sign in SIDES.items():
        swing = wave(t, 0.3 * sign, 0.8)
        turns |= {side + "UpLeg": about(0, swing - np.pi / 2, t), side + "Leg": about(0, np.pi / 2 - swing, t)}
        turns |= {side + "Foot": about(0, 1.2, t), side + "Arm": about(0, -swing - np.pi / 2, t)}
    hips = np.stack((np.zeros(len(t)), np.full(len(t), 0.5), 0.4 * t), axis=1)
    return Take(turns, hips, rate)


def swims(rate, seconds=3.0):
    """Face down, high above the floor, forward."""
    t = clock(seconds, rate)
    turns = {"Hips": about(0, np.pi / 2, t), "Neck": about(0, -0.3, t)}
    for side, sign in SIDES.items():
        turns[side + "UpLeg"] = about(0, wave(t, 0.25 * sign, 1.2), t)
        turns[side + "Foot"] = about(0, 1.0, t)
        turns[side + "Arm"] = about(0, 2.0 * np.pi * 0.6 * t + (np.pi if sign > 0 else 0.0), t)
    hips = np.stack((np.zeros(len(t)), 0.8 + wave(t, 0.02, 1.2), 0.9 * t), axis=1)
    return Take(turns, hips, rate)


def handstands(rate, seconds=2.0):
    t = clock(seconds, rate)
    turns = {"Hips": about(0, np.pi + wave(t, 0.03, 0.5), t)}
    for side, sign in SIDES.items():
        turns |= {side + "Arm": about(0, np.pi - wave(t, 0.03, 0.5), t)}
        turns |= {side + "UpLeg": about(0, wave(t, 0.05 * sign, 0.6), t)}
    return Take(turns, np.tile([0.0, 1.15, 0.0], (len(t), 1)), rate)


def falls(rate, seconds=4.0):
    """Stands, falls on the back, and lies for the rest."""
    t = clock(seconds, rate)
    lean = np.pi / 2 * smooth(t, 0.5, 1.2)
    turns = waving_in_front(t) | {"Hips": about(0, -lean, t)}
    hips = np.stack((np.zeros(len(t)), 0.08 + 0.9 * np.cos(lean) + 0.04 * np.sin(lean), -0.9 * np.sin(lean)), axis=1)
    return Take(turns, hips, rate)


def jumps(rate, seconds=2.4):
    """Jumps twice, the legs stiff."""
    t = clock(seconds, rate)
    flights = [(0.5, 1.0), (1.4, 1.9)]
    height = sum(0.5 * 9.81 * np.maximum((t - off) * (on - t), 0.0) for off, on in flights)
    hips = np.stack((np.zeros(len(t)), HIPS_HEIGHT + height, np.zeros(len(t))), axis=1)
    stance = [(0.0, 0.5), (1.0, 1.4), (1.9, t[-1])]
    return Take(waving(t), hips, rate, {"left": stance, "right": stance})


TAKES = {take.__name__: take for take in (stands, walks, marches, sits, lies, crawls, swims, handstands, falls, jumps)}


def with_rest_pose(take):
    """Return the take with one frame of a T-pose in front."""
    arms = {side + "Arm": rot.about_axis(2, np.array([sign * np.pi / 2])) for side, sign in SIDES.items()}
    rest = np.array([[1.0, 0.0, 0.0, 0.0]])
    turns = {name: np.concatenate((arms.get(name, rest), turn)) for name, turn in take.turns.items()}
    return replace(take, turns=turns, hips=np.concatenate(([[0.0, HIPS_HEIGHT, 0.0]], take.hips)))
