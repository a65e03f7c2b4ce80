"""The ground: axes by name, and the frames that a clip is seen in, by its heading or by its feet."""

from __future__ import annotations

from functools import cache, lru_cache
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses

_STANCE_SHARE = 0.15  # of the leg: feet nearer together give no line
_LEVEL_SHARE = 0.1  # of the hips' width that must remain when it is laid on the ground


@dataclass(frozen=True, eq=False)
class Frame:
    """A heading frame: `axes` (3, 3) has the rows left, up, forward in world coordinates, `origin` is (3,)."""

    axes: FloatArray
    origin: FloatArray

    def __reduce__(self) -> tuple[Callable[..., Frame], tuple[bytes, bytes]]:
        # Two for each clip of a run go to another process: bytes are packed in a third of an array's time.
        return _unpacked, (self.axes.tobytes(), self.origin.tobytes())

    @property
    def up(self) -> FloatArray:
        """The unit axis that is up, shape (3,)."""
        up: FloatArray = self.axes[1]
        return up

    def points(self, world: FloatArray) -> FloatArray:
        """Return world positions in this frame, shape (..., 3), clip units."""
        return (world - self.origin) @ self.axes.T

    def vectors(self, world: FloatArray) -> FloatArray:
        """Return world vectors, such as shifts, in this frame, shape (..., 3)."""
        return world @ self.axes.T

    def world_points(self, local: FloatArray) -> FloatArray:
        """Return positions given in this frame in the world, shape (..., 3), clip units."""
        return local @ self.axes + self.origin

    @property
    def rotation(self) -> FloatArray:
        """Quaternion that turns this frame's coordinates into the world's, shape (4,)."""
        return rot.from_matrix(self.axes.T)

    @property
    def degrees(self) -> float:
        """Turn about `up` from the file's own axes to this frame; 0 is facing +z where y is up."""
        start = reference_axes(self.up)
        forward = self.axes[2]
        return float(np.degrees(np.arctan2(forward @ start[0], forward @ start[2])))


def _unpacked(axes: bytes, origin: bytes) -> Frame:
    return Frame(np.frombuffer(axes).reshape(3, 3), np.frombuffer(origin))


def reference_axes(up: FloatArray) -> FloatArray:
    """Return the rows left, up, forward of heading 0: left is +x (+y where x is up), forward is left x up."""
    return _reference_axes(*up.tolist())


@lru_cache(maxsize=6)
def _reference_axes(*up: float) -> FloatArray:
    left = np.array([0.0, 1.0, 0.0] if abs(up[0]) > 0.5 else [1.0, 0.0, 0.0])
    return frozen(np.array([left, up, rot.cross(left, np.array(up))]))


@cache
def axis_vector(name: str) -> FloatArray:
    """Return the unit vector of an axis' name: ``y`` is (0, 1, 0), ``-z`` is (0, 0, -1)."""
    vector = np.zeros(3)
    vector["xyz".index(name[-1].lower())] = -1.0 if name.startswith("-") else 1.0
    return frozen(vector)


def axis_name(up: FloatArray) -> str:
    """Return the name of a signed unit axis: ``y``, ``-z``."""
    parts = up.tolist()
    axis = parts.index(max(parts, key=abs))
    return ("-" if parts[axis] < 0.0 else "") + "xyz"[axis]


def heading_frame(poses: WorldPoses, anatomy: Anatomy, *, up: FloatArray, frame: int, travel: int) -> Frame:
    """Return the heading frame at one frame: x to the character's left, y up, z forward.

    Its origin lies on the ground (up = 0) under the joint that carries the travel. Left is the line of the hips,
    where they are level enough, else of the shoulders; without either the frame has the file's own axes.
    """
    places = poses.positions[frame]
    left = reference_axes(up)[0]
    for a, b in _sideways(anatomy):
        across = places[a] - places[b]
        level = across - (across @ up) * up
        length = sqrt(level @ level)
        if length > _LEVEL_SHARE * sqrt(across @ across):
            left = level / length
            break
    return _frame(left, up, under=places[travel])


def stance_frame(poses: WorldPoses, anatomy: Anatomy, *, up: FloatArray, frame: int) -> Frame | None:
    """Return the frame of the feet: left along the line of the ankles, the origin on the ground between them.

    None without legs. Behaviours that begin on both feet are laid over each other by it better than by the hips: the
    feet of all clips then stand in one place, and no edit needs to move them.
    """
    if anatomy.legs is None:
        return None
    left_ankle, right_ankle = (poses.positions[frame, leg.ankle] for leg in anatomy.left_first(anatomy.legs))
    across = left_ankle - right_ankle
    level = across - (across @ up) * up
    length = sqrt(level @ level)
    if length < _STANCE_SHARE * anatomy.leg_length:
        return None
    return _frame(level / length, up, under=0.5 * (left_ankle + right_ankle))


def _frame(left: FloatArray, up: FloatArray, *, under: FloatArray) -> Frame:
    """Return the frame whose origin lies on the ground under a point."""
    axes = np.array([left, up, rot.cross(left, up)])
    return Frame(frozen(axes), frozen(under - (under @ up) * up))


def _sideways(anatomy: Anatomy) -> list[tuple[int, int]]:
    """Return the pairs of joints whose line points from right to left, the surest first."""
    pairs = []
    if anatomy.legs is not None:
        pairs.append((anatomy.legs[0].thigh, anatomy.legs[1].thigh))
    if anatomy.arms is not None:
        pairs.append((anatomy.arms[0].shoulder, anatomy.arms[1].shoulder))
    return [anatomy.left_first(pair) for pair in pairs]
