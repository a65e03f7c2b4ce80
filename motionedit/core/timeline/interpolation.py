"""Curves: a monotone cubic, a natural cubic spline on a uniform grid, and a Gaussian low-pass.

scipy has both splines, but takes longer to import than a whole edit lasts; the tests hold ours against it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.compiled import compiled

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# A Gaussian is cut at this many standard deviations.
KERNEL_RADIUS = 3.0
# Frames: a narrower one weighs the frames beside the middle by less than a number's last digit, or by nothing at all.
NARROWEST = 0.1


def monotone_cubic(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """Return the monotone cubic through the points (x, y), clamped outside, shape of `at`.

    Fritsch-Carlson slopes in the weighted harmonic form (PCHIP): an increasing y stays increasing between its
    points, and the curve's slope is continuous.

    Parameters
    ----------
    x, y : shape (K,), K >= 2, x strictly increasing
    """
    h = np.diff(x)
    secant = np.diff(y) / h
    slope = np.empty_like(y)
    if len(x) == 2:
        slope[:] = secant[0]
    else:
        left, right = secant[:-1], secant[1:]
        w1, w2 = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
        flat = left * right <= 0.0
        safe_left, safe_right = np.where(flat, 1.0, left), np.where(flat, 1.0, right)
        slope[1:-1] = np.where(flat, 0.0, (w1 + w2) / (w1 / safe_left + w2 / safe_right))
        slope[0] = _end_slope(h[0], h[1], secant[0], secant[1])
        slope[-1] = _end_slope(h[-1], h[-2], secant[-1], secant[-2])
    at = np.clip(at, x[0], x[-1])
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    t = (at - x[i]) / h[i]
    u = 1.0 - t
    curve: FloatArray = (
        (1.0 + 2.0 * t) * u * u * y[i]
        + t * u * u * h[i] * slope[i]
        + t * t * (3.0 - 2.0 * t) * y[i + 1]
        - t * t * u * h[i] * slope[i + 1]
    )
    return curve


def _end_slope(h0: float, h1: float, d0: float, d1: float) -> float:
    """Return the one-sided three-point slope, limited so that the end keeps its shape."""
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if slope * d0 <= 0.0:
        return 0.0
    if d0 * d1 < 0.0 and abs(slope) > 3.0 * abs(d0):
        return 3.0 * d0
    return slope


def natural_spline(rows: FloatArray, at: FloatArray) -> FloatArray:
    """Return the natural cubic spline through rows at 0, 1, ..., F - 1, shape (len(at), ...).

    Parameters
    ----------
    rows : shape (F, ...)
    at : shape (N,)
        Places on the grid; those outside are clamped, never extrapolated.
    """
    last = len(rows) - 1
    at = np.clip(at, 0.0, last)
    if last == 0:
        return np.repeat(rows, len(at), axis=0)
    i = np.minimum(at.astype(np.intp), last - 1)
    t = (at - i).reshape(-1, *(1,) * (rows.ndim - 1))
    u = 1.0 - t
    M = _second_derivatives(rows)
    spline: FloatArray = u * rows[i] + t * rows[i + 1] + ((u**3 - u) * M[i] + (t**3 - t) * M[i + 1]) / 6.0
    return spline


# Frames, and more than enough: a row so far away weighs (2 - sqrt 3)^30 = 7e-18 of one beside a place.
_REACH = 30


def spline_weights(frames: int, at: float, *, sigma: float) -> tuple[int, FloatArray]:
    """Return the weights of rows in the natural spline through them, low-passed, at one place, and the first's frame.

    ``weights @ rows[first : first + len(weights)]`` is ``natural_spline(low_pass(rows, sigma=sigma), [at])[0]``, to
    rounding, for rows of so many frames: what is farther away weighs nothing.
    """
    middle, reach = int(min(max(at, 0.0), frames - 1)), _REACH + len(gaussian(sigma, frames))
    first, stop = max(middle - reach, 0), min(middle + reach + 2, frames)
    return first, natural_spline(_low_passed_ones(stop - first, sigma), np.array([at - first]))[0]


@lru_cache(maxsize=16)
def _low_passed_ones(frames: int, sigma: float) -> FloatArray:
    """Return what becomes of a one in each row: each row's weights of all, shape (frames, frames)."""
    return frozen(low_pass(np.eye(frames), sigma=sigma))


