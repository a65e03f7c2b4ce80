"""Telling whether two clips, or two folders of clips, hold the same motion, whatever their text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.kinematics import forward
from motionedit.core.skeleton_match import match_joints
from motionedit.dataclass import dataclass
from motionedit.errors import (
    EXIT_DONE,
    EXIT_OUT_OF_TOLERANCE,
    EXIT_USAGE,
    ClipError,
    MotionEditError,
    UsageError,
)
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.outputs import refuse_clashes
from motionedit.jobs.batch.plan import find_clips, folder_clips, refuse_missing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask

Status = Literal["same", "different", "missing", "not_comparable"]

# The default position tolerance, in heights of the skeleton: below any noise of a capture, above that of text.
POSITION_TOLERANCE = 1e-5
ANGLE_TOLERANCE = 0.01
# Frame times are written with few digits: 0.00833 and 1/120 are one rate, 0.0333 and 1/30 too; 29.97 and 30 Hz are two.
_RATE_TOLERANCE = 5e-4
_ROUNDED_RATE_TOLERANCE = 2e-3  # where one is the other, rounded to fewer decimals


@dataclass(frozen=True)
class Worst:
    """The largest difference of a kind: `value`, where it is, and the tolerance it is held against."""

    value: float
    frame: int
    joint: str
    tolerance: float

    @property
    def exceeds(self) -> bool:
        """Whether it is a difference at all."""
        return self.value > self.tolerance

    def record(self) -> dict[str, Any]:
        """Return the entry of the report."""
        return {"value": self.value, "frame": self.frame, "joint": self.joint, "tolerance": self.tolerance}


@dataclass(frozen=True)
class Comparison:
    """What came of one pair of clips.

    Attributes
    ----------
    name : str
        The clip's path below the two folders, or B's.
    message : str
        One line that says what differs, or why they cannot be compared; empty where they are the same.
    position : Worst or None
        Joint world positions, clip units; None where nothing was compared.
    angle : Worst or None
        Geodesic angle of the joints' local rotations, degrees.
    """

    name: str
    status: Status
    message: str = ""
    position: Worst | None = None
    angle: Worst | None = None

    def record(self) -> dict[str, Any]:
        """Return the entry of the report."""
        return {
            "clip": self.name,
            "status": self.status,
            "message": self.message or None,
            "position": self.position and self.position.record(),
            "angle": self.angle and self.angle.record(),
        }


def run(
    a: Path,
    b: Path,
    *,
    tolerance_position: float | None = None,
    tolerance_angle: float = ANGLE_TOLERANCE,
    lenient: bool = False,
    report: Path | None = None,
) -> list[Comparison]:
    """Compare two clips, or the clips of two folders that have the same path below them.

    Parameters
    ----------
    tolerance_position : float or None
        Clip units; None is 1e-5 of the height of A's skeleton.
    tolerance_angle : float
        Degrees.
    report : Path or None
        A file that will be written, and may not be one of the clips.

    Raises
    ------
    UsageError
        Something given does not exist, one is a folder and the other is not, or both folders hold no clip.
    """
    pairs = _pairs(a, b)
    refuse_clashes([("the report", report)], [task.source for _, *two in pairs for task in two if task])
    comparisons = []
    for name, first, second in pairs:
        if first is None or second is None:
            comparisons.append(Comparison(name, "missing", f"only in {a if second is None else b}"))
            continue
        try:
            clips = read_task(first, lenient=lenient), read_task(second, lenient=lenient)
            position, angle = compare(*clips, tolerance_position=tolerance_position, tolerance_angle=tolerance_angle)
        except MotionEditError as error:
            comparisons.append(Comparison(name, "not_comparable", str(error)))
            continue
        message = _difference(position, angle)
        comparisons.append(Comparison(name, "different" if message else "same", message, position, angle))
    return comparisons


def share_no_name(comparisons: Sequence[Comparison]) -> bool:
    """Tell whether two folders have clips, and no clip of one has its pair in the other."""
    return {one.status for one in comparisons} == {"missing"} and len({one.message for one in comparisons}) > 1


def exit_code(comparisons: list[Comparison]) -> int:
    """Return 2 where a pair cannot be compared, else 3 where one differs or is missing, else 0."""
    statuses = {comparison.status for comparison in comparisons}
    if "not_comparable" in statuses:
        return EXIT_USAGE
    return EXIT_DONE if statuses <= {"same"} else EXIT_OUT_OF_TOLERANCE


def compare(
    a: Clip, b: Clip, *, tolerance_position: float | None = None, tolerance_angle: float = ANGLE_TOLERANCE
) -> tuple[Worst, Worst]:
    """Return the largest differences of joint world positions (clip units) and of joint angles (degrees).

    Joints are matched by name.

    Raises
    ------
    ClipError
        Another skeleton, frame count or frame rate: what differs, with B's name.
    """
    height = anatomy_of(a.motion).height
    joint_map = match_joints(a.motion.skeleton, b.motion.skeleton, height=height, label=b.label, against=a.label)
    if len(a.motion) != len(b.motion):
        raise ClipError(f"{len(b.motion)} frames, {a.label} has {len(a.motion)}", file=b.label)
    if not _same_rate(a, b):
        message = f"{b.motion.frame_rate:.6g} frames per second, {a.label} has {a.motion.frame_rate:.6g}"
        raise ClipError(message, file=b.label)
    names = a.motion.skeleton.names
    apart = forward(a.motion).positions - forward(b.motion).positions[:, joint_map]
    angles = np.degrees(rot.angle_between(a.motion.rotations, b.motion.rotations[:, joint_map]))
    tolerance = POSITION_TOLERANCE * height if tolerance_position is None else tolerance_position
    return (
        _worst(np.linalg.norm(apart, axis=-1), names, tolerance),
        _worst(angles, names, tolerance_angle),
    )


def _same_rate(a: Clip, b: Clip) -> bool:
    apart = abs(b.motion.frame_time / a.motion.frame_time - 1.0)
    if apart <= _RATE_TOLERANCE:
        return True
    places = min(clip.text.frame_time_decimals for clip in (a, b))
    rounded = round(a.motion.frame_time, places) == round(b.motion.frame_time, places)
    return rounded and apart <= _ROUNDED_RATE_TOLERANCE


def _worst(differences: FloatArray, names: tuple[str, ...], tolerance: float) -> Worst:
    if not differences.size:
        return Worst(0.0, 0, names[0], tolerance)
    frame, joint = np.unravel_index(int(np.argmax(differences)), differences.shape)
    return Worst(float(differences[frame, joint]), int(frame), names[joint], tolerance)


def _difference(position: Worst, angle: Worst) -> str:
    parts = []
    if position.exceeds:
        parts.append(f"{position.value:.4g} apart at {_place(position)}")
    if angle.exceeds:
        parts.append(f"turned by {angle.value:.4g} degrees at {_place(angle)}")
    return "; ".join(parts)


def _place(worst: Worst) -> str:
    return f"frame {worst.frame}, joint {worst.joint} (tolerance {worst.tolerance:.4g})"


def _pairs(a: Path, b: Path) -> list[tuple[str, ClipTask | None, ClipTask | None]]:
    refuse_missing([a, b])
    if not (a.is_dir() and b.is_dir()):
        first, second = _one_clip(a), _one_clip(b)
        if first.source is None and second.source is None:
            raise UsageError("standard input ('-') can be only one of A and B")
        return [(second.label if second.source else first.label, first, second)]
    left = {task.relative: task for task in folder_clips(a)}
    right = {task.relative: task for task in folder_clips(b)}
    if not left and not right:
        raise UsageError(f"no .bvh file in {a} and {b}")
    return [(name, left.get(name), right.get(name)) for name in sorted(left.keys() | right.keys())]


def _one_clip(path: Path) -> ClipTask:
    if path.is_dir():
        raise UsageError("is a folder, and the other is a file: give two of a kind", file=str(path))
    return find_clips([path])[0]
