"""Kochanek-Bartels splines through uneven knots ([PRIO] section 4.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray


def kochanek_bartels(
    knots: FloatArray,
    values: FloatArray,
    *,
    tension: FloatArray,
    continuity: FloatArray,
    bias: FloatArray,
    start_tangent: FloatArray,
    end_tangent: FloatArray,
    basis: Basis,
) -> FloatArray:
    """Return the curve through the values at the N places of its basis, shape (N, D), clamped at the ends.

    The tangents of [KB84], corrected for uneven knots (out x 2 h1 / (h0 + h1), in x 2 h0 / (h0 + h1)), so that with
    continuity 0 the curve is C1. The paper calls this class of splines C2; a cubic that has its tangents given at both
    ends of every span is not. Knots are met exactly, and between two equal values with no tangents there is no drift
    at all.

    Parameters
    ----------
    knots : shape (K,), K >= 2, strictly increasing
    values : shape (K, D)
    tension, continuity, bias : shape (K,)
        All 0: the tangent is the slope between the two neighbours. Tension 1 stops at the knot; continuity other than
        0 breaks the speed there; bias above 0 leans on the span before (overshoots), below 0 on the span after. Those
        of the first and last knot are not used: their tangents are given.
    start_tangent, end_tangent : shape (D,)
        At the first and last knot, per unit of `knots`.
    basis : Basis
        Of the knots, `basis_of`.
    """
    into, out = np.zeros(values.shape), np.zeros(values.shape)
    if len(knots) > 2:
        into[1:-1], out[1:-1] = _tangents(knots, values, np.stack((tension, continuity, bias)))
    out[0], into[-1] = start_tangent, end_tangent
    return basis.curve(values, into, out)


@dataclass(frozen=True, eq=False)
class Basis:
    """What of curves is the same for all values at the knots.

    Of N places in them: the knot before, `i` (N,), how far between that and the next, `s` and its rest `u` (N, 1), how
    much of the step between both (`step`) and of the tangents (`bend`), (N, 1); and which are at the last knot, (N,).
    """

    i: IntArray
    s: FloatArray
    u: FloatArray
    step: FloatArray
    bend: FloatArray
    is_last: BoolArray

    def curve(self, values: FloatArray, into: FloatArray, out: FloatArray) -> FloatArray:
        """Return Hermite's cubic through values with the tangents into and out of each knot, shape (N, D)."""
        i, after = self.i, self.i + 1
        # From the first value on: equal values leave exactly that value.
        step = values[after] - values[i]
        curve: FloatArray = values[i] + self.step * step + self.bend * (self.u * out[i] - self.s * into[after])
        curve[self.is_last] = values[-1]
        return curve


def basis_of(knots: FloatArray, at: FloatArray) -> Basis:
    """Return the basis of curves with so many knots, shape (K,), at places (N,)."""
    at = np.minimum(np.maximum(at, knots[0]), knots[-1])
    i = np.minimum(knots.searchsorted(at, side="right") - 1, len(knots) - 2)
    h = (knots[i + 1] - knots[i])[:, None]
    s = (at - knots[i])[:, None] / h
    u = 1.0 - s
    return Basis(i, s, u, s * s * (3.0 - 2.0 * s), s * u * h, at == knots[-1])


def _tangents(knots: FloatArray, values: FloatArray, shape: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the tangents into and out of each inner knot, per unit of the knots, shape (K - 2, D) each."""
    h, steps = np.diff(knots)[:, None], np.diff(values, axis=0)
    before, after = steps[:-1], steps[1:]
    t, c, b = shape[:, 1:-1, None]
    # [KB84] has them per span. Per unit they are divided by the span, h0 in and h1 out, which leaves of the correction
    # for uneven knots the same factor for both.
    pull = (1.0 - t) / (h[:-1] + h[1:])
    into: FloatArray = pull * ((1.0 - c) * (1.0 + b) * before + (1.0 + c) * (1.0 - b) * after)
    out: FloatArray = pull * ((1.0 + c) * (1.0 + b) * before + (1.0 - c) * (1.0 - b) * after)
    return into, out
