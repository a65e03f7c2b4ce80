"""Finding an event in a clip: where a point of the body is lowest, fastest or nearest, to a part of a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

Quantity = Literal["height", "speed", "distance"]
Extreme = Literal["minimum", "maximum"]


@dataclass(frozen=True)
class Search:
    """What to look for, and between which frames, both in."""

    extreme: Extreme
    quantity: Quantity
    start: int
    stop: int


def find_event(
    path: FloatArray, search: Search, *, up: FloatArray, frame_time: float, to: FloatArray | None = None
) -> float:
    """Return the frame of the extreme, refined by the parabola through three samples.

    Parameters
    ----------
    path : shape (F, 3), clip units
        World positions of the effector over the whole clip.
    up : shape (3,)
        Signed unit axis, for heights.
    to : shape (3,), clip units
        The point distances are measured to.
    """
    values = _signal(path, search.quantity, up=up, frame_time=frame_time, to=to)
    if search.extreme == "maximum":
        values = -values
    k = search.start + int(values[search.start : search.stop + 1].argmin())
    if not 0 < k < len(values) - 1:
        return float(k)
    before, here, after = values[k - 1 : k + 2].tolist()
    bend = before - 2.0 * here + after
    if bend <= 0.0:
        return float(k)
    offset = 0.5 * (before - after) / bend
    return float(k + min(max(offset, -0.5), 0.5))


def _signal(
    path: FloatArray, quantity: Quantity, *, up: FloatArray, frame_time: float, to: FloatArray | None
) -> FloatArray:
    signal: FloatArray
    if quantity == "height":
        signal = path @ up
    elif quantity == "speed":
        signal = np.linalg.norm(np.gradient(path, frame_time, axis=0), axis=-1)
    else:
        signal = np.linalg.norm(path - (0.0 if to is None else to), axis=-1)
    return signal
