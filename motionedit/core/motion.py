"""A motion: joint rotations and translations over frames, and its way from and to BVH channel values."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.skeleton import Skeleton


_BLOCK_VALUES = 1 << 14
_HALF_DEGREE = np.pi / 180.0 / 2.0


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

    def __repr__(self) -> str:
        # Not its arrays, which would fill a screen.
        return f"<Motion: {len(self)} frames, {len(self.skeleton)} joints, {self.frame_rate:.4g} Hz>"

    def at(self, frames: slice | IntArray | BoolArray | Sequence[int]) -> Motion:
        """Return the motion at some of its frames; of a slice its arrays are views."""
        return Motion(self.skeleton, self.rotations[frames], self.translations[frames], self.frame_time)

    def copied(self) -> Motion:
        """Return the motion with arrays of its own, which can be changed in place."""
        return Motion(self.skeleton, self.rotations.copy(), self.translations.copy(), self.frame_time)

    @property
    def is_fixed(self) -> bool:
        """Whether no array of it can have been changed in place: copies and pickles of arrays can be."""
        return not (self.rotations.flags.writeable or self.translations.flags.writeable)

    @property
    def frame_rate(self) -> float:
        """Frames per second."""
        return 1.0 / self.frame_time

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (len(self) - 1) * self.frame_time


def scaled(motion: Motion, factor: float) -> Motion:
    """Return the motion with every length times `factor`: offsets, end sites, translations; rotations are shared."""
    sized = _scaled_skeleton(motion.skeleton, factor)
    return Motion(sized, motion.rotations, frozen(motion.translations * factor), motion.frame_time)


@lru_cache(maxsize=8)
def _scaled_skeleton(skeleton: Skeleton, factor: float) -> Skeleton:
    """Return a skeleton with every length times a factor: the same one for the clips of a batch that share theirs."""
    sites = tuple(replace(site, offset=frozen(site.offset * factor)) for site in skeleton.end_sites)
    return replace(skeleton, offsets=frozen(skeleton.offsets * factor), end_sites=sites)


def write_poses(skeleton: Skeleton, values: FloatArray, *, rotations: FloatArray, translations: FloatArray) -> None:
    """Write the poses of channel values (F, C) into the arrays of a motion, (F, J, 4) and (F, P, 3)."""
    groups = skeleton.rotation_groups
    if sum(len(group.joints) for group in groups) < len(skeleton):
        rotations[:] = rot.IDENTITY
    for group in groups:
        # Blocks of frames stay in the processor's cache and keep the memory of a long clip down.
        step = max(_BLOCK_VALUES // group.columns.size, 1)
        joints, columns = group.in_a_row
        for start in range(0, len(values), step):
            angles = values[start : start + step, columns]
            block = rotations[start : start + step, joints]
            if len(set(group.axes)) == 3:
                # Half of each in radians, as `np.radians` has it.
                half = np.multiply(angles, _HALF_DEGREE, order="C").reshape(-1, *group.columns.shape)
                in_place = block.flags.c_contiguous and isinstance(joints, slice)
                turned = rot.from_half_angles(half, group.axes, out=block if in_place else None)
                if in_place:
                    continue
            else:
                turned = rot.from_euler(np.radians(angles.reshape(-1, *group.columns.shape)), group.axes)
            rotations[start : start + step, joints] = turned
    translations[:] = skeleton.offsets[skeleton.translated]
    for p, joint in enumerate(skeleton.translated.tolist()):
        for axis, column in position_columns(skeleton, joint):
            translations[:, p, axis] = values[:, column]


def position_columns(skeleton: Skeleton, joint: int) -> list[tuple[int, int]]:
    """Return (axis, column) of each position channel of a joint."""
    return list(zip(skeleton.position_axes[joint], skeleton.columns(joint, "position"), strict=True))
