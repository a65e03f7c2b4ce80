"""Kochanek-Bartels splines through uneven knots ([PRIO] section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Knots:
    """K knots of a curve: `times` (K,) strictly increasing, `values` (K, D), and the three parameters, each (K,)."""

    times: FloatArray
    values: FloatArray
    tension: FloatArray
    continuity: FloatArray
    bias: FloatArray


def kochanek_bartels(knots: Knots, at: FloatArray, *, start_tangent: FloatArray, end_tangent: FloatArray) -> FloatArray:
    """Return the curve at times, shape (N, D), clamped at the ends.

    With tension, continuity and bias 0 it is a Catmull-Rom spline whose tangents are corrected for uneven knots (out
    x 2 h1 / (h0 + h1), in x 2 h0 / (h0 + h1)), so that its speed is continuous: C1, where the paper says C2. Tension 1
    stops at the knot; continuity other than 0 breaks the speed there.

    Parameters
    ----------
    start_tangent, end_tangent : shape (D,)
        Speed at the first and last knot, per unit of time.
    """
    t, p = knots.times, knots.values
    at = np.clip(at, t[0], t[-1])
    i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    incoming, outgoing = _tangents(knots, start_tangent, end_tangent)
    h = (t[i + 1] - t[i])[:, None]
    s = (at - t[i])[:, None] / h
    u = 1.0 - s
    curve: FloatArray = (
        (1.0 + 2.0 * s) * u * u * p[i]
        + s * u * u * h * outgoing[i]
        + s * s * (3.0 - 2.0 * s) * p[i + 1]
        - s * s * u * h * incoming[i + 1]
    )
    return curve


def _tangents(knots: Knots, start: FloatArray, end: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the speed into and out of each knot, shape (K, D) each, per unit of time."""
    incoming, outgoing = np.zeros_like(knots.values), np.zeros_like(knots.values)
    outgoing[0], incoming[0] = start, start
    outgoing[-1], incoming[-1] = end, end
    if len(knots.times) > 2:
        h = np.diff(knots.times)[:, None]
        steps = np.diff(knots.values, axis=0)
        before, after, h0, h1 = steps[:-1], steps[1:], h[:-1], h[1:]
        t, c, b = (x[1:-1, None] for x in (knots.tension, knots.continuity, knots.bias))
        # Tangents per span, as Kochanek and Bartels have them, then per unit of time: / h, corrected by
        # 2 h / (h0 + h1), which leaves 2 / (h0 + h1) for both sides.
        pull = 0.5 * (1.0 - t)
        uneven = 2.0 / (h0 + h1)
        incoming[1:-1] = uneven * pull * ((1.0 - c) * (1.0 + b) * before + (1.0 + c) * (1.0 - b) * after)
        outgoing[1:-1] = uneven * pull * ((1.0 + c) * (1.0 + b) * before + (1.0 - c) * (1.0 - b) * after)
    return incoming, outgoing
