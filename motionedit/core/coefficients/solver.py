"""Solvers for goals in coefficient space: damped Gauss-Newton, and a plausibility bound.

Both solve for the change beta = alpha - alpha_0 and home to beta = 0, so that what no goal asks for stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.penalty_search import PenaltySearch
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.goals import Goal

    Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

# Metres at leg length 0.85 m: a hundredth of a millimetre.
ERROR_STOP = 1e-5
STEP_STOP = 1e-2

FIRST_DAMPING = 1e-6
LEAST_DAMPING = 1e-12
MOST_TRIES = 12
# After so many iterations the change is as small as it needs to be, and only the error is left to be taken away.
HOMING_ITERATIONS = 8
MOST_ITERATIONS = 100

# Levenberg-Marquardt ends where the gradient or the step is this small beside its own scale.
STALL = 1e-10

# How closely the bound is kept, relative to it.
BOUND_TOLERANCE = 1e-4
# With a penalty, steps below this part of the solution move its norm by less than the bound's tolerance.
PENALISED_STALL = 1e-6


@dataclass(frozen=True, eq=False)
class CoefficientSolution:
    """What a solver found.

    Attributes
    ----------
    change : shape (m,)
        beta = alpha - alpha_0.
    iterations : int
        Accepted steps.
    history : tuple of float
        |e| in metres at leg length 0.85 m, at the start and after each iteration.
    reason : str
        Why it stopped: ``converged``, ``stalled``, ``bound``, ``iterations``.
    """

    change: FloatArray
    iterations: int
    history: tuple[float, ...]
    reason: str


def step_metric(explained_variance: FloatArray) -> FloatArray:
    """Return the diagonal of W = I + median(lambda) / lambda, shape (m,), which measures a change of coefficients.

    Unit-norm components alone keep the style but spend weak components freely; a Mahalanobis metric alone slides
    along the first component, which is the style.
    """
    # Not np.median: it imports numpy.ma, which takes ten times as long as a solve.
    in_order, middle = np.sort(explained_variance), len(explained_variance) // 2
    metric: FloatArray = 1.0 + 0.5 * (in_order[middle] + in_order[-1 - middle]) / explained_variance
    return metric


def solve_goals(
    goals: Sequence[Goal],
    *,
    explained_variance: FloatArray,
    start: FloatArray,
    bound: float | None,
) -> CoefficientSolution:
    """Return the smallest change of coefficients that meets the goals, or comes nearest within the bound.

    Parameters
    ----------
    explained_variance : shape (m,)
        lambda_i.
    start : shape (m,)
        alpha_0, which enters the bound alone.
    bound : float or None
        Largest Mahalanobis norm |alpha / sqrt(lambda)| of the result.
    """
    root = 1.0 / np.sqrt(step_metric(explained_variance))
    deviation = np.sqrt(explained_variance)

    def evaluate(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        error, jacobian = stacked_errors(goals, root * y)
        return error, jacobian * root

    free = free_solution(evaluate, len(start))
    if bound is None or np.linalg.norm((start + root * free.change) / deviation) <= bound:
        return replace(free, change=root * free.change)
    offset, slope = start / deviation, root / deviation

    def nearest(y: FloatArray, penalty: float) -> tuple[FloatArray, float]:
        return penalised(evaluate, y, offset=offset, slope=slope, penalty=penalty)

    bounded = bounded_solution(
        nearest, evaluate, norm=lambda y: float(np.linalg.norm(offset + slope * y)), size=len(start), bound=bound
    )
    return replace(bounded, change=root * bounded.change, history=(free.history[0], *bounded.history))


@dataclass
class Progress:
    """The errors of a run so far, and why it ends."""

    history: list[float]
    reason: str = "iterations"

    @property
    def iterations(self) -> int:
        """How many steps were accepted."""
        return len(self.history) - 1

    def finished(self, change: FloatArray) -> CoefficientSolution:
        """Return the solution that a run has come to."""
        return CoefficientSolution(change, self.iterations, tuple(self.history), self.reason)


def free_solution(evaluate: Evaluate, size: int) -> CoefficientSolution:
    """Damped Gauss-Newton, homing to zero; Levenberg-Marquardt where it stalls."""
    y = np.zeros(size)
    error, jacobian = evaluate(y)
    progress = Progress([float(np.linalg.norm(error))])
    damping, step = FIRST_DAMPING, np.inf
    while progress.iterations < MOST_ITERATIONS:
        settled = step <= STEP_STOP * float(np.linalg.norm(y)) or progress.iterations >= HOMING_ITERATIONS
        if progress.history[-1] < ERROR_STOP and (settled or progress.iterations == 0):
            progress.reason = "converged"
            break
        # Homing converges but linearly where the set of solutions is curved: the last of the error is taken from
        # where it has come to.
        home = y if settled else np.zeros(size)
        found = _gauss_newton_step(evaluate, y, error, jacobian, damping, home=home)
        if found is None:
            y, error, jacobian = _levenberg_marquardt(evaluate, y, progress)
            if progress.history[-1] < ERROR_STOP:
                progress.reason = "converged"
            break
        y_new, error, jacobian, damping = found
        step = float(np.linalg.norm(y_new - y))
        y = y_new
        progress.history.append(float(np.linalg.norm(error)))
    return progress.finished(y)


def _gauss_newton_step(
    evaluate: Evaluate, y: FloatArray, error: FloatArray, jacobian: FloatArray, damping: float, *, home: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, float] | None:
    """Return (y+, error, jacobian, damping), or None where no damping makes progress.

    y+ = h + J^T (J J^T + d tr(J J^T)/p I)^-1 (e + J (y - h)): the step to the goal that ends nearest to `home` h.
    """
    gram = jacobian @ jacobian.T
    unit = float(np.trace(gram)) / len(gram)
    if unit == 0.0:
        return None
    now = float(np.linalg.norm(error))
    wanted = error + jacobian @ (y - home)
    for _ in range(MOST_TRIES):
        y_new = home + jacobian.T @ np.linalg.solve(gram + damping * unit * np.eye(len(gram)), wanted)
        error_new, jacobian_new = evaluate(y_new)
        size = float(np.linalg.norm(error_new))
        # Without real progress a Gauss-Newton step has nothing to say: the goal is out of reach from here.
        if size < max((1.0 - STALL) * now, ERROR_STOP):
            return y_new, error_new, jacobian_new, max(0.1 * damping, LEAST_DAMPING)
        damping *= 10.0
    return None


def _levenberg_marquardt(
    evaluate: Evaluate, y: FloatArray, progress: Progress, *, stall: float = STALL
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Minimise |e|^2 from y on with Nielsen's rule for the damping; the history grows by the accepted steps."""
    error, jacobian = evaluate(y)
    A, g = jacobian.T @ jacobian, jacobian.T @ error
    mu, nu = 1e-3 * max(float(np.max(np.diag(A))), STALL), 2.0
    progress.reason = "iterations"
    while progress.iterations < MOST_ITERATIONS:
        if float(np.linalg.norm(error)) < ERROR_STOP:
            break
        step = np.linalg.solve(A + mu * np.eye(len(y)), g)
        if float(np.linalg.norm(step)) <= stall * (float(np.linalg.norm(y)) + stall):
            progress.reason = "stalled"
            break
        error_new, jacobian_new = evaluate(y + step)
        gain = float(error @ error - error_new @ error_new) / float(step @ (mu * step + g))
        if gain > 0.0:
            y, error, jacobian = y + step, error_new, jacobian_new
            A, g = jacobian.T @ jacobian, jacobian.T @ error
            mu, nu = mu * max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3), 2.0
            progress.history.append(float(np.linalg.norm(error)))
        else:
            mu, nu = mu * nu, 2.0 * nu
    return y, error, jacobian


