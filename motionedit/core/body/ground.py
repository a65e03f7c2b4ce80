"""Up, heading and travel: the axes of a clip read from its motion, and the frames of a rest pose in front of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen, median
from motionedit.core.body.limbs import zero_pose
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion

_REST_POSE_STEP = 0.6  # rad between two frames: a body does not turn a joint of its trunk or limbs so fast
_REST_POSE_FRAMES = 3
_CLEAR_AXIS = 1.25  # head over feet: the largest part against the next, below it OFFSETs are asked too
_TRAVEL_SHARE = 0.05  # of the widest way that any joint is moved: less is jitter of a static root
_STANCE_SHARE = 0.15  # of the leg: feet nearer together give no line
_LEVEL_SHARE = 0.1  # of the hips' width that must remain when it is laid on the ground


@dataclass(frozen=True, eq=False)
class Frame:
    """A heading frame: `axes` (3, 3) has the rows left, up, forward in world coordinates, `origin` is (3,)."""

    up: FloatArray
    axes: FloatArray
    origin: FloatArray

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


def reference_axes(up: FloatArray) -> FloatArray:
    """Return the rows left, up, forward of heading 0: left is +x (+y where x is up), forward is left x up."""
    left = np.array([0.0, 1.0, 0.0] if abs(up[0]) > 0.5 else [1.0, 0.0, 0.0])
    return np.stack((left, up, np.cross(left, up)))


def axis_vector(name: str) -> FloatArray:
    """Return the unit vector of an axis' name: ``y`` is (0, 1, 0), ``-z`` is (0, 0, -1)."""
    vector = np.zeros(3)
    vector["xyz".index(name[-1].lower())] = -1.0 if name.startswith("-") else 1.0
    return frozen(vector)


def axis_name(up: FloatArray) -> str:
    """Return the name of a signed unit axis: ``y``, ``-z``."""
    axis = int(np.argmax(np.abs(up)))
    return ("-" if up[axis] < 0.0 else "") + "xyz"[axis]


def find_up(motion: Motion, poses: WorldPoses, anatomy: Anatomy) -> FloatArray:
    """Return the signed unit axis in which the head stands over the feet, shape (3,).

    The median over the frames after the rest pose; where no axis is clear, the skeleton's OFFSETs have a say; y where
    there is no body.
    """
    first = rest_pose_frames(motion, anatomy)
    stand = _standing(anatomy, poses.positions[first:])
    if stand is None:
        return axis_vector("y")
    size = np.sort(np.abs(stand))
    if size[2] < _CLEAR_AXIS * size[1]:
        zero = _standing(anatomy, zero_pose(motion.skeleton)[None])
        stand = stand if zero is None else stand / np.linalg.norm(stand) + zero / np.linalg.norm(zero)
    axis = int(np.argmax(np.abs(stand)))
    return axis_vector(("-" if stand[axis] < 0.0 else "") + "xyz"[axis])


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
        if np.linalg.norm(level) > _LEVEL_SHARE * np.linalg.norm(across):
            left = level / np.linalg.norm(level)
            break
    axes = np.stack((left, up, np.cross(left, up)))
    origin = places[travel] - (places[travel] @ up) * up
    return Frame(frozen(np.array(up)), frozen(axes), frozen(origin))


def stance_frame(poses: WorldPoses, anatomy: Anatomy, *, up: FloatArray, frame: int) -> Frame | None:
    """Return the frame of the feet: left along the line of the ankles, the origin on the ground between them.

    None without legs. Behaviours that begin on both feet are laid over each other by it better than by the hips: the
    feet of all clips then stand in one place, and no edit needs to move them.
    """
    if anatomy.legs is None:
        return None
    left_ankle, right_ankle = (poses.positions[frame, leg.ankle] for leg in anatomy.legs)
    across = left_ankle - right_ankle
    level = across - (across @ up) * up
    length = float(np.linalg.norm(level))
    if length < _STANCE_SHARE * anatomy.leg_length:
        return None
    left = level / length
    middle = 0.5 * (left_ankle + right_ankle)
    axes = np.stack((left, up, np.cross(left, up)))
    return Frame(frozen(np.array(up)), frozen(axes), frozen(middle - (middle @ up) * up))


def travel_joint(motion: Motion) -> int:
    """Return the joint that carries the travel: the shallowest with position channels that move.

    It may sit below a static root. Where none moves, the shallowest with position channels; the root where there
    are none.
    """
    joints = motion.skeleton.translated
    if not len(joints):
        return 0
    width = np.linalg.norm(np.ptp(motion.translations, axis=0), axis=-1)
    moving = joints[width >= _TRAVEL_SHARE * width.max()]
    return min((int(j) for j in moving), key=lambda j: (len(motion.skeleton.chain(j)), j))


def rest_pose_frames(motion: Motion, anatomy: Anatomy) -> int:
    """Return how many frames in front of the take (0 to 3) are a rest pose, such as a T-pose.

    A true (geodesic) rotation step above 0.6 rad within the first frames, at a joint that is no wrist, hand, finger
    or toe, ends it.
    """
    joints = [j for j in range(len(motion.skeleton)) if j not in anatomy.digits]
    q = motion.rotations[: _REST_POSE_FRAMES + 1, joints]
    steps = rot.angle_between(q[:-1], q[1:]).max(axis=1, initial=0.0)
    jumps = np.flatnonzero(steps > _REST_POSE_STEP)
    return int(jumps[-1]) + 1 if len(jumps) else 0


def _standing(anatomy: Anatomy, positions: FloatArray) -> FloatArray | None:
    """Return the median of head minus feet, shape (3,); of head minus chest and the like where one is missing."""
    feet = [] if anatomy.legs is None else [leg.ankle for leg in anatomy.legs]
    top = anatomy.head if anatomy.head is not None else anatomy.chest
    low = feet or [j for j in (anatomy.chest,) if j is not None and j != top]
    if top is None or not low:
        return None
    stand: FloatArray = median(positions[:, top] - positions[:, low].mean(axis=1))
    return stand if np.any(stand) else None


def _sideways(anatomy: Anatomy) -> list[tuple[int, int]]:
    """Return the pairs of joints whose line points from right to left, the surest first."""
    pairs = []
    if anatomy.legs is not None:
        pairs.append((anatomy.legs[0].thigh, anatomy.legs[1].thigh))
    if anatomy.arms is not None:
        pairs.append((anatomy.arms[0].shoulder, anatomy.arms[1].shoulder))
    return pairs
