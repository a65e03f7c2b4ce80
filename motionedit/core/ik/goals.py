"""Goals at one frame: error and Jacobian of a position, an orientation, or both, in the frame they are given in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.ik import METRES_PER_RADIAN
from motionedit.core.ik.chain import EffectorState, evaluate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.ik.chain import CoefficientChain


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


@dataclass(frozen=True, eq=False)
class GoalError:
    """Rows of one goal: `error` (k,) still to go, and `jacobian` (k, m); not weighted, rotations in radians."""

    position: FloatArray
    position_jacobian: FloatArray
    rotation: FloatArray
    rotation_jacobian: FloatArray


def goal_error(goal: Goal, unknowns: FloatArray) -> GoalError:
    """Return the goal's errors, e = g - x(Theta) of eq. (6), and their rows of J(alpha)."""
    state = evaluate(goal.chain, unknowns)
    if goal.relative_to is not None:
        state = _seen_from(evaluate(goal.relative_to, unknowns), state)
    count = state.position_rows.shape[1]
    e_p, J_p, e_r, J_r = np.zeros(0), np.zeros((0, count)), np.zeros(0), np.zeros((0, count))
    if goal.position is not None:
        axes = list(goal.axes)
        e_p = goal.position[axes] - goal.measure[axes] @ state.position
        J_p = goal.measure[axes] @ state.position_rows
    if goal.rotation is not None:
        e_r = rot.log(rot.from_matrix(goal.rotation @ state.rotation.T))
        J_r = state.rotation_rows
    return GoalError(e_p, J_p, e_r, J_r)


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
        each = goal_error(goal, unknowns)
        turn = goal.weight * METRES_PER_RADIAN
        errors += [goal.weight * each.position, turn * each.rotation]
        rows += [goal.weight * each.position_jacobian, turn * each.rotation_jacobian]
    return np.concatenate(errors), np.concatenate(rows)
