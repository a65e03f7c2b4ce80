"""Work on large matrices by blocks, in threads: the blocks, and so the bits, are those of one thread."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.arrays import FloatArray

# Enough that a product takes no longer than as a whole.
_ROWS, _COLUMNS = 256, 1024


def product(A: FloatArray, B: FloatArray, *, threads: int) -> FloatArray:
    """Return A B."""
    AB = np.empty((len(A), B.shape[1]))
    _in_threads(lambda rows: np.matmul(A[rows], B, out=AB[rows]), _blocks(len(A)), threads)
    return AB


def lower_gram(X: FloatArray, *, threads: int) -> FloatArray:
    """Return the lower triangle of X X^T; above it are zeros, or what is below."""
    gram = np.zeros((len(X), len(X)))

    def multiply(rows: slice) -> None:
        gram[rows, : rows.stop] = X[rows] @ X[: rows.stop].T

    _in_threads(multiply, _blocks(len(X)), threads)
    return gram


def multiply_lower(L: FloatArray, B: FloatArray, *, threads: int) -> None:
    """Put L B in the place of B, of a matrix L that is zero above its diagonal: the last rows first."""

    def multiply(columns: slice) -> None:
        for rows in _blocks(len(L)):
            B[rows, columns] = L[rows, : rows.stop] @ B[: rows.stop, columns]

    _in_threads(multiply, _blocks(B.shape[1], _COLUMNS), threads)


def make_unit(rows: FloatArray, *, threads: int) -> None:
    """Divide rows by their lengths, in place."""

    def divide(some: slice) -> None:
        rows[some] /= np.sqrt(np.einsum("ij,ij->i", rows[some], rows[some]))[:, None]

    _in_threads(divide, _blocks(len(rows)), threads)


def _blocks(count: int, step: int = _ROWS) -> list[slice]:
    """Return the blocks of so many rows or columns; the last, which may take the longest, first."""
    return [slice(first, min(first + step, count)) for first in range(0, count, step)][::-1]


def _in_threads(work: Callable[[slice], object], blocks: list[slice], threads: int) -> None:
    """Call a function with each block."""
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
