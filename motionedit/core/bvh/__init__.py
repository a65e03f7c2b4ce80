"""BVH files: reading, writing, and the adapter to `bvhio`; the only place where clips are read or written."""

from motionedit.core.bvh.adapter import VerifyResult, check_with_bvhio, from_bvhio, to_bvhio
from motionedit.core.bvh.read import Clip, parse_clip, read_clip
from motionedit.core.bvh.splice import edited_bytes, edited_pieces
from motionedit.core.bvh.text import BvhText
from motionedit.core.bvh.write import new_bytes, other_rows_pieces, resampled_bytes, unedited_bytes
from motionedit.core.euler import joint_angles

__all__ = [
    "BvhText",
    "Clip",
    "VerifyResult",
    "check_with_bvhio",
    "edited_bytes",
    "edited_pieces",
    "from_bvhio",
    "joint_angles",
    "new_bytes",
    "other_rows_pieces",
    "parse_clip",
    "read_clip",
    "resampled_bytes",
    "to_bvhio",
    "unedited_bytes",
]
