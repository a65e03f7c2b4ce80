"""The axes that a spec's numbers are along, and how such numbers are taken into the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.measure import WORLD, Measure
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.ground import Frame
    from motionedit.jobs.clip.facts import ClipFacts


@dataclass(frozen=True, eq=False)
class GivenAxes:
    """The axes of the heading frame, or the world's (or those of a joint's frame), of which some are `counted`.

    Where all of them count, what is along the heading's is measured along the world's: it is the same then.
    """

    heading: Frame | None
    counted: tuple[int, ...] = WORLD.counted

    @classmethod
    def of(
        cls, facts: ClipFacts, frame: Literal["world", "heading"], *, counted: tuple[int, ...] = WORLD.counted
    ) -> GivenAxes:
        """Return the axes that a spec names."""
        return cls(facts.heading_frame() if frame == "heading" else None, counted)

    @property
    def rows(self) -> FloatArray:
        """The axes that are measured along, in the world, rows of shape (3, 3)."""
        return WORLD.axes if self.heading is None or self.counted == WORLD.counted else self.heading.axes

    def measure(self, *, base: int | None) -> Measure:
        """Return what positions are measured in: these axes of which some count, or a joint's frame."""
        return WORLD if self.counted == WORLD.counted and base is None else Measure(self.rows, self.counted, base)

    def position(self, given: Sequence[float]) -> FloatArray:
        """Return a position along the axes that are measured along, from the world's origin."""
        position = np.array(given)
        return position if self.heading is None else self.rows @ self.heading.world_points(position)

    def shift(self, given: Sequence[float]) -> FloatArray:
        """Return a shift along the axes that are measured along."""
        shift = np.array(given)
        return shift if self.heading is None else self.rows @ self.heading.axes.T @ shift

    def rotation(self, q: FloatArray) -> FloatArray:
        """Return a rotation in the world."""
        return q if self.heading is None else rot.multiply(self.heading.rotation, q)

    def turn(self, q: FloatArray) -> FloatArray:
        """Return what turns about these axes as `q` does, in the world."""
        return q if self.heading is None else rot.multiply(self.rotation(q), rot.conjugate(self.heading.rotation))
