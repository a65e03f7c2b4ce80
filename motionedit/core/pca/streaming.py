"""Principal components of more motions than fit in memory: block by block, in a few passes ([PC] 4.1, eq. 3 and 4).

A random block of directions is multiplied by the covariance, once a pass; all products so far, made orthonormal, span
a subspace (block Lanczos: a subspace iteration that forgets nothing) whose own principal components come near those
of the data, the largest first. How far each still is from one is known exactly, from what the last product left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.pca.fit import (
    RANK_TOLERANCE,
    ComponentCount,
    PrincipalComponents,
    TooFewComponentsError,
    components_for,
    refuse_no_variance,
    signs_of,
)
from motionedit.core.pca.left_out import left_out_of_components
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.vectors import CentredVectors

# How many components are kept where nothing says how many, and the most that can be asked for: beyond, the passes
# take longer than a study of the data is worth, and the basis more memory than the blocks.
DEFAULT_COMPONENTS = 100
MOST_COMPONENTS = 1000
# A component is found when |C e - lambda e| is below this share of the first lambda: its variance is then exact to
# this squared over the gap to the next, its direction to this over the gap.
RESIDUAL_TOLERANCE = 1e-8
MOST_PASSES = 8
# Directions of a block beyond those that are wanted, which make the last of these converge; and the widest block.
_SPARE = 10
_WIDEST_BLOCK = 128
_SEED = 20070831


@dataclass(frozen=True, eq=False)
class Streamed:
    """The components that were found, in how many `passes`, and the largest `residual` over the first variance."""

    components: PrincipalComponents
    passes: int
    residual: float


@dataclass
class _Subspace:
    """What the passes have found: bases (D, l), their products with the vectors (M, l), and Gram matrix of these."""

    bases: list[FloatArray]
    products: list[FloatArray]
    gram: FloatArray

    @property
    def width(self) -> int:
        return len(self.gram)

    def add(self, basis: FloatArray, product: FloatArray) -> None:
        beside = [before.T @ product for before in self.products]
        grown = np.empty((self.width + basis.shape[1],) * 2)
        grown[: self.width, : self.width] = self.gram
        grown[:, self.width :] = np.concatenate([*beside, product.T @ product])
        grown[self.width :] = grown[:, self.width :].T
        self.bases.append(basis)
        self.products.append(product)
        self.gram = grown

    def without(self, block: FloatArray) -> FloatArray:
        """Return a block less its part in the subspace."""
        for basis in self.bases:
            block = block - basis @ (basis.T @ block)
        return block


def stream_components(centred: CentredVectors, *, count: ComponentCount) -> Streamed:
    """Return the first principal components of M motion vectors, and how exact they are.

    Memory holds a block of vectors, the subspace (at most 2,024 directions) and M rows of coefficients in it.

    Raises
    ------
    ValueError
        If the motions are all the same (`AllTheSameError`), or there are not as many components as asked for
        (`TooFewComponentsError`).
    """
    size = len(centred.mean)
    rank = min(centred.count - 1, size)
    asked = min(count.least(DEFAULT_COMPONENTS), MOST_COMPONENTS)
    if count.count is not None and count.count > min(rank, MOST_COMPONENTS):
        raise TooFewComponentsError(min(rank, MOST_COMPONENTS))
    width = min(asked + _SPARE, _WIDEST_BLOCK, rank)
    most = min(rank, MOST_COMPONENTS + MOST_PASSES * _WIDEST_BLOCK)
    squares, block = _random_products(centred, width)
    total = float(squares.sum())
    subspace = _Subspace([], [], np.empty((0, 0)))
    passes, limit = 1, MOST_PASSES + asked // _WIDEST_BLOCK
    while True:
        basis = np.linalg.qr(block)[0]
        # Twice is enough; the second time also takes care of directions that were nothing but rounding.
        basis = np.linalg.qr(subspace.without(basis))[0]
        product, block = _products(centred, basis)
        subspace.add(basis, product)
        block = subspace.without(subspace.without(block))
        passes += 1
        values, weights = np.linalg.eigh(subspace.gram)
        values, weights = np.maximum(values[::-1], 0.0), weights[:, ::-1]
        left = np.linalg.norm(np.linalg.qr(block)[1] @ weights[-basis.shape[1] :], axis=0)
        kept, enough = _wanted(values, total, count, asked=asked)
        residual = float(left[:kept].max()) / float(values[0])
        width = min(width, most - subspace.width)
        if width < 1 or (enough and (residual < RESIDUAL_TOLERANCE or passes >= limit)):
            break
        block = block[:, :width]
    return Streamed(_rebuilt(subspace, centred, (values, weights, kept), squares), passes, residual)


def _random_products(centred: CentredVectors, width: int) -> tuple[FloatArray, FloatArray]:
    """Return the sum of squares of each vector, shape (M,), and random sums of the vectors, shape (D, l).

    Raises
    ------
    AllTheSameError
        If there is nothing to sum.
    """
    rng = np.random.default_rng(_SEED)
    squares, sums = np.empty(centred.count), np.zeros((len(centred.mean), width))
    for first, block in centred.blocks():
        squares[first : first + len(block)] = np.einsum("ij,ij->i", block, block)
        sums += block.T @ rng.normal(size=(len(block), width))
    total = float(squares.sum())
    refuse_no_variance(total, total=total, mean=centred.mean, count=centred.count)
    return squares, sums


def _products(centred: CentredVectors, basis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return X Q, shape (M, l), and X^T X Q, shape (D, l)."""
    product, back = np.empty((centred.count, basis.shape[1])), np.zeros(basis.shape)
    for first, block in centred.blocks():
        part = block @ basis
        product[first : first + len(block)] = part
        back += block.T @ part
    return product, back


def _wanted(values: FloatArray, total: float, count: ComponentCount, *, asked: int) -> tuple[int, bool]:
    """Return how many components are kept of those found so far, and whether these are as many as were wanted."""
    rank = int(np.count_nonzero(values > RANK_TOLERANCE * values[0]))
    if count.share is None:
        return min(asked, rank), rank >= asked or rank < len(values)
    ratios = values[: min(rank, MOST_COMPONENTS)] / total
    reached = float(ratios.sum()) >= count.share - 1e-12
    return components_for(ratios, count.share), reached or rank < len(values) or rank >= MOST_COMPONENTS


def _rebuilt(
    subspace: _Subspace, centred: CentredVectors, found: tuple[FloatArray, FloatArray, int], squares: FloatArray
) -> PrincipalComponents:
    """Return the first components of the subspace and the vectors' coefficients; `squares` (M,) are |x|^2."""
    values, weights, kept = found
    components = np.zeros((kept, len(centred.mean)))
    coefficients = np.zeros((centred.count, kept))
    start = 0
    for basis, product in zip(subspace.bases, subspace.products, strict=True):
        part = weights[start : start + basis.shape[1], :kept]
        components += part.T @ basis.T
        coefficients += product @ part
        start += basis.shape[1]
    signs = signs_of(components)
    variance = values[:kept] / (centred.count - 1)
    return PrincipalComponents(
        mean=frozen(centred.mean.copy()),
        components=frozen(components * signs[:, None]),
        explained_variance=frozen(variance),
        total_variance=float(squares.sum()) / (centred.count - 1),
        coefficients=frozen(coefficients * signs),
        left_out=left_out_of_components(coefficients, variance, squares),
    )
