"""Principal components of motion vectors by their Gram matrix ([PC] 4.1, eq. 3 and 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Eigenvalues below this share of the first are rounding, not motion.
RANK_TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class PrincipalComponents:
    """A linear model of motion vectors, Psi = mean + sum alpha_i E_i, eq. (3).

    Attributes
    ----------
    mean : shape (D,)
    components : shape (m, D)
        Rows E_i, orthonormal; the entry of largest magnitude is positive.
    explained_variance : shape (m,)
        lambda_i, decreasing, of the unbiased covariance (divisor M - 1).
    total_variance : float
        Sum over all components, also those left out.
    coefficients : shape (M, m)
        alpha of each motion of the database.
    """

    mean: FloatArray
    components: FloatArray
    explained_variance: FloatArray
    total_variance: float
    coefficients: FloatArray

    @property
    def explained_variance_ratio(self) -> FloatArray:
        """Share of each component in the whole variance, shape (m,)."""
        ratio: FloatArray = self.explained_variance / self.total_variance
        return ratio


def fit_components(motions: FloatArray) -> PrincipalComponents:
    """Return all principal components of M motion vectors, shape (M, D), M >= 2.

    The M x M Gram matrix X X^T has the eigenvalues of the covariance; E_i = X^T u_i / s_i. The rank is at most M - 1.

    Raises
    ------
    ValueError
        If the motions are all the same: there is nothing to learn.
    """
    mean = motions.mean(axis=0)
    X = motions - mean
    eigenvalues, vectors = np.linalg.eigh(X @ X.T)
    order = np.argsort(eigenvalues)[::-1][: len(motions) - 1]
    eigenvalues = np.maximum(eigenvalues[order], 0.0)
    # Measured against the vectors' own size: rounding of equal motions is no variance.
    if not eigenvalues[0] > (np.finfo(np.float64).eps ** 2) * np.sum(motions**2):
        raise ValueError("the motions are all the same")
    kept = eigenvalues > RANK_TOLERANCE * eigenvalues[0]
    rows = vectors[:, order[kept]].T @ X
    # One QR step takes away what the squared condition of the Gram matrix left in the weakest rows.
    Q, R = np.linalg.qr(rows.T)
    components = (Q * np.sign(np.diag(R))).T
    largest = np.argmax(np.abs(components), axis=1)
    components = components * np.sign(components[np.arange(len(components)), largest])[:, None]
    return PrincipalComponents(
        mean=frozen(mean),
        components=frozen(components),
        explained_variance=frozen(eigenvalues[kept] / (len(motions) - 1)),
        total_variance=float(np.sum(X**2) / (len(motions) - 1)),
        coefficients=frozen(X @ components.T),
    )


def components_for(explained_variance_ratio: FloatArray, share: float) -> int:
    """Return the least m whose cumulative explained variance reaches `share` (sigma of eq. 4)."""
    cumulative = np.cumsum(explained_variance_ratio)
    # A share of 1 must not ask for more components than there are because of the last bit.
    return min(int(np.searchsorted(cumulative, share - 1e-12)) + 1, len(cumulative))
