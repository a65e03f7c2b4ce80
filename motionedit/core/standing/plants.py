"""Where feet are wanted at every frame: as the plants of a reference say, and eased between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray

# Seconds: what a correction's third difference is weighed by; between plants it fades over about twice as much.
_SMOOTH = 0.05
_FADE = 0.01
# Seconds on each side of a gap in which a correction has not yet died away; the rest of a longer gap has none.
_REACH = 0.6


def eased(wanted: FloatArray, known: BoolArray, frame_time: float) -> FloatArray:
    """Return corrections for all frames, shape (F, k): as wanted where they are known, smooth and small between.

    In each gap they minimise (tau / dt)^6 |third difference|^2 + 0.01 |c|^2.

    Parameters
    ----------
    wanted : shape (F, k)
    known : shape (F,)
        Where they are.
    """
    c = np.where(known[:, None], wanted, 0.0)
    if not known.any():
        return c
    reach = max(round(_REACH / frame_time), 3)
    for start, stop in _gaps(known, reach):
        _fill(c, start, stop, frame_time)
    return c


def _gaps(known: BoolArray, reach: int) -> list[tuple[int, int]]:
    """Return (first, last) of the gaps between known frames; long ones in two, each with the end that is near."""
    edges = np.flatnonzero(np.diff(np.concatenate(([1], known.astype(np.int8), [1]))))
    gaps = []
    for start, stop in zip(edges[::2], edges[1::2] - 1, strict=True):
        if stop - start + 1 <= 2 * reach:
            gaps.append((int(start), int(stop)))
            continue
        gaps += [(int(start), int(start) + reach - 1)] if start > 0 else []
        gaps += [(int(stop) - reach + 1, int(stop))] if stop < len(known) - 1 else []
    return gaps


def _fill(c: FloatArray, start: int, stop: int, frame_time: float) -> None:
    """Fill rows start to stop, both in, from the three rows on each side of them."""
    low, high = max(start - 3, 0), min(stop + 3, len(c) - 1)
    count, inside = high - low + 1, slice(start - low, stop - low + 1)
    A = np.diff(np.eye(count), n=3, axis=0) if count > 3 else np.zeros((0, count))
    stiffness = (_SMOOTH / frame_time) ** 6 * (A.T @ A) + _FADE * np.eye(count)
    rest = c[low : high + 1].copy()
    rest[inside] = 0.0
    c[start : stop + 1] = np.linalg.solve(stiffness[inside, inside], -(stiffness[inside] @ rest))


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
