"""How much of something there is at every frame: all of it where it is wanted, eased in and out around."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import runs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray


def shares_of(wanted: BoolArray, ramp: int, changes: Sequence[int] = ()) -> FloatArray:
    """Return shares, shape (F,): 1 at wanted frames, eased in over `ramp` frames before and out after them.

    Of the `changes`, frames, none is passed: where one is less than a ramp before a wanted frame, the ramp begins there
    and reaches into the wanted frames; likewise after them. Shares have two continuous derivatives.
    """
    share = np.zeros(len(wanted))
    f = np.arange(len(wanted))
    for first, last in runs(wanted):
        rise = max([first - ramp, *(c for c in changes if first - ramp < c <= first)])
        fall = min([last + ramp, *(c for c in changes if last < c < last + ramp)])
        t = np.clip(np.minimum(f - rise, fall - f) / ramp, 0.0, 1.0)
        share = np.maximum(share, t * t * t * (10.0 - 15.0 * t + 6.0 * t * t))
    return share
