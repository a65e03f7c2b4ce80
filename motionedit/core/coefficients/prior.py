"""The prior over changes of a motion: components as the database has them, and a pose residual that fades in time.

    delta(f) = E(s(f)) beta + K(f, T) K(T, T)^-1 rho,   beta ~ N(0, (1 - g) Lambda),   rho(t) ~ N(0, g K x D)

The components of a handful of motions explain part of an unseen one; a goal met inside them alone is overfitted. The
share g of a change may therefore leave them: a change of pose about the goals' frames T, as large as the database
itself varies there (D), that dies away as the residuals of left-out motions do (K). A change y of unit variance is
mapped to beta and rho, so that the least |y| is the likeliest change.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.coefficients.planted_feet import PlantedFoot
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.pca.model import MotionModel

# Seconds: left-out residuals of six sets of real strokes correlate in time like a Gaussian of this width.
FADE = 0.15
# The share of a pose's variance that each joint has by itself, beside how the database's poses vary together; and what
# a column that does not vary at all has, so that the root of the whole exists.
_ALONE, _LEAST_VARIANCE = 0.65, 1e-12
# Rad: poses of real strokes, walks and jumps vary by 7 to 28 degrees. Near copies of one motion say how a body moves
# together, not how far it may go: poses that vary by less than this count as varying by as much more.
_LEAST_DEVIATION = float(np.radians(5.0))
_LEAST_TRAVEL = 0.05  # metres at leg length 0.85 m: and so far the body may then go as a whole
_TRAVEL = 3  # columns of Theta that are no rotation's
EACH = 3  # columns of the travel, and of every joint
# Beside 1 on the diagonal of K: frames next to each other are nearly one.
_JITTER = 1e-9


@dataclass(frozen=True, eq=False)
class ChangePrior:
    """How y makes a change: z = root y, shape (m + K d,), makes beta, and a residual of d columns at K frames.

    Attributes
    ----------
    deviations : shape (m,)
        sqrt((1 - g) lambda): beta = deviations * z[:m].
    columns : shape (d,)
        Columns of Theta that the residual may change.
    factor : shape (d, d)
        F with F F^T = g D, lower triangular.
    frames : shape (K,)
        The goals' frames, increasing.
    kernel_root : shape (K, K)
        L, lower triangular, with K(T, T) = L L^T: rho(T) = L @ (z[m:] as (K, d)) @ F^T.
    root : shape (m + K d, m + K d)
        Makes z of y; not the identity where planted feet make some changes less likely than others.
    """

    deviations: FloatArray
    columns: IntArray
    factor: FloatArray
    frames: IntArray
    kernel_root: FloatArray
    root: FloatArray

    @property
    def size(self) -> int:
        """How many numbers y has."""
        return len(self.root)

    def coefficients(self, y: FloatArray) -> FloatArray:
        """Return beta, shape (m,)."""
        count = len(self.deviations)
        beta: FloatArray = self.deviations * (self.root[:count] @ y)
        return beta

    def residual(self, y: FloatArray) -> FloatArray:
        """Return rho, what leaves the components at the goals' frames, shape (K, d)."""
        parts = (self.root[len(self.deviations) :] @ y).reshape(len(self.frames), len(self.columns))
        rho: FloatArray = (self.kernel_root @ parts) @ self.factor.T
        return rho

    def rows_of(self, component_rows: FloatArray, columns: IntArray, frame: int) -> FloatArray:
        """Return d Theta / dy at a goal's frame, shape (len(columns), size).

        Parameters
        ----------
        component_rows : shape (len(columns), m)
            The components there.
        """
        here = int(np.searchsorted(self.frames, frame))
        own = np.zeros((len(columns), len(self.frames), len(self.columns)))
        at, place = np.nonzero(columns[:, None] == self.columns)
        own[at] = self.kernel_root[here][:, None] * self.factor[place][:, None]
        whole = np.concatenate((component_rows * self.deviations, own.reshape(len(columns), -1)), axis=1)
        rows: FloatArray = whole @ self.root
        return rows


