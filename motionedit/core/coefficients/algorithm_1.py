"""[PC]'s Algorithm 1: steps through a damped pseudo-inverse until the goal is near enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.solver import CoefficientSolution, Progress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.coefficients.goals import Goal

# Without a cap it ends where this many iterations in a row brought no nearer error than this share.
_PATIENCE = 1000
_PROGRESS = 1e-9


def solve_damped(
    goals: Sequence[Goal],
    *,
    size: int,
    damping: float,
    tolerance: float,
    max_iterations: int | None,
    unit: float,
) -> CoefficientSolution:
    """Run [PC]'s Algorithm 1: alpha += J^T (J J^T + xi^2 I)^-1 e, no homing, no bound.

    Parameters
    ----------
    damping : float
        xi, in `unit`; iterations grow as its square.
    tolerance : float
        Stop at |e| below this, in `unit`.
    max_iterations : int or None
        None lifts the cap; the run still ends where a thousand iterations bring it no nearer.
    unit : float
        Metres at leg length 0.85 m of the unit that the paper's numbers are in.
    """
    change = np.zeros(size)
    error, jacobian = stacked_errors(goals, change)
    progress = Progress([float(np.linalg.norm(error))])
    floor = (damping * unit) ** 2 * np.eye(len(error))
    best, best_at = progress.history[0], 0
    while max_iterations is None or progress.iterations < max_iterations:
        if progress.history[-1] < tolerance * unit:
            progress.reason = "converged"
            break
        if progress.iterations - best_at > _PATIENCE:
            progress.reason = "stalled"
            break
        change = change + jacobian.T @ np.linalg.lstsq(jacobian @ jacobian.T + floor, error, rcond=None)[0]
        error, jacobian = stacked_errors(goals, change)
        progress.history.append(float(np.linalg.norm(error)))
        if progress.history[-1] < (1.0 - _PROGRESS) * best:
            best, best_at = progress.history[-1], progress.iterations
    return progress.finished(change)
