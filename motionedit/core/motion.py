"""A motion: joint rotations and translations over frames, and its way from and to BVH channel values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.skeleton import Skeleton


_BLOCK_VALUES = 1 << 14


@dataclass(frozen=True, eq=False)
class Motion:
    """F frames of a skeleton's local transforms.

    Attributes
    ----------
    rotations : shape (F, J, 4)
        Local unit quaternions.
    translations : shape (F, P, 3), clip units
        Local translations of the joints `skeleton.translated`; the others stand at their OFFSET.
    frame_time : float
        Seconds from frame to frame, as in the file.
    """

    skeleton: Skeleton
    rotations: FloatArray
    translations: FloatArray
    frame_time: float

    def __len__(self) -> int:
        return len(self.rotations)

    @property
    def frame_rate(self) -> float:
        """Frames per second."""
        return 1.0 / self.frame_time

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (len(self) - 1) * self.frame_time


def motion_from_channels(skeleton: Skeleton, values: FloatArray, *, frame_time: float) -> Motion:
    """Return the motion of channel values.

    Parameters
    ----------
    values : shape (F, C)
        Rows of the file: degrees and clip units. A position channel replaces that axis of OFFSET.
    """
    rotations = np.empty((len(values), len(skeleton), 4))
    groups = _joints_by_axes(skeleton)
    if sum(map(len, groups.values())) < len(skeleton):
        rotations[:] = rot.IDENTITY
    for axes, joints in groups.items():
        columns = np.array(rotation_columns(skeleton, joints)).T
        # Blocks of frames stay in the processor's cache and keep the memory of a long clip down.
        step = max(_BLOCK_VALUES // columns.size, 1)
        for start in range(0, len(values), step):
            # Angle by angle, so that each is contiguous.
            angles = np.radians(values[start : start + step, columns].swapaxes(0, 1), order="C")
            rotations[start : start + step, joints] = rot.from_euler(np.moveaxis(angles, 0, -1), axes)
    translations = np.repeat(skeleton.offsets[None, skeleton.translated], len(values), axis=0)
    for p, joint in enumerate(skeleton.translated):
        for axis, column in position_columns(skeleton, int(joint)):
            translations[:, p, axis] = values[:, column]
    return Motion(skeleton, frozen(rotations), frozen(translations), frame_time)


def rotation_columns(skeleton: Skeleton, joints: list[int]) -> list[list[int]]:
    """Return the columns of the rotation channels of joints that have the same number of them, in channel order."""
    return [
        [
            int(skeleton.channel_starts[j]) + c
            for c, name in enumerate(skeleton.channels[j])
            if name.endswith("rotation")
        ]
        for j in joints
    ]


def position_columns(skeleton: Skeleton, joint: int) -> list[tuple[int, int]]:
    """Return (axis, column) of each position channel of a joint."""
    start = int(skeleton.channel_starts[joint])
    return [
        ("XYZ".index(name[0]), start + c)
        for c, name in enumerate(skeleton.channels[joint])
        if name.endswith("position")
    ]


def _joints_by_axes(skeleton: Skeleton) -> dict[tuple[int, ...], list[int]]:
    groups: dict[tuple[int, ...], list[int]] = {}
    for j, axes in enumerate(skeleton.rotation_axes):
        if axes:
            groups.setdefault(axes, []).append(j)
    return groups
