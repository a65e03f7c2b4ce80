"""Smooth shares, and smooth ends: a step from 0 to 1, and values that come to no more than so much."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

_LEAST = 1e-12


def smooth_step(t: FloatArray) -> FloatArray:
    """Return what goes from 0 to 1 as `t` does, level at both."""
    share: FloatArray = t * t * (3.0 - 2.0 * t)
    return share


def smooth_share(values: FloatArray | float, start: float, stop: float) -> FloatArray:
    """Return a share that goes smoothly from 0 to 1 as values go from `start` to `stop`, and stays there beyond."""
    return smooth_step(np.clip((values - start) / (stop - start), 0.0, 1.0))


def no_more_than(most: FloatArray | float, *values: FloatArray) -> list[FloatArray]:
    """Return values that come to no more than so much together, smoothly: x m / (|x|^4 + m^4)^(1/4)."""
    square = np.square(np.maximum(most, _LEAST))
    less = (1.0 + (sum(value**2 for value in values) / square) ** 2) ** -0.25
    return [less * value for value in values]
