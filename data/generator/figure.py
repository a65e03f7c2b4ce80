"""The stick figure: skeletons with CMU's names, poses built joint by joint, and limbs of two bones."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite, Skeleton

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

_ROTATIONS = ("Zrotation", "Yrotation", "Xrotation")
_POSITIONS = ("Xposition", "Yposition", "Zposition")

# Lengths of the limbs, cm.
THIGH, SHIN = 43.5, 43.0
UPPER_ARM, FOREARM = 29.0, 25.5

# In the T-pose the elbows bend forward and up, so far from straight forward (degrees), as CMU's do: bending about y
# alone would take every right-angled elbow through the lock of ZYX angles.
ELBOW_TILT = 40.0

# (joint, parent, offset in cm); a man of 178 cm in a T-pose, facing z, his left along x, palms down.
_BODY: tuple[tuple[str, str | None, tuple[float, float, float]], ...] = (
    ("Hips", None, (0.0, 0.0, 0.0)),
    ("LHipJoint", "Hips", (0.0, 0.0, 0.0)),
    ("LeftUpLeg", "LHipJoint", (9.0, -8.0, 0.0)),
    ("LeftLeg", "LeftUpLeg", (0.0, -THIGH, 0.0)),
    ("LeftFoot", "LeftLeg", (0.0, -SHIN, 0.0)),
    ("LeftToeBase", "LeftFoot", (0.0, -6.0, 13.0)),
    ("RHipJoint", "Hips", (0.0, 0.0, 0.0)),
    ("RightUpLeg", "RHipJoint", (-9.0, -8.0, 0.0)),
    ("RightLeg", "RightUpLeg", (0.0, -THIGH, 0.0)),
    ("RightFoot", "RightLeg", (0.0, -SHIN, 0.0)),
    ("RightToeBase", "RightFoot", (0.0, -6.0, 13.0)),
    ("LowerBack", "Hips", (0.0, 0.0, 0.0)),
    ("Spine", "LowerBack", (0.0, 11.0, -1.5)),
    ("Spine1", "Spine", (0.0, 13.0, -0.5)),
    ("Neck", "Spine1", (0.0, 20.0, 0.0)),
    ("Neck1", "Neck", (0.0, 5.5, 1.0)),
    ("Head", "Neck1", (0.0, 5.5, 1.5)),
    ("LeftShoulder", "Spine1", (2.5, 15.5, 2.0)),
    ("LeftArm", "LeftShoulder", (15.5, 1.5, -2.0)),
    ("LeftForeArm", "LeftArm", (UPPER_ARM, 0.0, 0.0)),
    ("LeftHand", "LeftForeArm", (FOREARM, 0.0, 0.0)),
    ("LeftFingerBase", "LeftHand", (8.0, 0.0, 0.0)),
    ("LeftHandIndex1", "LeftFingerBase", (3.5, 0.0, 0.0)),
    ("LThumb", "LeftHand", (3.0, -1.0, 2.5)),
    ("RightShoulder", "Spine1", (-2.5, 15.5, 2.0)),
    ("RightArm", "RightShoulder", (-15.5, 1.5, -2.0)),
    ("RightForeArm", "RightArm", (-UPPER_ARM, 0.0, 0.0)),
    ("RightHand", "RightForeArm", (-FOREARM, 0.0, 0.0)),
    ("RightFingerBase", "RightHand", (-8.0, 0.0, 0.0)),
    ("RightHandIndex1", "RightFingerBase", (-3.5, 0.0, 0.0)),
    ("RThumb", "RightHand", (-3.0, -1.0, 2.5)),
)
_ENDS = {
    "LeftToeBase": (0.0, 0.0, 6.5),
    "RightToeBase": (0.0, 0.0, 6.5),
    "Head": (0.0, 19.0, 1.0),
    "LeftHandIndex1": (4.0, 0.0, 0.0),
    "LThumb": (3.0, -1.0, 3.0),
    "RightHandIndex1": (-4.0, 0.0, 0.0),
    "RThumb": (-3.0, -1.0, 3.0),
    "Club": (0.0, -92.0, 0.0),
}
# Ankle and ball of the foot above the ground on a flat foot, cm.
ANKLE_HEIGHT = 8.0
TOE_HEIGHT = 2.0
CLUB_LENGTH = 92.0
# Where the grip lies in the right hand's frame: in the palm, cm.
GRIP_IN_HAND = (-7.0, -2.5, 1.0)


def body_skeleton() -> Skeleton:
    """Return CMU's 31 joints, 96 channels."""
    return _skeleton(_BODY)


def golfer_skeleton() -> Skeleton:
    """Return the body without thumbs, with the club in the right hand: 30 joints, 93 channels."""
    rows = [row for row in _BODY if not row[0].endswith("Thumb")]
    return _skeleton((*rows, ("Club", "RightHand", GRIP_IN_HAND)))


def _skeleton(rows: tuple[tuple[str, str | None, tuple[float, float, float]], ...]) -> Skeleton:
    names = tuple(name for name, _, _ in rows)
    parents = np.array([-1 if parent is None else names.index(parent) for _, parent, _ in rows], dtype=np.intp)
    channels = tuple(_POSITIONS + _ROTATIONS if parent is None else _ROTATIONS for _, parent, _ in rows)
    ends = tuple(EndSite(j, np.array(_ENDS[name])) for j, name in enumerate(names) if name in _ENDS)
    return Skeleton(names, parents, np.array([offset for _, _, offset in rows]), channels, ends)


