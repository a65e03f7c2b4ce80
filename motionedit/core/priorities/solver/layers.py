"""One pass down the priority layers: the recursion of eq. (1), and the rows that lower layers may not use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.solver.constants import LEAST_SCALE, LIMB, RANK_TOLERANCE
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray


@dataclass(eq=False)
class Descent:
    """What a pass came to in N frames of n unknowns; frames are put in place of others as hinges meet their limits.

    Attributes
    ----------
    tasks : shape (N, n)
        The step that the layers ask for.
    home : shape (N, n)
        z - Q^T (Q z): what is left of the pull to the reference.
    Q : shape (N, k, n)
        Orthonormal rows of all layers; rows of zeros where a direction was not kept.
    free : shape (N, n)
        Unknowns that took part; the others are hinges on their limits.
    ranks : shape (N, L)
        Independent rows of each layer.
    """

    tasks: FloatArray
    home: FloatArray
    Q: FloatArray
    free: BoolArray
    ranks: IntArray

    def replace_rows(self, rows: IntArray, other: Descent) -> None:
        """Put the frames of another descent, which may have more or fewer rows, in place of some of these."""
        more = other.Q.shape[1] - self.Q.shape[1]
        if more > 0:
            self.Q = np.pad(self.Q, ((0, 0), (0, more), (0, 0)))
        self.Q[rows] = 0.0
        self.Q[rows, : other.Q.shape[1]] = other.Q
        for mine, new in (
            (self.tasks, other.tasks),
            (self.home, other.home),
            (self.free, other.free),
            (self.ranks, other.ranks),
        ):
            mine[rows] = new


def descend(
    evaluated: Sequence[tuple[FloatArray, FloatArray]],
    z: FloatArray,
    *,
    fixed: FloatArray,
    free: BoolArray,
    largest_errors: Sequence[FloatArray],
    steady: bool,
    softness: FloatArray,
    limits: FloatArray,
) -> Descent:
    """Return one pass down the layers.

    Parameters
    ----------
    evaluated : L pairs of shapes (N, k) and (N, k, n)
        Weighted errors and rows, the most important layer first.
    z : shape (N, n)
        The pull to the reference.
    fixed : shape (N, n)
        The step of unknowns that are not free.
    free : shape (N, n)
    largest_errors : L arrays of shape (N,)
        b_max of each layer: a longer error is clamped to it, all rows by one factor.
    steady : bool
        Whether errors may be out of reach: see `_damped_step`.
    softness : shape (N, L)
        lambda^2 of layers that give way: what is left of the pull among their rows counts beside their errors.
    limits : shape (N, k, n)
        Orthonormal rows, or zeros, that no layer may use: joints are on limits there, where `fixed` has set them.
    """
    tasks = fixed.copy()
    ranks = np.zeros((len(z), len(evaluated)), dtype=np.intp)
    Q = limits
    for level, ((e, J), largest) in enumerate(zip(evaluated, largest_errors, strict=True)):
        size = np.linalg.norm(e, axis=1, keepdims=True)
        clamped = e * np.minimum(1.0, largest[:, None] / np.maximum(size, largest[:, None]))
        b = clamped - (J @ tasks[..., None])[..., 0]
        A = J * free[:, None]
        A = A - (A @ np.swapaxes(Q, 1, 2)) @ Q
        soft = softness[:, level]
        change, rows, ranks[:, level] = _damped_step(A, b, z, largest, soft, steady=steady)
        tasks += change
        Q = np.concatenate((Q, rows), axis=1)
    return Descent(tasks, off_layers(Q, z * free), Q, free, ranks)


def off_layers(Q: FloatArray, v: FloatArray) -> FloatArray:
    """Return v - Q^T (Q v), shape (N, n): what no layer sees."""
    rest: FloatArray = v - (np.swapaxes(Q, 1, 2) @ (Q @ v[..., None]))[..., 0]
    return rest


def _damped_step(
    A: FloatArray, b: FloatArray, z: FloatArray, largest: FloatArray, soft: FloatArray, *, steady: bool
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the layer's step (N, n), its orthonormal rows (N, k, n; zero where not kept), and its rank (N,).

    lambda follows the length of b and s = 1 / |A~^+|_F, a little less than the smallest kept singular value and found
    without a search for it: none where the step is safe, half of d where s is nothing.

    Where b is out of reach it stays, and limbs stand stretched: the error's second derivative along a turn is |b| times
    a limb, and a step along its gradient over lambda^2 swings to and fro unless lambda^2 >= |b| limb / 2. `steady` sees
    to that by d. Where b can be reached it shrinks, and costs steps.
    """
    values, vectors = np.linalg.eigh(A @ np.swapaxes(A, 1, 2))
    s = np.sqrt(np.maximum(values, 0.0))
    kept = s > RANK_TOLERANCE * np.maximum(s[:, -1:], LEAST_SCALE)
    safe = np.where(kept, s, 1.0)
    rows = np.where(kept, 1.0 / safe, 0.0)[..., None] * (np.swapaxes(vectors, 1, 2) @ A)
    inverse = np.sqrt(np.sum(np.where(kept, 1.0 / safe, 0.0) ** 2, axis=1))
    least = np.where(inverse > 0.0, 1.0 / np.where(inverse > 0.0, inverse, 1.0), 0.0)
    size = np.linalg.norm(b, axis=1)
    d = np.maximum(size / largest, np.sqrt(2.0 * LIMB * size)) if steady else size / largest
    damping = np.where(least <= 0.5 * d, 0.5 * d, np.sqrt(np.maximum(least * (d - least), 0.0)))
    damping = np.where(least <= d, damping, 0.0)
    along = (np.swapaxes(vectors, 1, 2) @ b[..., None])[..., 0]
    home = (rows @ z[..., None])[..., 0]
    square = np.maximum(damping**2, soft)[:, None]
    weights = np.where(kept, (along * safe + soft[:, None] * home) / (safe**2 + square), 0.0)
    step: FloatArray = (weights[:, None] @ rows)[:, 0]
    return step, rows, np.count_nonzero(kept, axis=1)
