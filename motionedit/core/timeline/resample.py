"""Resampling a motion at parts of frames: slerp for joints, linear for translations ([PC] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion
from motionedit.core.slerp import slerp_frames

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray


def resample(motion: Motion, at: FloatArray, *, frame_time: float) -> Motion:
    """Return the motion sampled at frames `at` of its own, shape (N,), inside the clip.

    At a whole frame the sample is that frame.
    """
    i, t = frames_before(motion, at)
    j = np.minimum(i + 1, len(motion) - 1)
    rotations = slerp_frames(motion.rotations, i, t)
    a, b = motion.translations[i], motion.translations[j]
    translations = a + t[:, None, None] * (b - a)
    return Motion(motion.skeleton, frozen(rotations), frozen(translations), frame_time)


def frames_before(motion: Motion, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the frames at or before `at` (N,), the last one never, and the parts of a frame from there."""
    frames = np.minimum(np.maximum(np.floor(at).astype(np.intp), 0), max(len(motion) - 2, 0))
    return frames, at - frames
