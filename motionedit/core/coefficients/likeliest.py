"""The likeliest change that meets goals: the least |y| under a prior, in strict layers of priority, within a bound.

y has unit variance, so that |y| counts standard deviations of the database.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.solver import (
    BOUND_TOLERANCE,
    ERROR_STOP,
    MOST_ITERATIONS,
    PENALISED_STALL,
    STALL,
    bounded_solution,
    free_solution,
)
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.goals import Goal
    from motionedit.core.coefficients.solver import Evaluate

# Singular values below this share of the largest give no direction.
_RANK = 1e-9
# How nearly the layers above keep their errors, metres, and the Newton steps that this may take.
_KEPT = 0.1 * ERROR_STOP
_RESTORING_STEPS = 12
_MOST_DAMPING = 1e12


@dataclass(frozen=True, eq=False)
class LikeliestChange:
    """What was found.

    Attributes
    ----------
    change : shape (n,)
        y.
    iterations : int
    history : tuple of float
        |e| of all goals, metres at leg length 0.85 m.
    reasons : tuple of str
        Why each layer stopped, the most important first: ``converged``, ``bound``, ``stalled``, ``iterations``, or
        ``gave way`` where it could have been met but for the layers above.
    """

    change: FloatArray
    iterations: int
    history: tuple[float, ...]
    reasons: tuple[str, ...]

    @property
    def reason(self) -> str:
        """Why the first layer that is not met stopped; ``converged`` where all are."""
        return next((reason for reason in self.reasons if reason != "converged"), "converged")


def likeliest_change(layers: Sequence[Sequence[Goal]], *, size: int, bound: float | None) -> LikeliestChange:
    """Return the least y that meets the goals; where not all can be met, layer after layer, none at another's cost.

    Parameters
    ----------
    layers : sequence of sequence of Goal
        The most important first.
    bound : float or None
        Largest |y|.
    """
    every = [goal for layer in layers for goal in layer]
    whole = free_solution(lambda y: stacked_errors(every, y), size)
    if whole.reason == "converged" and _within(whole.change, bound):
        return LikeliestChange(whole.change, whole.iterations, whole.history, ("converged",) * len(layers))
    done, iterations, reasons = np.zeros(size), whole.iterations, []
    above: list[tuple[Sequence[Goal], FloatArray]] = []
    for layer in layers:
        if "bound" in reasons:
            # At the bound nothing is left to choose.
            reasons.append(_why(layer, "bound", size=size, bound=bound))
            continue
        done, reason, more = _layer(above, layer, done, bound=bound)
        iterations += more
        reasons.append(_why(layer, reason, size=size, bound=bound) if above else reason)
        above.append((layer, stacked_errors(layer, done)[0]))
    left = float(np.linalg.norm(stacked_errors(every, done)[0]))
    return LikeliestChange(done, iterations, (*whole.history, left), tuple(reasons))


def _within(y: FloatArray, bound: float | None) -> bool:
    return bound is None or float(np.linalg.norm(y)) <= bound


def _why(layer: Sequence[Goal], reason: str, *, size: int, bound: float | None) -> str:
    """Return the reason of a layer below others: whether it would have been met without them."""
    if reason == "converged":
        return reason
    alone = free_solution(lambda y: stacked_errors(layer, y), size)
    return "gave way" if alone.reason == "converged" and _within(alone.change, bound) else reason


def _layer(
    above: Sequence[tuple[Sequence[Goal], FloatArray]], layer: Sequence[Goal], y: FloatArray, *, bound: float | None
) -> tuple[FloatArray, str, int]:
    """Return y with a layer as near as those above leave it, why it stopped, and how many iterations it took."""

    def kept(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        parts = [(e - left, J) for (goals, left) in above for e, J in [stacked_errors(goals, y)]]
        return np.concatenate([e for e, _ in parts]), np.concatenate([J for _, J in parts])

    def own(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        return stacked_errors(layer, y)

    def all_of(y: FloatArray) -> tuple[FloatArray, FloatArray]:
        if not above:
            return own(y)
        (e, J), (e_own, J_own) = kept(y), own(y)
        return np.concatenate((e, e_own)), np.concatenate((J, J_own))

    def nearest(start: FloatArray, penalty: float) -> tuple[FloatArray, float]:
        if not above:
            return _penalised(own, start, penalty=penalty)
        found = _constrained(own, kept, start, penalty=penalty)[0]
        return found, float(np.linalg.norm(own(found)[0]))

    free = free_solution(all_of, len(y))
    found, iterations = free.change, free.iterations
    if free.reason == "converged" and _within(found, bound):
        return found, "converged", iterations
    if above:
        found, more = _constrained(own, kept, y, penalty=0.0)
        iterations += more
    if _within(found, bound):
        met = float(np.linalg.norm(own(found)[0])) < ERROR_STOP
        return found, "converged" if met else "stalled", iterations
    bounded = bounded_solution(
        nearest, own, norm=lambda y: float(np.linalg.norm(y)), size=len(y), bound=bound or np.inf, start=y
    )
    return _filled(own, above, bounded.change, bound=bound or np.inf), bounded.reason, iterations + bounded.iterations


def _filled(
    own: Evaluate, above: Sequence[tuple[Sequence[Goal], FloatArray]], y: FloatArray, *, bound: float
) -> FloatArray:
    """Return y as long as its bound lets it be, where that is nearer and no layer above is in the way.

    As the penalty falls |y| may jump over the bound from well below it.
    """
    length = float(np.linalg.norm(y))
    if above or length == 0.0:
        return y
    longer = y * ((1.0 - 0.5 * BOUND_TOLERANCE) * bound / length)
    return longer if float(np.linalg.norm(own(longer)[0])) < float(np.linalg.norm(own(y)[0])) else y


def _penalised(own: Evaluate, y: FloatArray, *, penalty: float) -> tuple[FloatArray, float]:
    """Return the y that minimises |e|^2 + mu |y|^2, and its |e|: Levenberg-Marquardt, solved in the p rows alone.

    (J^T J + c I)^-1 g = (g - J^T (J J^T + c I)^-1 J g) / c: there are far more unknowns than rows.
    """
    error, J = own(y)
    value = float(error @ error + penalty * (y @ y))
    gram = J @ J.T
    damping = 1e-3 * float(np.trace(gram)) / len(gram)
    least = 1e-9 * damping
    for _ in range(MOST_ITERATIONS):
        g = J.T @ error - penalty * y
        c = penalty + damping
        step = (g - J.T @ np.linalg.solve(gram + c * np.eye(len(gram)), J @ g)) / c
        if float(np.linalg.norm(step)) <= PENALISED_STALL * (float(np.linalg.norm(y)) + PENALISED_STALL):
            break
        error_new, J_new = own(y + step)
        value_new = float(error_new @ error_new + penalty * ((y + step) @ (y + step)))
        if value_new < value:
            y, error, J, value = y + step, error_new, J_new, value_new
            gram, damping = J @ J.T, max(0.1 * damping, least)
        else:
            damping *= 4.0
    return y, float(np.linalg.norm(error))


def _constrained(own: Evaluate, kept: Evaluate, y: FloatArray, *, penalty: float) -> tuple[FloatArray, int]:
    """Minimise |e|^2 + mu |y|^2 where the errors that are kept stay zero: Levenberg-Marquardt in their null space.

    After each step the kept errors are put back; a step that cannot be, or that gains nothing, is damped more.
    """
    weight = np.sqrt(penalty)
    mu, accepted = 1e-3, 0
    error, J = own(y)
    value = float(error @ error + penalty * (y @ y))
    stall = PENALISED_STALL if penalty else STALL
    while accepted < MOST_ITERATIONS and mu < _MOST_DAMPING:
        N = _null_space(kept(y)[1])
        A = np.concatenate((J @ N, weight * N))
        b = np.concatenate((error, -weight * y))
        normal = A.T @ A
        unit = max(float(np.trace(normal)) / len(normal), 1e-12)
        step = N @ np.linalg.solve(normal + mu * unit * np.eye(len(normal)), A.T @ b)
        if float(np.linalg.norm(step)) <= stall * (1.0 + float(np.linalg.norm(y))):
            break
        tried = _restored(kept, y + step)
        if tried is not None:
            error_new, J_new = own(tried)
            value_new = float(error_new @ error_new + penalty * (tried @ tried))
            if value_new < (1.0 - STALL) * value:
                y, error, J, value = tried, error_new, J_new, value_new
                mu, accepted = max(0.2 * mu, 1e-9), accepted + 1
                continue
        mu *= 4.0
    return y, accepted


def _null_space(H: FloatArray) -> FloatArray:
    _, s, Vt = np.linalg.svd(H)
    rank = int(np.count_nonzero(s > _RANK * max(float(s[0]), 1e-300)))
    null: FloatArray = Vt[rank:].T
    return null


def _restored(kept: Evaluate, y: FloatArray) -> FloatArray | None:
    """Return the y nearby, by Newton steps of least norm, whose kept errors are zero; None where there is none."""
    for _ in range(_RESTORING_STEPS):
        error, H = kept(y)
        if float(np.linalg.norm(error)) < _KEPT:
            return y
        y = y + np.linalg.lstsq(H, error, rcond=_RANK)[0]
    return None