@dataclass(eq=False)
class Figure:
    """F poses in the making: world rotation (F, 4) and position (F, 3) of each joint set so far."""

    skeleton: Skeleton
    rotations: dict[str, FloatArray] = field(default_factory=dict)
    positions: dict[str, FloatArray] = field(default_factory=dict)

    def root(self, position: FloatArray, rotation: FloatArray) -> None:
        """Set the root."""
        name = self.skeleton.names[0]
        self.positions[name], self.rotations[name] = position, rotation

    def origin(self, name: str) -> FloatArray:
        """Return where a joint is, from its parent's pose, shape (F, 3)."""
        j = self.skeleton.names.index(name)
        parent = self.skeleton.names[self.skeleton.parents[j]]
        if parent not in self.rotations:
            self.turn_local(parent, rot.IDENTITY)
        return self.positions[parent] + rot.rotate(self.rotations[parent], self.skeleton.offsets[j])

    def turn(self, name: str, rotation: FloatArray) -> None:
        """Set a joint's world rotation; its parent must be set."""
        self.positions[name], self.rotations[name] = self.origin(name), rotation

    def turn_local(self, name: str, rotation: FloatArray) -> None:
        """Set a joint's rotation in its parent's frame."""
        position = self.origin(name)
        parent = self.skeleton.names[self.skeleton.parents[self.skeleton.names.index(name)]]
        self.positions[name], self.rotations[name] = position, rot.multiply(self.rotations[parent], rotation)

    def share(self, names: tuple[str, ...], rotation: FloatArray) -> None:
        """Turn a chain of joints by equal parts, so that the last has the world rotation given."""
        self.origin(names[0])
        parent = self.skeleton.names[self.skeleton.parents[self.skeleton.names.index(names[0])]]
        whole = rot.log(rot.multiply(rot.conjugate(self.rotations[parent]), rotation))
        part = rot.exp(whole / len(names))
        for name in names:
            self.turn_local(name, part)

    def leg(self, side: str, ankle: FloatArray, *, knee_to: FloatArray) -> None:
        """Set thigh and shin so that the ankle is at `ankle`; the knee points along `knee_to`."""
        hip = self.origin(f"{side}UpLeg")
        thigh, shin = self._length(f"{side}Leg"), self._length(f"{side}Foot")
        knee, down, pole = two_bones(hip, ankle, thigh, shin, knee_to)
        axis = unit(rot.cross(pole, down))
        self.turn(f"{side}UpLeg", frame_of(axis, unit(hip - knee)))
        self.turn(f"{side}Leg", frame_of(axis, unit(knee - ankle)))

    def arm(self, side: str, wrist: FloatArray, *, elbow_to: FloatArray) -> None:
        """Set upper arm and forearm so that the wrist is at `wrist`; the elbow points along `elbow_to`."""
        sign = 1.0 if side == "Left" else -1.0
        shoulder = self.origin(f"{side}Arm")
        upper, fore = self._length(f"{side}ForeArm"), self._length(f"{side}Hand")
        elbow, out, pole = two_bones(shoulder, wrist, upper, fore, elbow_to)
        axis = unit(rot.cross(pole, out))
        c, s = np.cos(np.radians(ELBOW_TILT)), np.sin(np.radians(ELBOW_TILT))
        for name, bone in (("Arm", unit(elbow - shoulder)), ("ForeArm", unit(wrist - elbow))):
            biceps = rot.cross(axis, bone)
            self.turn(f"{side}{name}", frame_of(sign * bone, s * biceps - sign * c * axis))

    def _length(self, name: str) -> float:
        return float(np.linalg.norm(self.skeleton.offsets[self.skeleton.names.index(name)]))

    def motion(self, frame_time: float) -> Motion:
        """Return the motion; joints that were not set have no rotation."""
        skeleton = self.skeleton
        count = len(self.positions[skeleton.names[0]])
        local = np.empty((count, len(skeleton), 4))
        for j, name in enumerate(skeleton.names):
            parent = skeleton.parents[j]
            if name not in self.rotations:
                self.turn(name, self.rotations[skeleton.names[parent]])
            world = self.rotations[name]
            local[:, j] = (
                world if parent < 0 else rot.multiply(rot.conjugate(self.rotations[skeleton.names[parent]]), world)
            )
        return Motion(skeleton, rot.normalize(local), self.positions[skeleton.names[0]][:, None], frame_time)


def two_bones(
    start: FloatArray, end: FloatArray, first: float, second: float, toward: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the middle joint (F, 3), the unit vector from start to end, and the one it is displaced along."""
    reach = np.linalg.norm(end - start, axis=-1, keepdims=True)
    along = (end - start) / reach
    reach = np.minimum(reach, (first + second) * (1.0 - 1e-7))
    pole = unit(toward - np.sum(toward * along, axis=-1, keepdims=True) * along)
    cosine = (first**2 + reach**2 - second**2) / (2.0 * first * reach)
    middle = start + first * (cosine * along + np.sqrt(1.0 - cosine**2) * pole)
    return middle, along, pole


def reach_at(first: float, second: float, bend: FloatArray | float) -> FloatArray:
    """Return the distance over two bones whose middle joint is bent by `bend` degrees."""
    distance: FloatArray = np.sqrt(first**2 + second**2 + 2.0 * first * second * np.cos(np.radians(bend)))
    return distance


def unit(v: FloatArray) -> FloatArray:
    """Return vectors of length one, shape (..., 3)."""
    scaled: FloatArray = v / np.linalg.norm(v, axis=-1, keepdims=True)
    return scaled


def axis_turn(axis: str, degrees: FloatArray) -> FloatArray:
    """Return the quaternions of turns about x, y or z by angles (F,) in degrees."""
    return rot.about_axis("xyz".index(axis), np.radians(degrees))


def frame_of(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the rotation whose x axis is `x` and whose y axis is `y`, orthogonal unit vectors (F, 3)."""
    return rot.from_matrix(np.stack((x, y, rot.cross(x, y)), axis=-1))
