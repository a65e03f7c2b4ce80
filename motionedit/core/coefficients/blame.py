"""Which goals a missed one gave way to: those for which it is missed, though it could be met, solved again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.likeliest import likeliest_change
from motionedit.core.coefficients.solver import ERROR_STOP, free_solution

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.goals import Goal
    from motionedit.core.coefficients.likeliest import LikeliestChange


def rivals_of(
    layers: Sequence[Sequence[Goal]], found: LikeliestChange, *, size: int, bound: float | None
) -> dict[int, tuple[int, ...]]:
    """Return which goals of its layer, or of those above, keep each missed one from being met; not those that none do.

    Those beside which alone it is missed; where it takes more than one, those without which all others are met with it;
    else all. Goals are named by their place among all of the layers.

    Parameters
    ----------
    layers, size, bound
        As `likeliest_change`, and `found` what it found.
    """
    if found.reason == "converged":
        return {}
    goals = [goal for layer in layers for goal in layer]
    depths = [depth for depth, layer in enumerate(layers) for _ in layer]

    def are_met(some: Sequence[int]) -> bool:
        free = free_solution(lambda y: stacked_errors([goals[k] for k in some], y), size)
        return free.reason == "converged" and (bound is None or float(np.linalg.norm(free.change)) <= bound)

    def is_met_beside(i: int, k: int) -> bool:
        both = [[goals[k]], [goals[i]]] if depths[k] < depths[i] else [[goals[k], goals[i]]]
        return are_met([k, i]) or _is_met(goals[i], likeliest_change(both, size=size, bound=bound).change)

    def rivals(i: int) -> list[int]:
        others = [k for k in range(len(goals)) if k != i and depths[k] <= depths[i]]
        if not others or not are_met([i]):
            return []
        against = [k for k in others if not is_met_beside(i, k)]
        return against or [k for k in others if are_met([i, *(each for each in others if each != k)])] or others

    missed = [i for i, goal in enumerate(goals) if not _is_met(goal, found.change)]
    return {i: tuple(blamed) for i in missed if (blamed := rivals(i))}


def _is_met(goal: Goal, y: FloatArray) -> bool:
    return float(np.linalg.norm(stacked_errors([goal], y)[0])) < ERROR_STOP
