"""The solver that a spec asks for, with its bound and its own idea of near enough, in a model's units."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.coefficients.edit import Damped, GaussNewton

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.pca.model import MotionModel
    from motionedit.spec.edit_pc import EditPcSpec


def chosen_solver(spec: EditPcSpec, model: MotionModel, *, bound: float | None) -> GaussNewton | Damped:
    """Return the solver; `bound` is the largest Mahalanobis norm, by `plausibility_bound`."""
    if spec.solver.method == "damped":
        return Damped(
            damping=spec.solver.damping,
            tolerance=spec.solver.tolerance,
            max_iterations=spec.solver.max_iterations,
            unit=_damping_unit(spec) * model.space.scale,
        )
    return GaussNewton(bound)


def plausibility_bound(spec: EditPcSpec, model: MotionModel, coefficients: FloatArray) -> float | None:
    """Return the largest Mahalanobis norm that an edit may reach, never below the input's own; None for no bound."""
    factor = spec.plausibility_bound
    return None if factor is None else max(factor * largest_norm(model), float(model.mahalanobis(coefficients)))


def largest_norm(model: MotionModel) -> float:
    """Return the largest Mahalanobis norm among the database's motions."""
    return float(model.mahalanobis(model.components.coefficients).max())


def solver_tolerance(spec: EditPcSpec) -> float:
    """Return what the solver calls near enough, clip units."""
    return spec.solver.tolerance * _damping_unit(spec) if spec.solver.method == "damped" else 0.0


def _damping_unit(spec: EditPcSpec) -> float:
    """Return the damping unit in clip units."""
    return spec.solver.damping_unit.metres / (spec.unit.metres if spec.unit is not None else 1.0)
