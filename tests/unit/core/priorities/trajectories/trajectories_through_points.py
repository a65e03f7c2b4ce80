"""Paths and turns of ten seconds, points on them, and how far what goes through these jumps."""

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.trajectories.positions import (
    ControlPoint,
    position_targets,
)
from motionedit.core.priorities.trajectories.rotations import rotation_targets

# Frames so fine that a difference between two of them is a derivative: 10 s at 1000 frames a second.
FRAMES, RATE = 10001, 1000.0
T = np.arange(FRAMES) / RATE
PATH = np.stack((np.sin(T), 0.3 * np.cos(2.0 * T) + 0.1, 1.2 * T), axis=1)
TURNS = rot.multiply(rot.exp(np.outer(T, [0.0, 0.5, 0.0])), rot.exp(np.outer(np.sin(T), [0.4, 0.1, -0.3])))
SHIFT = np.array([0.1, 0.7, -0.3])
PLACE = np.array([1.3, 2.1, 4.7])
TURN = rot.exp(np.array([0.3, -1.1, 0.4]))


def hold(start, stop, position=None, shift=None, **more):
    return ControlPoint("hold", start, stop, position, shift, **more)


def during(start, stop, shift=None):
    return ControlPoint("during", start, stop, None, shift)


def at(frame, position=None, shift=None, **more):
    return ControlPoint("at", frame, frame, position, shift, **more)


def targets(points, *, path=PATH, ease=1000.0, curve="time"):
    return position_targets(path, points, ease_in=ease, ease_out=ease, curve=curve)


def whole(points, **how):
    """Return the input with the targets laid into it, shape (F, 3)."""
    path = how.get("path", PATH).copy()
    first, found = targets(points, **how)
    path[first : first + len(found)] = found
    return path


def turned(points, *, turns=TURNS, ease=1000.0):
    turns = turns.copy()
    first, found = rotation_targets(turns, points, ease_in=ease, ease_out=ease)
    turns[first : first + len(found)] = found
    return turns


def largest_jump(path, rate=RATE):
    """Return the largest change of velocity from one frame to the next, units a second."""
    return np.linalg.norm(np.diff(path, n=2, axis=0), axis=1).max() * rate


def largest_turn_jump(turns):
    """Return the largest change of angular velocity from one frame to the next, rad a second."""
    steps = rot.log(rot.multiply(rot.conjugate(turns[:-1]), turns[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=1).max() * RATE
