"""The solver that a spec asks for, with its bound and its own idea of near enough, in a model's units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from motionedit.core.coefficients.methods import Damped, GaussNewton, Likeliest

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.planted_feet import PlantedFoot
    from motionedit.core.pca.model import MotionModel
    from motionedit.spec.edit_pc import EditPcSpec


# g over r^2, r being the share of an unseen clip that the database does not explain; and g's limits: a database that
# explains nearly all still needs room for its noise, and one that explains nothing still knows a style.
_OF_LEFT_OUT, _LEAST_SHARE, _MOST_SHARE = 0.85, 0.05, 0.3
# Goals at several frames may speak for more: what no way of the database's goes through is a local matter.
_MOST_OF_SEVERAL = 0.6
# A model that was made before its left-out error was kept: a share between that of clean sets and that of real strokes.
_UNKNOWN_SHARE = 0.25


def chosen_solver(
    spec: EditPcSpec, model: MotionModel, *, bound: float | None, feet: tuple[PlantedFoot, ...]
) -> Likeliest | GaussNewton | Damped:
    """Return the solver; `bound` is the largest norm, by `plausibility_bound`, `feet` as of `Likeliest`."""
    if spec.solver.method == "damped":
        return Damped(
            damping=spec.solver.damping,
            tolerance=spec.solver.tolerance,
            max_iterations=spec.solver.max_iterations,
            unit=_damping_unit(spec) * model.space.scale,
        )
    if spec.solver.method == "gauss-newton":
        return GaussNewton(bound)
    share, align = residual_share(spec, model), model.rules["align"]
    # Clips that all begin on both feet, side by side, are laid over each other by these, and stand there.
    astray = align["by"] == "hips"
    return Likeliest(
        share,
        bound,
        feet,
        believed=_believed(share),
        heading=astray and align["heading"],
        position=astray and align["position"],
        one_more=spec.residual == "keep",
        most=max(share, _MOST_OF_SEVERAL) if spec.residual_share == "auto" else None,
    )


def _believed(share: float) -> float:
    """Return how much of what components say far from a goal is believed: 1 - r^3, r as `residual_share` has it.

    A database that explains its clips well is believed nearly all along, also of the style far from the goal.
    """
    return 1.0 - math.sqrt(min(share / _OF_LEFT_OUT, 1.0)) ** 3


def residual_share(spec: EditPcSpec, model: MotionModel) -> float:
    """Return g, the share of a change's variance that may leave the components; `auto` is `_OF_LEFT_OUT` r^2.

    r of a motion is not what the database says; of a change from one to another r^2 is, of both its ends.
    """
    if not isinstance(spec.residual_share, str):
        return spec.residual_share
    left_out = model.components.left_out
    if left_out is None:
        return _UNKNOWN_SHARE
    return min(max(_OF_LEFT_OUT * left_out.share**2, _LEAST_SHARE), _MOST_SHARE)


def plausibility_bound(spec: EditPcSpec, model: MotionModel, coefficients: FloatArray, *, asked: int) -> float | None:
    """Return the largest norm that an edit may reach: of the change, or of where it leads, never below the input's own.

    None for no bound.

    Parameters
    ----------
    asked : int
        How many numbers goals ask for that are solved together.
    """
    factor = spec.plausibility_bound
    if factor is None:
        return None
    if spec.solver.method == "map":
        return factor * usual_change(model, asked=asked)
    return max(factor * largest_norm(model), float(model.mahalanobis(coefficients)))


def usual_change(model: MotionModel, *, asked: int) -> float:
    """Return the norm of the change that makes of a clip of the database another, as far as goals see them.

    In p numbers two draws differ by sqrt(2) chi_p standard deviations, the mean of which is sqrt(2 p) (1 - 1 / (4 p));
    a few clips know their own spread badly, and their standard deviations count as Student's t has it.
    """
    p, free = max(asked, 3), len(model.clips) - 1
    return math.sqrt(2.0 * p) * (1.0 - 0.25 / p) * free / max(free - 1.1, 0.15)


def largest_norm(model: MotionModel) -> float:
    """Return the largest Mahalanobis norm among the database's motions."""
    return float(model.mahalanobis(model.components.coefficients).max())


def solver_tolerance(spec: EditPcSpec) -> float:
    """Return what the solver calls near enough, clip units."""
    return spec.solver.tolerance * _damping_unit(spec) if spec.solver.method == "damped" else 0.0


def _damping_unit(spec: EditPcSpec) -> float:
    """Return the damping unit in clip units."""
    return spec.solver.damping_unit.metres / (spec.unit.metres if spec.unit is not None else 1.0)
