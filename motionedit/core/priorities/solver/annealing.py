"""When a frame's iterations come to their end: the pull and the lower layers' steps are then quartered each time.

That is so over the last iterations there are, and earlier where what is missed stays missed: once steps are steady, the
error of the most important layer that shall be met, and is far from it, no longer changes. The first layer, which is
never annealed, is not waited for. Where all that is missed gives way, its errors no longer change. Limits of joints are
met slowly: with them nothing ends early; nor does it as the paper has it, where what is missed does not give way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.solver.constants import (
    ANNEALED_ITERATIONS,
    FAR_ERROR,
    HASTY_ITERATIONS,
    MET_WITHOUT_LIMITS,
    SAME_ERROR,
    STALE_ITERATIONS,
)

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray


class Annealing:
    """Of `count` frames: from which iteration on they are annealed."""

    def __init__(self, count: int, layers: int, max_iterations: int, *, ends_early: bool) -> None:
        self._from = np.full(count, max_iterations - ANNEALED_ITERATIONS)
        self._errors, self._stale, self._ends_early = np.zeros((count, layers)), np.zeros(count), ends_early

    def factors(self, frames: IntArray, errors: FloatArray, softness: FloatArray, iteration: int) -> FloatArray:
        """Return what the pull and the lower layers' steps are multiplied by in an iteration, shape (N,).

        Parameters
        ----------
        errors : shape (N, L)
            Lengths of the layers' errors.
        softness : shape (N, L)
            Not 0 where a layer gives way: it need not be met.
        """
        if self._ends_early and iteration >= HASTY_ITERATIONS - 1:
            self._watch(frames, errors, softness, iteration)
        factors: FloatArray = 0.25 ** np.maximum(0, iteration + 1 - self._from[frames])
        return factors

    def _watch(self, frames: IntArray, errors: FloatArray, softness: FloatArray, iteration: int) -> None:
        """Count the iterations in which what is missed stays so: the first is held against the last hasty one."""
        far, before = errors > MET_WITHOUT_LIMITS, self._errors[frames]
        missed, soft = far & (softness == 0.0), far & (softness > 0.0)
        differs = (errors < SAME_ERROR * before) | (before < SAME_ERROR * errors)
        changed = missed & (differs | (errors < FAR_ERROR))
        decides = missed.copy()
        decides[:, 0] &= ~changed[:, 0]
        decides &= np.cumsum(decides, axis=1) == 1
        changed[:, 1:] &= decides[:, 1:]
        self._errors[frames] = np.where(changed | (soft & differs), errors, before)
        rests = soft.any(axis=1) & ~(soft & differs).any(axis=1) & ~missed.any(axis=1)
        stays = (decides & ~changed).any(axis=1) | rests
        stays &= iteration >= HASTY_ITERATIONS
        self._stale[frames] = np.where(stays, self._stale[frames] + 1, 0)
        early = self._stale[frames] >= STALE_ITERATIONS
        self._from[frames] = np.where(early, np.minimum(self._from[frames], iteration), self._from[frames])

    def are_over(self, frames: IntArray, softness: FloatArray, iteration: int) -> BoolArray:
        """Return which frames have had all their iterations, shape (N,): what gives way is not waited for."""
        over: BoolArray = (softness > 0.0).any(axis=1) & (self._from[frames] + ANNEALED_ITERATIONS <= iteration + 1)
        return over
