"""Goals at one frame: error and Jacobian of a position, an orientation, or both, in the frame they are given in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import EffectorState, evaluate
from motionedit.core.measure import WORLD, Measure, relative_rows
from motionedit.core.units import METRES_PER_RADIAN
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.coefficients.chain import CoefficientChain


@dataclass(frozen=True, eq=False)
class Goal:
    """Where an effector is to be at one frame; lengths in normalised metres.

    Attributes
    ----------
    chain : CoefficientChain
        To the effector.
    position : shape (3,) or None
        In the measuring frame.
    rotation : shape (3, 3) or None
        As it is measured.
    weight : float
    measure : Measure
        What position and rotation are measured in.
    base : CoefficientChain or None
        To the measure's base, where it has one.
    """

    chain: CoefficientChain
    position: FloatArray | None
    rotation: FloatArray | None
    weight: float
    measure: Measure = WORLD
    base: CoefficientChain | None = None


def stacked_errors(goals: Sequence[Goal], unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return all goals' weighted errors, e = g - x(Theta) of eq. (6), shape (p,), and J(alpha), (p, m), in metres."""
    errors, rows = [], []
    for goal in goals:
        state, turn = _state(goal, unknowns), goal.weight * METRES_PER_RADIAN
        if goal.position is not None:
            e, J = _position_error(goal.position, goal, state)
            errors.append(goal.weight * e)
            rows.append(goal.weight * J)
        if goal.rotation is not None:
            e, J = _rotation_error(goal.rotation, state)
            errors.append(turn * e)
            rows.append(turn * J)
    return np.concatenate(errors), np.concatenate(rows)


def _state(goal: Goal, unknowns: FloatArray) -> EffectorState:
    state = evaluate(goal.chain, unknowns)
    return state if goal.base is None else _seen_from(evaluate(goal.base, unknowns), state)


def _position_error(position: FloatArray, goal: Goal, state: EffectorState) -> tuple[FloatArray, FloatArray]:
    rows = goal.measure.rows
    return position[list(goal.measure.counted)] - rows @ state.position, rows @ state.position_rows


def _rotation_error(rotation: FloatArray, state: EffectorState) -> tuple[FloatArray, FloatArray]:
    return rot.log(rot.from_matrix(rotation @ state.rotation.T)), state.rotation_rows


def _seen_from(base: EffectorState, state: EffectorState) -> EffectorState:
    """Return a state as measured in the base's frame: x = R_b^T (p - p_b), with its rows.

    The increment of the relative rotation is R_b^T (w - w_b).
    """
    inverse = base.rotation.T
    between = state.position - base.position
    return EffectorState(
        inverse @ between,
        inverse @ state.rotation,
        relative_rows(inverse, between, state.position_rows, base.position_rows, base.rotation_rows),
        inverse @ (state.rotation_rows - base.rotation_rows),
    )
