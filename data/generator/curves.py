"""Smooth curves of time: key values, spread monotonically and blurred by a quintic B-spline, and band-limited noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray

# Spacing of the control values, seconds: the blur's standard deviation is 0.71 of it.
SPACING = 0.04


@dataclass(frozen=True, eq=False)
class Curves:
    """C curves over one span of time: quintic B-splines, so four times continuously differentiable.

    `controls` has shape (K, C); control k stands at `start` + k `spacing`.
    """

    controls: FloatArray
    start: float
    spacing: float

    def __call__(self, times: FloatArray) -> FloatArray:
        """Return the curves' values at times (F,) in seconds, shape (F, C); clamped outside."""
        place = (np.asarray(times, dtype=float) - self.start) / self.spacing
        first = np.floor(place).astype(np.intp)
        weights = _quintic_weights(place - first)
        index = np.clip(first[:, None] + np.arange(-2, 4), 0, len(self.controls) - 1)
        values: FloatArray = np.einsum("fk,fkc->fc", weights, self.controls[index])
        return values


def through_keys(
    keys: Sequence[float], values: FloatArray, *, start: float, stop: float, spacing: float = SPACING
) -> Curves:
    """Return curves near key values, without overshoot between keys of equal value.

    Parameters
    ----------
    keys : K rising times, seconds
    values : shape (K, C)
        A monotone cubic (Fritsch and Carlson) goes through them; the B-spline then rounds its kinks.
    """
    count = int(np.ceil((stop - start) / spacing)) + 7
    first = start - 3 * spacing
    grid: FloatArray = first + spacing * np.arange(count, dtype=np.float64)
    return Curves(monotone_cubic(np.asarray(keys, dtype=float), np.asarray(values), grid), first, spacing)


def noise(rng: np.random.Generator, count: int, *, start: float, stop: float, period: float) -> Curves:
    """Return `count` smooth random curves of unit variance whose controls stand `period` apart."""
    length = int(np.ceil((stop - start) / period)) + 7
    # White controls through a quintic B-spline lose variance: the sum of its squared weights, averaged.
    gain = 1.0 / np.sqrt(_mean_square_weight())
    return Curves(gain * rng.standard_normal((length, count)), start - 3 * period, period)


def monotone_cubic(x: FloatArray, y: FloatArray, at: FloatArray) -> FloatArray:
    """Return the monotone cubic through (x, y), y of shape (K, C), at places `at` (N,); constant outside."""
    h = np.diff(x)[:, None]
    slope = np.diff(y, axis=0) / h
    m = np.zeros_like(y)
    w1, w2 = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    same = slope[:-1] * slope[1:] > 0.0
    safe = np.where(same, slope[:-1] * slope[1:], 1.0)
    mean = (w1 + w2) * safe / (w1 * np.where(same, slope[1:], 1.0) + w2 * np.where(same, slope[:-1], 1.0))
    m[1:-1] = np.where(same, mean, 0.0)
    at = np.clip(at, x[0], x[-1])
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    u = ((at - x[i]) / np.diff(x)[i])[:, None]
    hi = h[i]
    value: FloatArray = (
        y[i] * (1 + 2 * u) * (1 - u) ** 2
        + m[i] * hi * u * (1 - u) ** 2
        + y[i + 1] * u * u * (3 - 2 * u)
        + m[i + 1] * hi * u * u * (u - 1)
    )
    return value


def smooth_step(times: FloatArray, begin: float, end: float) -> FloatArray:
    """Return 0 before `begin`, 1 after `end`, and the least-jerk rise between, shape (F,)."""
    u = np.clip((np.asarray(times, dtype=float) - begin) / (end - begin), 0.0, 1.0)
    rise: FloatArray = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    return rise


def soft_excess(x: FloatArray, width: float) -> FloatArray:
    """Return max(x, 0) with its corner rounded over `width`."""
    rounded: FloatArray = width * np.logaddexp(0.0, x / width)
    return rounded


def _quintic_weights(u: FloatArray) -> FloatArray:
    """Return the six weights of a uniform quintic B-spline at fractions u (F,), shape (F, 6)."""
    v = 1.0 - u
    weights: FloatArray = (
        np.stack(
            (
                v**5,
                26 - 50 * u + 20 * u**2 + 20 * u**3 - 20 * u**4 + 5 * u**5,
                66 - 60 * u**2 + 30 * u**4 - 10 * u**5,
                66 - 60 * v**2 + 30 * v**4 - 10 * v**5,
                26 - 50 * v + 20 * v**2 + 20 * v**3 - 20 * v**4 + 5 * v**5,
                u**5,
            ),
            axis=-1,
        )
        / 120.0
    )
    return weights


def _mean_square_weight() -> float:
    u = (np.arange(64) + 0.5) / 64
    return float(np.mean(np.sum(_quintic_weights(u) ** 2, axis=-1)))
