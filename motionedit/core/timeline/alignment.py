"""Alignment of clips on the ground: one heading, one place ([PC] databases need it; edits undo it)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.ground import reference_axes
from motionedit.core.kinematics import forward_of
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.ground import Frame


@dataclass(frozen=True, eq=False)
class Alignment:
    """The rigid motion on the ground x_aligned = R (x - origin).

    Attributes
    ----------
    rotation : shape (4,)
        Quaternion of R, a turn about the up axis.
    origin : shape (3,), clip units
        Without a component along up.
    """

    rotation: FloatArray
    origin: FloatArray

    def __reduce__(self) -> tuple[Callable[..., Alignment], tuple[bytes, bytes]]:
        # One for each clip of a run goes to another process: bytes are packed in a third of an array's time.
        return _unpacked, (self.rotation.tobytes(), self.origin.tobytes())

    def apply(self, points: FloatArray) -> FloatArray:
        """Return world points in the aligned frame, shape (..., 3)."""
        return rot.rotate(self.rotation, points - self.origin)

    def undo(self, points: FloatArray) -> FloatArray:
        """Return aligned points in the world, shape (..., 3)."""
        return rot.unrotate(self.rotation, points) + self.origin


def _unpacked(rotation: bytes, origin: bytes) -> Alignment:
    return Alignment(np.frombuffer(rotation), np.frombuffer(origin))


NO_ALIGNMENT = Alignment(rot.IDENTITY, frozen(np.zeros(3)))


def align_to(frame: Frame, *, heading: bool, position: bool) -> Alignment:
    """Return the alignment that brings a heading frame to heading 0 and its origin to the file's."""
    return align_each([frame], heading=heading, position=position)[0]


def align_each(frames: Sequence[Frame], *, heading: bool, position: bool) -> list[Alignment]:
    """Return what `align_to` does of each of some frames: their arrays in few calls."""
    if not frames:
        return []
    rotations, origins = np.broadcast_to(rot.IDENTITY, (len(frames), 4)), np.zeros((len(frames), 3))
    axes = np.array([frame.axes for frame in frames])
    if heading:
        references = np.array([reference_axes(frame.up) for frame in frames])
        rotations = rot.from_matrix(references.swapaxes(1, 2) @ axes)
    if position:
        origins, ups = np.array([frame.origin for frame in frames]), axes[:, 1]
        origins = origins - np.sum(origins * ups, axis=-1, keepdims=True) * ups
    return [Alignment(*each) for each in zip(frozen(rotations), frozen(origins), strict=True)]


@dataclass(frozen=True, eq=False)
class TravelPath:
    """World transform of the joint that carries the travel: `positions` (F, 3), `rotations` (F, 4)."""

    positions: FloatArray
    rotations: FloatArray


def travel_path(motion: Motion, travel: int) -> TravelPath:
    """Return the world path of the joint that carries the travel."""
    positions, rotations = forward_of(motion, travel)
    return TravelPath(positions, rotations)


def with_travel_path(motion: Motion, travel: int, path: TravelPath) -> Motion:
    """Return the motion whose travel-carrying joint follows a world path; the joints above it stay as they are."""
    skeleton = motion.skeleton
    parent = int(skeleton.parents[travel])
    positions, rotations = path.positions, path.rotations
    if parent >= 0:
        p_parent, q_parent = forward_of(motion, parent)
        q_inverse = rot.conjugate(q_parent)
        positions = rot.rotate(q_inverse, positions - p_parent)
        rotations = rot.multiply(q_inverse, rotations)
    new_rotations = motion.rotations.copy()
    new_rotations[:, travel] = rotations
    new_translations = motion.translations.copy()
    new_translations[:, np.flatnonzero(skeleton.translated == travel)] = positions[:, None]
    return Motion(skeleton, frozen(new_rotations), frozen(new_translations), motion.frame_time)


def aligned(motion: Motion, alignment: Alignment, *, travel: int) -> Motion:
    """Return the motion moved into the aligned frame."""
    path = travel_path(motion, travel)
    moved = TravelPath(alignment.apply(path.positions), rot.multiply(alignment.rotation, path.rotations))
    return with_travel_path(motion, travel, moved)
