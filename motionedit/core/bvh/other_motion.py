"""Another motion in a clip's text: only what differs from the file's own numbers is written anew."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.bvh.splice import edited_bytes
from motionedit.core.bvh.write import resampled_bytes
from motionedit.core.motion import Motion
from motionedit.core.skeleton import same_skeleton
from motionedit.errors import ClipError

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.bvh.text import Written


def bytes_with_motion(clip: Written, motion: Motion, *, own: Motion) -> bytes:
    """Return the clip's bytes with another motion, the very bytes where it is its `own`.

    With as many frames as the file has, the values that differ are replaced in its text, and the frame time where it
    differs; with more or fewer, all rows are written anew.

    Raises
    ------
    ClipError
        The motion has another skeleton, or arrays of other shapes; or a joint turns or moves that has no channels for
        it.
    BvhError
        A value is not finite.
    """
    motion = _checked(clip, motion, own)
    if len(motion) != len(own):
        return resampled_bytes(clip, motion)
    turned = _differ(motion.rotations, own.rotations) & _differ(motion.rotations, -own.rotations)
    moved = _differ(motion.translations, own.translations)
    _refuse_without_channels(clip, motion, own, turned=turned)
    return edited_bytes(clip, motion, touched=turned, moved=moved)


def _checked(clip: Written, motion: Motion, own: Motion) -> Motion:
    """Return the motion in double precision, refused where it is not one of the clip's skeleton."""
    if not same_skeleton(motion.skeleton, own.skeleton):
        message = "its motion has another skeleton than its file; joints, channels and offsets stay as they are"
        raise ClipError(message, file=clip.label)
    if not (math.isfinite(motion.frame_time) and motion.frame_time > 0.0):
        raise ClipError(f"its motion's frame_time must be more than 0 s, not {motion.frame_time}", file=clip.label)
    rotations = np.asarray(motion.rotations, dtype=np.float64)
    translations = np.asarray(motion.translations, dtype=np.float64)
    frames = max(len(rotations), 1)
    pairs = (("rotations", rotations, own.rotations), ("translations", translations, own.translations))
    for name, array, wanted in pairs:
        shape = (frames, *wanted.shape[1:])
        if array.shape != shape:
            raise ClipError(f"its motion's {name} must have shape {shape}, not {array.shape}", file=clip.label)
    return Motion(own.skeleton, rotations, translations, float(motion.frame_time))


def _differ(one: FloatArray, other: FloatArray) -> BoolArray:
    """Return where rotations or translations differ, shape (F, J) or (F, P)."""
    differ: BoolArray = (one != other).any(axis=-1)
    return differ


def _refuse_without_channels(clip: Written, motion: Motion, own: Motion, *, turned: BoolArray) -> None:
    skeleton = own.skeleton
    for joint in np.flatnonzero(turned.any(axis=0)).tolist():
        if not skeleton.rotation_axes[joint]:
            message = f"its motion turns '{skeleton.names[joint]}', which has no rotation channels in the file"
            raise ClipError(message, file=clip.label)
    for p, joint in enumerate(skeleton.translated.tolist()):
        fixed = [axis for axis in range(3) if axis not in skeleton.position_axes[joint]]
        if (motion.translations[:, p, fixed] != own.translations[:, p, fixed]).any():
            message = f"its motion moves '{skeleton.names[joint]}' along an axis without a position channel in the file"
            raise ClipError(message, file=clip.label)