def _second_derivatives(rows: FloatArray) -> FloatArray:
    """Solve M[i-1] + 4 M[i] + M[i+1] = 6 (second difference), M = 0 at both ends, by elimination."""
    M = np.zeros(rows.shape)
    if len(rows) > 2:
        inner = M[1:-1].reshape(len(rows) - 2, -1)
        inner[:] = (6.0 * (rows[2:] - 2.0 * rows[1:-1] + rows[:-2])).reshape(inner.shape)
        kernel = compiled()
        if kernel is not None:
            kernel.second_derivatives(inner, *inner.shape)
            return M
        pivots = [4.0]
        for i in range(1, len(inner)):
            inner[i] -= inner[i - 1] / pivots[-1]
            pivots.append(4.0 - 1.0 / pivots[-1])
        inner[-1] /= pivots[-1]
        for i in range(len(inner) - 2, -1, -1):
            inner[i] -= inner[i + 1]
            inner[i] /= pivots[i]
    return M


@lru_cache(maxsize=16)
def gaussian(sigma: float, frames: int) -> FloatArray:
    """Return the right half of a normalized Gaussian over frames, shape (radius + 1,), the middle first.

    `sigma` is in frames; the radius leaves a reflection of `frames` rows something to reflect.
    """
    radius = max(min(int(np.ceil(KERNEL_RADIUS * sigma)), frames - 1), 0) if sigma > NARROWEST else 0
    if radius < 1:
        return frozen(np.ones(1))
    weights = np.exp(-0.5 * (np.arange(radius + 1) / sigma) ** 2)
    taps: FloatArray = weights / (weights[0] + 2.0 * weights[1:].sum())
    return frozen(taps)


def _line_at_end(taps: FloatArray) -> FloatArray:
    """Return the weights of rows, the end first, that give the end of the line through them, least squares by taps."""
    k = np.arange(len(taps))
    sums = [float(taps @ k**power) for power in range(3)]
    weights: FloatArray = taps * (sums[2] - sums[1] * k) / (sums[0] * sums[2] - sums[1] ** 2)
    return weights


def low_pass(rows: FloatArray, *, sigma: float) -> FloatArray:
    """Return rows smoothed over frames by a zero-phase Gaussian, shape (F, ...).

    The ends are reflected (odd reflection) about where a line through what is near to an end, weighted as the filter
    is, has it: a straight line stays as it is, and the last row of a clip is smoothed as all others are.

    Parameters
    ----------
    rows : shape (F, ...)
    sigma : float
        Standard deviation in frames; 0 changes nothing.
    """
    taps = gaussian(sigma, len(rows))
    radius = len(taps) - 1
    if radius < 1:
        return rows.copy()
    kernel = compiled()
    if kernel is not None:
        passed = np.empty(rows.shape)
        kernel.low_pass(np.ascontiguousarray(rows), taps, passed, len(rows))
        return passed
    line = _line_at_end(taps)
    head = 2.0 * np.tensordot(line, rows[: radius + 1], 1)[None] - rows[radius:0:-1]
    tail = 2.0 * np.tensordot(line, rows[: -radius - 2 : -1], 1)[None] - rows[-2 : -radius - 2 : -1]
    padded = np.concatenate((head, rows, tail))
    smooth = np.zeros_like(rows)
    for k, weight in enumerate(np.concatenate((taps[:0:-1], taps))):
        smooth += weight * padded[k : k + len(rows)]
    return smooth