def bounded_solution(
    nearest: Callable[[FloatArray, float], tuple[FloatArray, float]],
    evaluate: Evaluate,
    *,
    norm: Callable[[FloatArray], float],
    size: int,
    bound: float,
    start: FloatArray | None = None,
) -> CoefficientSolution:
    """Minimise |e|^2 + mu |z|^2 with mu lowered until the norm |z| meets the bound.

    Parameters
    ----------
    nearest : callable
        Returns, from a y and mu, the minimising y and its |e|.
    start : shape (size,), optional
        Where to begin, within the bound; zero without.
    """
    best = np.zeros(size) if start is None else start
    progress = Progress([])
    search = PenaltySearch((1.0 - 0.5 * BOUND_TOLERANCE) * bound)
    while not search.ended:
        y, length = nearest(best, search.penalty)
        progress.history.append(length)
        size_of_y = norm(y)
        if size_of_y <= bound:
            best = y
            if length < ERROR_STOP or size_of_y >= (1.0 - BOUND_TOLERANCE) * bound:
                break
        search.tried(size_of_y, within=size_of_y <= bound)
    error = float(np.linalg.norm(evaluate(best)[0]))
    progress.history.append(error)
    progress.reason = "converged" if error < ERROR_STOP else "bound"
    return progress.finished(best)


def penalised(
    evaluate: Evaluate, y: FloatArray, *, offset: FloatArray, slope: FloatArray, penalty: float
) -> tuple[FloatArray, float]:
    """Return the y that minimises |e|^2 + mu |z|^2, and its |e|: Levenberg-Marquardt on the stacked rows."""
    weight = float(np.sqrt(penalty))

    def stacked(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        error, jacobian = evaluate(y)
        return np.concatenate((error, -weight * (offset + slope * y))), np.vstack((jacobian, weight * np.diag(slope)))

    inner = Progress([0.0])
    y, error, _ = _levenberg_marquardt(stacked, y, inner, stall=PENALISED_STALL)
    return y, float(np.linalg.norm(error[: -len(offset)]))
