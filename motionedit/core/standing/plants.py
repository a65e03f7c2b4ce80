"""When feet stand, and the pelvis lowered smoothly where a leg would be stretched."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray


def lowered(need: FloatArray, frame_time: float) -> FloatArray:
    """Return a smooth curve over a need that has corners, shape (F,): dilated by 0.12 s, then low-passed."""
    from motionedit.core.timeline.interpolation import low_pass

    if not need.any():
        return need
    width = round(0.12 / frame_time)
    padded = np.pad(need, width, mode="edge")
    wide = np.lib.stride_tricks.sliding_window_view(padded, 2 * width + 1).max(axis=1)
    return np.maximum(low_pass(wide[:, None], sigma=0.08 / frame_time)[:, 0], 0.0)


def planted_frames(intervals: Sequence[tuple[int, int]], frames: int) -> BoolArray:
    """Return which frames lie in one of the intervals, both ends in, shape (frames,)."""
    planted = np.zeros(frames, dtype=np.bool_)
    for start, stop in intervals:
        planted[start : stop + 1] = True
    return planted
