"""Resampling a motion at parts of frames: slerp for joints, linear for translations ([PC] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray


def resample(motion: Motion, at: FloatArray, *, frame_time: float) -> Motion:
    """Return the motion sampled at frames `at` of its own, shape (N,), inside the clip.

    At a whole frame the sample is that frame.
    """
    last = len(motion) - 1
    i = np.clip(np.floor(at).astype(np.intp), 0, max(last - 1, 0))
    j = np.minimum(i + 1, last)
    t = at - i
    rotations = rot.slerp_frames(motion.rotations, i, t)
    a, b = motion.translations[i], motion.translations[j]
    translations = a + t[:, None, None] * (b - a)
    return Motion(motion.skeleton, frozen(rotations), frozen(translations), frame_time)
