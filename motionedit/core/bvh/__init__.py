"""BVH files: reading, writing, and the adapter to `bvhio`; the only place where clips are read or written."""

from motionedit.core.bvh.read import BvhText, Clip, parse_clip, read_clip
from motionedit.core.bvh.write import edited_bytes, new_bytes, resampled_bytes, unedited_bytes
from motionedit.core.euler import joint_angles

__all__ = [
    "BvhText",
    "Clip",
    "edited_bytes",
    "joint_angles",
    "new_bytes",
    "parse_clip",
    "read_clip",
    "resampled_bytes",
    "unedited_bytes",
]
