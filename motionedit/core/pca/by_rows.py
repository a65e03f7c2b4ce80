"""Work on large matrices by blocks of rows, in threads: the blocks, and so the bits, are those of one thread."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray

# Enough that a product takes no longer than as a whole.
_ROWS = 256


def product(A: FloatArray, B: FloatArray, *, threads: int) -> FloatArray:
    """Return A B."""
    AB = np.empty((len(A), B.shape[1]))
    _by_rows(lambda rows: np.matmul(A[rows], B, out=AB[rows]), len(A), threads)
    return AB


def lower_gram(X: FloatArray, *, threads: int) -> FloatArray:
    """Return the lower triangle of X X^T; above it are zeros, or what is below."""
    gram = np.zeros((len(X), len(X)))

    def multiply(rows: slice) -> None:
        gram[rows, : rows.stop] = X[rows] @ X[: rows.stop].T

    _by_rows(multiply, len(X), threads)
    return gram


def lower_product(L: FloatArray, B: FloatArray, *, threads: int) -> FloatArray:
    """Return L B, of a matrix L that is zero above its diagonal."""
    LB = np.empty((len(L), B.shape[1]))
    _by_rows(lambda rows: np.matmul(L[rows, : rows.stop], B[: rows.stop], out=LB[rows]), len(L), threads)
    return LB


def make_unit(rows: FloatArray, *, threads: int) -> None:
    """Divide rows by their lengths, in place."""

    def divide(some: slice) -> None:
        rows[some] /= np.linalg.norm(rows[some], axis=1, keepdims=True)

    _by_rows(divide, len(rows), threads)


def _by_rows(work: Callable[[slice], object], count: int, threads: int) -> None:
    """Call a function with all rows, block by block; the last, which may be the longest, first."""
    blocks = [slice(first, min(first + _ROWS, count)) for first in range(0, count, _ROWS)][::-1]
    if min(threads, len(blocks)) < 2:
        for rows in blocks:
            work(rows)
        return
    from concurrent.futures import ThreadPoolExecutor

    pool = ThreadPoolExecutor(min(threads, len(blocks)))
    try:
        list(pool.map(work, blocks))
    finally:  # after Ctrl-C what was not begun is not waited for
        pool.shutdown(cancel_futures=True)
