"""Principal components of motion vectors by their Gram matrix ([PC] 4.1, eq. 3 and 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.pca.by_rows import lower_gram, make_unit, multiply_lower, product
from motionedit.core.pca.left_out import LeftOut, left_out_of_gram
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# Eigenvalues below this share of the first are rounding, not motion.
RANK_TOLERANCE = 1e-10
# Rows of a matrix that is inverted as a whole.
_SMALL = 64


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
    left_out : LeftOut or None
        How far each motion is from the others; None in a model that was made before it was computed.
    """

    mean: FloatArray
    components: FloatArray
    explained_variance: FloatArray
    total_variance: float
    coefficients: FloatArray
    left_out: LeftOut | None = None

    @property
    def explained_variance_ratio(self) -> FloatArray:
        """Share of each component in the whole variance, shape (m,)."""
        ratio: FloatArray = self.explained_variance / self.total_variance
        return ratio


class AllTheSameError(ValueError):
    """The motions are all the same: there is nothing to learn."""

    def __init__(self) -> None:
        super().__init__("the motions are all the same")


class TooFewComponentsError(ValueError):
    """More components are asked for than the `available` ones."""

    def __init__(self, available: int) -> None:
        super().__init__(f"there are {available} components")
        self.available = available


@dataclass(frozen=True)
class ComponentCount:
    """How many components to keep: `count` of them, or as many as explain `share` of the variance; else all."""

    count: int | None = None
    share: float | None = None

    def least(self, default: int) -> int:
        """Return the count, or a default."""
        return default if self.count is None else self.count


ALL = ComponentCount()


def fit_centred(X: FloatArray, mean: FloatArray, *, count: ComponentCount, threads: int = 1) -> PrincipalComponents:
    """Return the principal components of M motion vectors, shape (M, D), of which their mean, shape (D,), was taken.

    The M x M Gram matrix X X^T has the eigenvalues of the covariance; E_i = X^T u_i / s_i. The rank is at most M - 1.
    They are the same for any number of threads.

    Raises
    ------
    ValueError
        If the motions are all the same (`AllTheSameError`), or there are not as many components as asked for
        (`TooFewComponentsError`).
    """
    gram = lower_gram(X, threads=threads)
    eigenvalues, vectors = np.linalg.eigh(gram)
    order = np.argsort(eigenvalues)[::-1][: len(X) - 1]
    eigenvalues = np.maximum(eigenvalues[order], 0.0)
    total = float(np.vdot(X, X))
    refuse_no_variance(float(eigenvalues[0]), total=total, mean=mean, count=len(X))
    kept, rank = _kept(eigenvalues, total, count), _rank(eigenvalues)
    components = product(vectors[:, order[:kept]].T, X, threads=threads)
    _make_orthonormal(components, threads=threads)
    components *= signs_of(components)[:, None]
    return PrincipalComponents(
        mean=frozen(mean),
        components=frozen(components),
        explained_variance=frozen(eigenvalues[:kept] / (len(X) - 1)),
        total_variance=total / (len(X) - 1),
        coefficients=frozen(product(X, components.T, threads=threads)),
        left_out=left_out_of_gram(eigenvalues[:rank], vectors[:, order[:rank]], np.diag(gram)),
    )


def refuse_no_variance(largest: float, *, total: float, mean: FloatArray, count: int) -> None:
    """Raise `AllTheSameError` where the largest sum of squares along a direction is but rounding of the vectors."""
    # The mean of M equal numbers, added up one by one, is off by up to M roundings.
    rounding = count * np.finfo(np.float64).eps
    if not largest > rounding**2 * (total + count * float(mean @ mean)):
        raise AllTheSameError


def _rank(eigenvalues: FloatArray) -> int:
    return int(np.count_nonzero(eigenvalues > RANK_TOLERANCE * eigenvalues[0]))


def _kept(eigenvalues: FloatArray, total: float, count: ComponentCount) -> int:
    available = _rank(eigenvalues)
    if count.share is not None:
        return components_for(eigenvalues[:available] / total, count.share)
    if count.count is not None and count.count > available:
        raise TooFewComponentsError(available)
    return count.least(available)


def _make_orthonormal(rows: FloatArray, *, threads: int) -> None:
    """Make nearly orthogonal rows orthonormal, in place: each is what those before it left of it.

    The squared condition of the Gram matrix left the weakest rows off by a millionth. The rows at unit length are
    well conditioned, so that Cholesky does as well as a QR step, in a third of its time.
    """
    make_unit(rows, threads=threads)
    L = np.linalg.cholesky(lower_gram(rows, threads=threads))
    multiply_lower(_lower_inverse(np.asarray(L, np.float64)), rows, threads=threads)


def _lower_inverse(L: FloatArray) -> FloatArray:
    """Return the inverse of a matrix that is zero above its diagonal, by halves: a quarter of the work of any other."""
    if len(L) <= _SMALL:
        return np.asarray(np.linalg.inv(L), np.float64)
    half = len(L) // 2
    inverse = np.zeros_like(L)
    first, last = _lower_inverse(L[:half, :half]), _lower_inverse(L[half:, half:])
    inverse[:half, :half], inverse[half:, half:] = first, last
    inverse[half:, :half] = -last @ (L[half:, :half] @ first)
    return inverse


def signs_of(components: FloatArray) -> FloatArray:
    """Return the signs, shape (m,), that make the entry of largest magnitude of each component positive."""
    # Row by row, for all at once would take as much memory again.
    largest = [int(np.argmax(np.abs(row))) for row in components]
    signs: FloatArray = np.sign(components[np.arange(len(components)), largest])
    return signs


def components_for(explained_variance_ratio: FloatArray, share: float) -> int:
    """Return the least m whose cumulative explained variance reaches `share` (sigma of eq. 4)."""
    cumulative = np.cumsum(explained_variance_ratio)
    # A share of 1 must not ask for more components than there are because of the last bit.
    return min(int(np.searchsorted(cumulative, share - 1e-12)) + 1, len(cumulative))
