"""One-sided rows: they ask for J w >= e, and take part only where a step would not keep that anyway.

In each iteration none of them takes part at first. Those that the step violates are taken in, to land on their limit,
and the layers are gone down again. A point below a floor is so lifted by exactly what it lacks, and one that something
else lifts higher is left alone.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.solver.constants import ON_SIDE
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Evaluated:
    """A layer's weighted errors (N, k) and rows (N, k, n), and which of them are one-sided (k,)."""

    e: FloatArray
    J: FloatArray
    one_sided: BoolArray

    @property
    def left(self) -> FloatArray:
        """What is left of the errors, shape (N, k): nothing of one-sided rows that are on the right side."""
        left: FloatArray = np.where(self.one_sided, np.maximum(self.e, 0.0), self.e)
        return left


class Rows:
    """The rows of all layers in N frames. `active` (N, m) tells which of the m one-sided ones take part."""

    def __init__(self, layers: Sequence[Evaluated]) -> None:
        self._others = [_two_sided(each) for each in layers]
        self._e = np.concatenate([each.e[:, each.one_sided] for each in layers], axis=1)
        self._J = np.concatenate([each.J[:, each.one_sided] for each in layers], axis=1)
        self._bounds = np.cumsum([0, *(np.count_nonzero(each.one_sided) for each in layers)])
        self.active = np.zeros(self._e.shape, dtype=np.bool_)

    @property
    def any_one_sided(self) -> bool:
        """Whether there is a one-sided row."""
        return self.active.size > 0

    def taking_part(self, frames: IntArray | slice) -> list[tuple[FloatArray, FloatArray]]:
        """Return the errors and rows of each layer that take part in some of the frames."""
        layers = []
        for (e, J), (first, stop) in zip(self._others, pairwise(self._bounds), strict=True):
            active = self.active[frames, first:stop]
            count = int(np.count_nonzero(active, axis=1).max(initial=0))
            if not count:
                layers.append((e[frames], J[frames]))
                continue
            # Each frame's own come first; rows of zeros fill up.
            order = np.argsort(~active, axis=1, kind="stable")[:, :count]
            there = np.take_along_axis(active, order, axis=1)
            limits = np.take_along_axis(self._e[frames, first:stop], order, axis=1) * there
            rows = np.take_along_axis(self._J[frames, first:stop], order[..., None], axis=1) * there[..., None]
            layers.append((np.concatenate((e[frames], limits), axis=1), np.concatenate((J[frames], rows), axis=1)))
        return layers

    def lacks(self, step: FloatArray) -> FloatArray:
        """Return by how much a step (N, n) violates rows that do not take part, shape (N, m); 0 where it does not."""
        lacks = self._e - (self._J @ step[..., None])[..., 0]
        return np.where(self.active | (lacks <= ON_SIDE), 0.0, lacks)

    def take_in(self, step: FloatArray, *, left: int) -> BoolArray:
        """Let rows take part that a step violates, and return in which frames there are any, shape (N,).

        While rounds are left it is the row that is violated most: what lifts it may lift the others.
        """
        lacks = self.lacks(step)
        least = lacks.max(axis=1, keepdims=True, initial=0.0) if left else 0.0
        new = (lacks > 0.0) & (lacks >= least)
        self.active[new] = True
        found: BoolArray = np.any(new, axis=1)
        return found


def _two_sided(layer: Evaluated) -> tuple[FloatArray, FloatArray]:
    """Return the errors and rows of a layer that are not one-sided."""
    if not layer.one_sided.any():
        return layer.e, layer.J
    return layer.e[:, ~layer.one_sided], layer.J[:, ~layer.one_sided]


class Sides:
    """Which one-sided rows took part in the iteration before, of `count` frames."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._before: BoolArray | None = None

    def unchanged(self, frames: IntArray, active: BoolArray) -> BoolArray:
        """Return in which frames the same rows (N, m) take part as before, shape (N,), and remember these."""
        if self._before is None:
            self._before = np.zeros((self._count, active.shape[1]), dtype=np.bool_)
        same: BoolArray = (self._before[frames] == active).all(axis=1)
        self._before[frames] = active
        return same
