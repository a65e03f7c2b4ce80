"""Measures of a motion's quality, jerk and sliding feet, and its capture defects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.plant_frames import frames_of, spans_of
from motionedit.core.compiled import compiled
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.contacts import Plant
    from motionedit.core.motion import Motion

# An input's jerk counts as this at the least, m / s^3 at leg length 0.85 m: a clip that stands still has none to be
# compared with. Half a metre within 0.8 s has as much on the smoothest path; captures have from 100 to 4000.
STILL = 30.0

_DEFECT_STEP = 1.0  # rad between two frames: no joint turns so fast
_DEFECT_COSINE = float(np.cos(0.5 * _DEFECT_STEP)) + 1e-6  # of half the step; more by far than rounding
_FLIP = float(np.radians(150.0))  # a step this near to half a turn is a flip, not a fast motion


@dataclass(frozen=True)
class Defect:
    """A joint that jumps between frames.

    Attributes
    ----------
    frames : tuple of int
        The frames into which it jumps: the step is from the frame before.
    worst, angle : int, float
        The frame of the largest step, and that step (rad).
    flips : int
        How many of the steps are about half a turn.
    """

    joint: int
    frames: tuple[int, ...]
    worst: int
    angle: float
    flips: int


def jerk_rms(positions: FloatArray, *, frame_time: float, first: int = 0) -> float:
    """Return the root mean square third difference of all joint positions over time, clip units / s^3.

    sqrt(mean over frames and joints of |p(f+3) - 3 p(f+2) + 3 p(f+1) - p(f)|^2) / dt^3; 0 below four frames.

    Parameters
    ----------
    positions : shape (F, J, 3)
    first : int
        The first frame after a rest pose; earlier ones are left out.
    """
    meter = JerkMeter(first)
    meter.add(positions)
    return meter.rms(frame_time=frame_time)


class JerkMeter:
    """The jerk of positions that come in blocks of frames, in order; see `jerk_rms`."""

    def __init__(self, first: int) -> None:
        self._skip = first
        self._last: FloatArray | None = None
        self._sum, self._count = 0.0, 0
        self._next, self._largest, self._at = first, 0.0, (0, first)

    def add(self, positions: FloatArray) -> None:
        """Take the positions, shape (F, J, 3), of the frames that follow those before."""
        skipped = min(self._skip, len(positions))
        self._skip -= skipped
        positions = positions[skipped:]
        if self._last is not None:
            positions = np.concatenate((self._last, positions))
        squares, largest, frame, joint = squared_jerks(positions)
        self._sum += float(np.sum(squares))
        self._count += len(squares) * positions.shape[1]
        if largest > self._largest:
            # Of the four frames that it is taken from, the third.
            self._largest, self._at = largest, (joint, self._next + frame + 2)
        self._last = positions[-3:].copy()
        self._next += max(len(positions) - 3, 0)

    def rms(self, *, frame_time: float) -> float:
        """Return the root mean square third difference over time, clip units / s^3; 0 below four frames."""
        return float(np.sqrt(self._sum / self._count)) / frame_time**3 if self._count else 0.0

    @property
    def worst(self) -> tuple[int, int]:
        """The joint and the frame of the largest third difference."""
        return self._at


def squared_jerks(positions: FloatArray) -> tuple[FloatArray, float, int, int]:
    """Return each frame's squared third difference, summed over joints, shape (F - 3,) of positions (F, J, 3).

    And the largest of any joint, with its frame and joint; 0 where there are less than four frames.
    """
    frames, joints = positions.shape[:2]
    if frames < 4 or not joints:
        return np.zeros(0), 0.0, 0, 0
    kernel = compiled()
    if kernel is not None:
        summed = np.empty(frames - 3)
        return summed, *kernel.jerks(np.ascontiguousarray(positions), frames, joints, summed)
    third = np.diff(positions, n=3, axis=0)
    third *= third
    squares = third[..., 0] + third[..., 1] + third[..., 2]
    frame, joint = np.unravel_index(int(np.argmax(squares)), squares.shape)
    return squares.sum(axis=1), float(squares[frame, joint]), int(frame), int(joint)


def foot_slide_max(tracks: FloatArray, plants: Sequence[Plant], *, up: FloatArray, frame_time: float) -> float:
    """Return the fastest horizontal speed of a planted point from frame to frame, clip units / s; 0 without plants.

    `tracks` (F, P, 3) are those of `sole_tracks`. For an edit the plants are those of its input.
    """
    kernel = compiled()
    if kernel is not None:
        spans = spans_of(plants)
        farthest: float = kernel.foot_slide(np.ascontiguousarray(tracks), up, spans, *tracks.shape[:2], len(spans))
        return farthest / frame_time
    down = frames_of(plants)
    if down is None:
        return 0.0
    # From each frame of a plant to the next: not from its last.
    inner = np.ones(len(down.frames), dtype=np.bool_)
    inner[down.starts + down.counts - 1] = False
    frames, points = down.frames[inner], down.points[inner]
    step = tracks[frames + 1, points] - tracks[frames, points]
    level = step - (step @ up)[:, None] * up
    return float(rot.length(level).max(initial=0.0)) / frame_time


def foot_drift(before: FloatArray, after: FloatArray, plants: Sequence[Plant]) -> float:
    """Return the largest distance between a planted point in two motions, clip units; 0 without plants.

    Both are the tracks (F, P, 3) of the same points; the plants are those of the first.
    """
    kernel = compiled()
    if kernel is not None:
        spans, own, other = spans_of(plants), np.ascontiguousarray(before), np.ascontiguousarray(after)
        farthest: float = kernel.foot_drift(own, None, spans, *before.shape[:2], len(spans), other)
        return farthest
    down = frames_of(plants)
    return 0.0 if down is None else float(rot.length(down.of(after) - down.of(before)).max())


def find_defects(motion: Motion, *, first: int = 0) -> list[Defect]:
    """Return the joints with a true (geodesic) rotation step above 1 rad, in the skeleton's order.

    Another Euler branch is no step. Frames before `first`, a rest pose, are left out, and so is the step out of it.
    """
    q = motion.rotations[first:]
    # A cosine of half the step costs less than the step, and nearly all joints, and most motions, are let off by it.
    cosines = rot.half_cosines(q[:-1], q[1:])
    if cosines.min(initial=1.0) >= _DEFECT_COSINE:
        return []
    defects = []
    for joint in np.flatnonzero((cosines < _DEFECT_COSINE).any(axis=0)):
        steps = rot.angle_between(q[:-1, joint], q[1:, joint])
        at = np.flatnonzero(steps > _DEFECT_STEP)
        if len(at):
            worst = int(at[np.argmax(steps[at])])
            flips = int(np.count_nonzero(steps[at] > _FLIP))
            frames = tuple(int(f) + first + 1 for f in at)
            defects.append(Defect(int(joint), frames, worst + first + 1, float(steps[worst]), flips))
    return defects
