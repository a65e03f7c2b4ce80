"""The prior over changes of a motion: components as the database has them, and a pose residual that fades in time.

    delta(f) = E(s(f)) beta + K(f, T) K(T, T)^-1 rho,   beta ~ N(0, (1 - g) Lambda),   rho(t) ~ N(0, g K x D)

The components of a handful of motions explain part of an unseen one; a goal met inside them alone is met by overfitting.
The share g of a change may therefore leave them: a change of pose about the goals' frames T, as large as the database
itself varies there (D), that dies away as the residuals of left-out motions do (K). A change y of unit variance is
mapped to beta and rho, so that the least |y| is the likeliest change.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.pca.model import MotionModel

# Seconds: left-out residuals of six sets of real strokes correlate in time like a Gaussian of this width.
FADE = 0.15
# Metres at leg length 0.85 m: a planted foot that would move by so much counts as one standard deviation.
FOOT_DEVIATION = 0.1
# Beside 1 on the diagonal of K: frames next to each other are nearly one.
_JITTER = 1e-9


@dataclass(frozen=True, eq=False)
class ChangePrior:
    """How y, shape (m + K d,), makes a change: m components, d columns of Theta at K frames.

    Attributes
    ----------
    spread : shape (m, m)
        beta = spread @ y[:m].
    columns : shape (d,)
        Columns of Theta that the residual may change.
    deviations : shape (d,)
        sqrt(g D) of each.
    frames : shape (K,)
        The goals' frames, increasing.
    root : shape (K, K)
        L, lower triangular, with K(T, T) = L L^T: rho(T) = L @ (y[m:] as (K, d)) * deviations.
    """

    spread: FloatArray
    columns: IntArray
    deviations: FloatArray
    frames: IntArray
    root: FloatArray

    @property
    def size(self) -> int:
        """How many numbers y has."""
        return len(self.spread) + len(self.frames) * len(self.columns)

    def coefficients(self, y: FloatArray) -> FloatArray:
        """Return beta, shape (m,)."""
        beta: FloatArray = self.spread @ y[: len(self.spread)]
        return beta

    def residual(self, y: FloatArray) -> FloatArray:
        """Return rho, what leaves the components at the goals' frames, shape (K, d)."""
        parts = y[len(self.spread) :].reshape(len(self.frames), len(self.columns))
        rho: FloatArray = (self.root @ parts) * self.deviations
        return rho

    def rows_of(self, component_rows: FloatArray, columns: IntArray, frame: int) -> FloatArray:
        """Return d Theta / dy at a goal's frame, shape (len(columns), size).

        Parameters
        ----------
        component_rows : shape (len(columns), m)
            The components there.
        """
        own = np.zeros((len(columns), len(self.frames), len(self.columns)))
        at, place = np.nonzero(columns[:, None] == self.columns)
        here = int(np.searchsorted(self.frames, frame))
        own[at, :, place] = self.root[here] * self.deviations[place, None]
        return np.concatenate((component_rows @ self.spread, own.reshape(len(columns), -1)), axis=1)


def change_prior(
    projection: Projection,
    model: MotionModel,
    *,
    frames: Sequence[int],
    columns: IntArray,
    share: float,
    feet: FloatArray | None = None,
) -> ChangePrior:
    """Return the prior for goals at some frames.

    Parameters
    ----------
    columns : shape (d,)
        Of Theta, those behind the goals' effectors.
    share : float
        g, 0 to 1: the share of a change's variance that may leave the components.
    feet : shape (m, m), optional
        The mean of J^T J of planted feet, square metres: beta's precision grows by it over `FOOT_DEVIATION` squared.
    """
    at = np.unique(np.asarray(frames, dtype=np.intp))
    variance = model.components.explained_variance
    spread = np.diag(np.sqrt((1.0 - share) * variance))
    if feet is not None:
        precision = np.eye(len(variance)) + spread @ feet @ spread / FOOT_DEVIATION**2
        spread = spread @ _inverse_root(precision)
    return ChangePrior(
        spread=frozen(spread),
        columns=columns,
        deviations=frozen(np.sqrt(share * _pose_variance(model, projection.places[at], columns))),
        frames=frozen(at),
        root=frozen(np.linalg.cholesky(_kernel(at, at, projection.motion.frame_time))),
    )


def _inverse_root(A: FloatArray) -> FloatArray:
    """Return the symmetric A^-1/2 of a positive definite matrix."""
    values, vectors = np.linalg.eigh(A)
    root: FloatArray = (vectors / np.sqrt(values)) @ vectors.T
    return root


def _pose_variance(model: MotionModel, places: FloatArray, columns: IntArray) -> FloatArray:
    """Return D: the database's variance of columns of Theta, the mean within `FADE` of places on the timeline."""
    frames = np.arange(model.timeline.frames, dtype=np.float64)
    apart = np.abs(frames[:, None] - places).min(axis=1) / model.timeline.frame_rate
    near = np.flatnonzero(apart <= max(FADE, float(apart.min())))
    rows = model.component_rows[:, near][:, :, columns]
    variance: FloatArray = np.einsum("m,mfd->d", model.components.explained_variance, rows**2) / len(near)
    return variance


def interpolated(rho: FloatArray, at: IntArray, frames: int, frame_time: float) -> FloatArray:
    """Return K(f, T) K(T, T)^-1 rho for all frames f, shape (frames, d): at the frames T themselves it is rho, (K, d).

    What is to be expected between and beside the goals' frames where it is rho at those.
    """
    weights = np.linalg.solve(_kernel(at, at, frame_time), rho)
    expected: FloatArray = _kernel(np.arange(frames), at, frame_time) @ weights
    return expected


def _kernel(one: IntArray, other: IntArray, frame_time: float) -> FloatArray:
    """Return K, shape (len(one), len(other)): a Gaussian of width `FADE` over the time between frames."""
    apart = one[:, None] - other
    # The same frame is a little more like itself than its neighbours are, or goals next to each other would be one.
    kernel: FloatArray = np.exp(-0.5 * (apart * (frame_time / FADE)) ** 2) + _JITTER * (apart == 0)
    return kernel
