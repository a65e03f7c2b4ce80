"""Goals at one frame: error and Jacobian of a position, an orientation, or both, in the frame they are given in."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import EffectorState, evaluate
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
        World orientation; relative to the reference joint where there is one.
    measure : shape (3, 3)
        Rows are the axes positions are measured along; the identity for the world.
    axes : tuple of int
        Which of these axes count for the position.
    weight : float
    relative_to : CoefficientChain or None
        To the joint in whose frame position and orientation are measured.
    """

    chain: CoefficientChain
    position: FloatArray | None
    rotation: FloatArray | None
    measure: FloatArray
    axes: tuple[int, ...]
    weight: float
    relative_to: CoefficientChain | None

    @cached_property
    def measure_rows(self) -> FloatArray:
        """The axes that count, shape (k, 3)."""
        return self.measure[list(self.axes)]


@dataclass(frozen=True, eq=False)
class GoalError:
    """Rows of one goal: `error` (k,) still to go, and `jacobian` (k, m); not weighted, rotations in radians."""

    position: FloatArray
    position_jacobian: FloatArray
    rotation: FloatArray
    rotation_jacobian: FloatArray


def goal_error(goal: Goal, unknowns: FloatArray) -> GoalError:
    """Return the goal's errors, e = g - x(Theta) of eq. (6), and their rows of J(alpha)."""
    state = _state(goal, unknowns)
    nothing = np.zeros(0), np.zeros((0, state.position_rows.shape[1]))
    place = nothing if goal.position is None else _position_error(goal.position, goal, state)
    turn = nothing if goal.rotation is None else _rotation_error(goal.rotation, state)
    return GoalError(*place, *turn)


def _state(goal: Goal, unknowns: FloatArray) -> EffectorState:
    state = evaluate(goal.chain, unknowns)
    return state if goal.relative_to is None else _seen_from(evaluate(goal.relative_to, unknowns), state)


def _position_error(position: FloatArray, goal: Goal, state: EffectorState) -> tuple[FloatArray, FloatArray]:
    rows = goal.measure_rows
    return position[list(goal.axes)] - rows @ state.position, rows @ state.position_rows


def _rotation_error(rotation: FloatArray, state: EffectorState) -> tuple[FloatArray, FloatArray]:
    return rot.log(rot.from_matrix(rotation @ state.rotation.T)), state.rotation_rows


def _seen_from(reference: EffectorState, state: EffectorState) -> EffectorState:
    """Return a state as measured in the reference's frame: x = R_b^T (p - p_b), with its rows.

    dx = R_b^T (dp - dp_b - w_b x (p - p_b)); the increment of the relative rotation is R_b^T (w - w_b).
    """
    inverse = reference.rotation.T
    between = state.position - reference.position
    return EffectorState(
        inverse @ between,
        inverse @ state.rotation,
        inverse @ (state.position_rows - reference.position_rows + rot.skew(between) @ reference.rotation_rows),
        inverse @ (state.rotation_rows - reference.rotation_rows),
    )


def stacked_errors(goals: Sequence[Goal], unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return all goals' weighted errors, shape (p,), and J(alpha), shape (p, m), in metres."""
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
