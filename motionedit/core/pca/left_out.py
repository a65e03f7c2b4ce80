"""What a database says of a motion that it does not hold: each of its own left out in turn, and looked for by the rest.

The share that the others do not explain is the one figure that tells whether a database predicts at all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen, median
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# A motion whose null directions of the Gram matrix weigh more than this, squared, is a combination of the others.
_COMBINED = 1e-9
# What is left of a direction that a single motion makes, 1 - its leverage, below which nothing can be said.
_LEAST_FREE = 1e-6


@dataclass(frozen=True, eq=False)
class LeftOut:
    """How far each of M motions is from the others, sums of squares over a motion vector, shape (M,) each.

    Attributes
    ----------
    deviations
        From the mean of the others.
    residuals
        What of that no combination of the others' differences gives.
    """

    deviations: FloatArray
    residuals: FloatArray

    @property
    def squares(self) -> FloatArray:
        """Each motion's |x|^2, x its deviation from the mean of all, shape (M,)."""
        squares: FloatArray = self.deviations / _farther(len(self.deviations))
        return squares

    @property
    def share(self) -> float:
        """The share of an unseen motion that the database does not explain, 0 to 1."""
        return float(self.residuals.sum() / self.deviations.sum())

    @property
    def shares(self) -> FloatArray:
        """The same of each motion, shape (M,)."""
        shares: FloatArray = self.residuals / np.where(self.deviations > 0.0, self.deviations, 1.0)
        return shares

    @property
    def furthest(self) -> int:
        """The motion with the largest residual."""
        return int(np.argmax(self.residuals))

    @property
    def times(self) -> FloatArray:
        """Each motion's residual, as a length, over the median of all, shape (M,); ones where they are all nothing."""
        middle = float(median(self.residuals))
        return np.sqrt(self.residuals / middle) if middle > 0.0 else np.ones(len(self.residuals))


def left_out_of_gram(eigenvalues: FloatArray, vectors: FloatArray, squares: FloatArray) -> LeftOut:
    """Return what leaving out does, from the Gram matrix G = X X^T of M centred motions, without any further fit.

    The squared distance of motion i from all combinations of the others, sum of weights 1, is 1 / (G^+)_ii: the least
    w^T G w with w_i = 1 and sum(w) = 0.

    Parameters
    ----------
    eigenvalues, vectors : shapes (r,), (M, r)
        Of G, those that are not rounding.
    squares : shape (M,)
        The diagonal of G.
    """
    count = len(squares)
    inverse = (vectors**2 / eigenvalues).sum(axis=1)
    # Beside the vector of ones, a null direction with this motion in it makes it out of the others.
    combined = 1.0 - 1.0 / count - (vectors**2).sum(axis=1) > _COMBINED
    residuals = np.where(combined, 0.0, 1.0 / np.where(inverse > 0.0, inverse, np.inf))
    return _left_out(residuals, squares)


def left_out_of_components(coefficients: FloatArray, variance: FloatArray, squares: FloatArray) -> LeftOut:
    """Return nearly the same from the first m components of many more motions, as a regression is cross-validated.

    What m components leave of a motion was fitted with that motion among the others; over 1 - h, its leverage, it is
    what they would leave without it.

    Parameters
    ----------
    coefficients : shape (M, m)
    variance : shape (m,)
        lambda.
    squares : shape (M,)
        |x|^2 of the centred motions.
    """
    count = len(squares)
    leverage = 1.0 / count + (coefficients**2 / variance).sum(axis=1) / (count - 1)
    left = np.maximum(squares - (coefficients**2).sum(axis=1), 0.0)
    return _left_out(left / np.maximum(1.0 - leverage, _LEAST_FREE) ** 2, squares)


def _left_out(residuals: FloatArray, squares: FloatArray) -> LeftOut:
    deviations = squares * _farther(len(squares))
    return LeftOut(frozen(deviations), frozen(np.minimum(residuals, deviations)))


def _farther(count: int) -> float:
    """Return by how much a motion's square from the mean of the others is larger than from that of all."""
    return (count / (count - 1)) ** 2
