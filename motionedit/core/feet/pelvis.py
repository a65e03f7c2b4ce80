"""The pelvis lowered, smoothly, where a leg would have to be longer than it is; and how far that is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Seconds before and after for which the pelvis stays low, and eases down and up.
EASE = 0.2
# The pelvis goes down no farther than this share of a leg.
_DEEPEST = 0.15
# Of a length squared: by so little a leg that is as long as it was may seem too short, and no pelvis comes down.
_ROUNDING = 1e-12


def drop_needed(hip: FloatArray, ankle: FloatArray, reach: FloatArray, up: FloatArray) -> FloatArray:
    """Return how far a hip must come down to be within reach of an ankle, shape (F,); 0 where it is.

    The smaller root of |hip - x up - ankle| = reach; where none is, its farthest, which is nearest.
    """
    way = hip - ankle
    height = way @ up
    level = np.maximum(np.sum(way**2, axis=1) - height**2, 0.0)
    under = np.sqrt(np.maximum(reach**2 - level, 0.0))
    needed: FloatArray = np.clip(height - under, 0.0, _DEEPEST * reach)
    return np.where(np.sum(way**2, axis=1) <= (1.0 + _ROUNDING) * reach**2, 0.0, needed)


def smooth_cover(needed: FloatArray, frame_time: float, *, ease: float = EASE) -> FloatArray:
    """Return a smooth curve that is nowhere below what is needed, shape (F,).

    The largest within `ease` seconds on both sides, averaged over as long by a quadratic B-spline.
    """
    if not needed.any():
        return needed
    third = max(1, round(ease / (3.0 * frame_time)))
    half = 3 * third
    padded = np.pad(needed, 2 * half, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    cover: FloatArray = windows.max(axis=1)
    box = np.full(2 * third + 1, 1.0 / (2 * third + 1))
    for _ in range(3):
        cover = np.convolve(cover, box, mode="valid")
    return cover