def change_prior(
    projection: Projection,
    model: MotionModel,
    *,
    frames: Sequence[int],
    columns: IntArray,
    share: float,
    feet: Sequence[PlantedFoot] = (),
) -> ChangePrior:
    """Return the prior for goals at some frames.

    Parameters
    ----------
    columns : shape (d,)
        Of Theta, those that the residual may change.
    share : float
        g, 0 to 1: the share of a change's variance that may leave the components.
    feet : sequence of PlantedFoot
        Points that stand, and are rather not moved.
    """
    # Not by np.unique, which imports numpy.ma: that takes longer than the edit.
    at = np.array(sorted(set(np.asarray(frames).tolist())), dtype=np.intp)
    kernel_root = np.asarray(np.linalg.cholesky(_kernel(at, at, projection.motion.frame_time)), dtype=np.float64)
    size = len(model.components.explained_variance) + len(at) * len(columns)
    prior = ChangePrior(
        deviations=frozen(np.sqrt(1.0 - share) * np.sqrt(model.components.explained_variance)),
        columns=columns,
        factor=frozen(np.sqrt(share) * _pose_factor(model, projection.places[at], columns)),
        frames=frozen(at),
        kernel_root=frozen(kernel_root),
        root=frozen(np.eye(size)),
    )
    return replace(prior, root=frozen(_root(prior, projection, model, feet))) if feet else prior


def _root(prior: ChangePrior, projection: Projection, model: MotionModel, feet: Sequence[PlantedFoot]) -> FloatArray:
    """Return the root of the covariance of z, (I + A^T A)^-1, where A z is how far planted feet are moved."""
    precision = np.eye(prior.size)
    for foot in feet:
        near = _kernel(foot.frames, prior.frames, projection.motion.frame_time)
        fade = np.linalg.solve(prior.kernel_root, near.T).T
        places = model.timeline.frames_at(projection.places[foot.frames])
        # What is picked at once is the foot's alone: all columns of many motions take longer than the rest.
        components = np.moveaxis(model.component_rows[:, places[:, None], foot.columns], 0, -1)
        at, place = np.nonzero(foot.columns[:, None] == prior.columns)
        own = foot.rows[:, :, at].reshape(-1, len(at)) @ prior.factor[place]
        faded = np.repeat(fade, 3, axis=0)[:, :, None] * own[:, None]
        along = (foot.rows @ components).reshape(len(own), -1) * prior.deviations
        A = np.concatenate((along, faded.reshape(len(own), -1)), axis=1)
        precision += (foot.seconds / (2.0 * FADE * foot.deviation**2)) * (A.T @ A)
    # z^T P z = |L^T z|^2 with P = L L^T, so y = L^T z.
    return np.linalg.inv(np.linalg.cholesky(precision)).T


def _pose_factor(model: MotionModel, places: FloatArray, columns: IntArray) -> FloatArray:
    """Return F, shape (d, d): F F^T is how poses vary in the database within `FADE` of places on the timeline.

    `_ALONE` of it goes to each joint by itself, along its own axes of the database: a few motions know a few ways of
    moving together, and a goal may ask for another one. Poses that hardly vary are taken to do so by
    `_LEAST_DEVIATION`.
    """
    frames = np.arange(model.timeline.frames, dtype=np.float64)
    apart = np.abs(frames[:, None] - places).min(axis=1) / model.timeline.frame_rate
    near = np.flatnonzero(apart <= max(FADE, float(apart.min())))
    rows = model.component_rows[:, near][:, :, columns]
    rows = (rows * np.sqrt(model.components.explained_variance / len(near))[:, None, None]).reshape(-1, len(columns))
    together = rows.T @ rows
    turning, joints = columns >= _TRAVEL, columns // EACH
    same = joints[:, None] == joints
    times = _widening((together * same)[np.ix_(turning, turning)])
    together *= times
    travel = (1.0 - 1.0 / times) * (_LEAST_TRAVEL * model.space.root_weight) ** 2
    alone = together * same + np.diag(np.where(turning, 0.0, travel))
    mixed = (1.0 - _ALONE) * together + _ALONE * alone + np.diag(np.full(len(columns), _LEAST_VARIANCE))
    return np.asarray(np.linalg.cholesky(mixed), dtype=np.float64)


def _widening(covariances: FloatArray) -> float:
    """Return by what to multiply the covariances of joints' rotations, rad^2, by `_LEAST_DEVIATION`; 1 or more.

    The mean of the variances is weighted by themselves, for many joints hardly turn at all.
    """
    total = float(np.trace(covariances))
    if total <= 0.0:
        return 1.0
    spread = float(np.sqrt(np.sum(covariances * covariances) / total))
    return max(1.0, 2.0 * _LEAST_DEVIATION / spread - 1.0) ** 2


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
