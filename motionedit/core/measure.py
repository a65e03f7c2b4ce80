"""In what positions and rotations are measured: along axes of the world, or in the frame of a joint."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Hashable

    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import WorldPoses


@dataclass(frozen=True, eq=False)
class Measure:
    """Axes that positions are measured along, in the world or in a joint's frame, and which of them count.

    Attributes
    ----------
    axes : shape (3, 3)
        Rows are the axes, in the world, or in the frame of `base`.
    counted : tuple of int
        Which of them count for a position.
    base : int or None
        The joint in whose frame positions and rotations are; None is the world.
    """

    axes: FloatArray = field(default_factory=lambda: frozen(np.eye(3)))
    counted: tuple[int, ...] = (0, 1, 2)
    base: int | None = None

    @cached_property
    def key(self) -> Hashable:
        """What is equal of measures that are the same."""
        return self.axes.tobytes(), self.counted, self.base

    @cached_property
    def rows(self) -> FloatArray:
        """The axes that count, shape (k, 3)."""
        return frozen(self.axes[list(self.counted)])

    @cached_property
    def _is_worlds(self) -> bool:
        """Whether the axes are the world's, or the base's own: what is along them needs no turning."""
        return bool(np.array_equal(self.axes, np.eye(3)))

    @cached_property
    def is_world(self) -> bool:
        """Whether positions are those in the world, as they are."""
        return self.is_whole and self._is_worlds

    @property
    def is_whole(self) -> bool:
        """Whether a position is all of a place in the world."""
        return self.base is None and self.counted == (0, 1, 2)

    def positions(self, points: FloatArray, poses: WorldPoses) -> FloatArray:
        """Return world positions (N, 3) along the axes, x = A R_b^T (p - p_b); `poses` are those of the N frames."""
        if self.base is not None:
            points = points - poses.positions[:, self.base]
        return self.directions(points, poses)

    def directions(self, vectors: FloatArray, poses: WorldPoses) -> FloatArray:
        """Return world vectors (N, 3) along the axes, A R_b^T v."""
        if self.base is not None:
            vectors = rot.unrotate(poses.rotations[:, self.base], vectors)
        return vectors if self._is_worlds else vectors @ self.axes.T

    def rotations(self, turns: FloatArray, poses: WorldPoses) -> FloatArray:
        """Return world rotations (N, 4) as they are in the base's frame, q_b^-1 q."""
        if self.base is None:
            return turns
        return rot.between(poses.rotations[:, self.base], turns)

    def in_world(self, places: FloatArray, poses: WorldPoses) -> FloatArray:
        """Return places (N, 3) along the axes as world positions, p = p_b + R_b A^T x."""
        points: FloatArray = places if self._is_worlds else places @ self.axes
        if self.base is None:
            return points
        turned: FloatArray = rot.rotate(poses.rotations[:, self.base], points)
        return poses.positions[:, self.base] + turned

    def aimed(self, places: FloatArray, goals: FloatArray) -> FloatArray:
        """Return the goals (N, 3) along the axes that count, and the places themselves along the others."""
        if self.counted == (0, 1, 2):
            return goals.copy()
        aimed = places.copy()
        aimed[:, list(self.counted)] = goals[:, list(self.counted)]
        return aimed


WORLD = Measure()


@dataclass(frozen=True, eq=False)
class Level:
    """A height in the world: `height` along the unit vector `up`, shape (3,)."""

    up: FloatArray
    height: float = 0.0

    def above(self, points: FloatArray) -> FloatArray:
        """Return how far points, shape (..., 3), are above it."""
        heights: FloatArray = points @ self.up - self.height
        return heights


def relative_rows(
    inverse: FloatArray, between: FloatArray, rows: FloatArray, base_rows: FloatArray, base_turns: FloatArray
) -> FloatArray:
    """Return the rows of a point in a base's frame, d = R_b^T (dp - dp_b - w_b x (p - p_b)), shape (..., 3, n).

    Parameters
    ----------
    inverse : shape (..., 3, 3)
        R_b^T.
    between : shape (..., 3)
        p - p_b.
    rows, base_rows, base_turns : shape (..., 3, n)
        dp, dp_b, w_b.
    """
    moved: FloatArray = inverse @ (rows - base_rows + rot.skew(between) @ base_turns)
    return moved
