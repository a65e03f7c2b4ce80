"""J(alpha) of eq. (11) against central differences, for every kind of goal row."""

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import CoefficientChain, evaluate, exp_and_left_jacobian
from motionedit.core.coefficients.goals import Goal, stacked_errors
from motionedit.core.measure import Measure
from motionedit.core.units import METRES_PER_RADIAN

STEP = 1e-6
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0


def chain(seed, *, joints=5, unknowns=4, spread=0.8):
    rng = np.random.default_rng(seed)
    return CoefficientChain(
        base_rotation=rot.to_matrix(rot.normalize(rng.normal(size=4))),
        base_position=rng.normal(size=3),
        translations=rng.normal(size=(joints, 3)),
        references=rot.to_matrix(rot.normalize(rng.normal(size=(joints, 4)))),
        vectors=rng.normal(scale=spread, size=(joints, 3)),
        rows=rng.normal(size=(joints, 3, unknowns)),
        travel_rows=rng.normal(size=(3, unknowns)),
        offset=rng.normal(size=3),
    )


def differences(function, at):
    columns = [(function(at + STEP * e) - function(at - STEP * e)) / (2 * STEP) for e in np.eye(len(at))]
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("spread", [0.0, 1e-5, 0.8, 2.0])
def test_position_rows_are_the_derivative_of_the_position(spread):
    each = chain(1, spread=spread)
    at = np.random.default_rng(2).normal(scale=0.3 * (spread > 0), size=4)
    expected = differences(lambda x: evaluate(each, x).position, at)
    np.testing.assert_allclose(evaluate(each, at).position_rows, expected, atol=1e-7)


def test_rotation_rows_are_world_axis_increments():
    each, at = chain(3), np.random.default_rng(4).normal(size=4)
    R = evaluate(each, at).rotation

    def increment(x):
        return rot.log(rot.from_matrix(evaluate(each, x).rotation @ R.T))

    np.testing.assert_allclose(evaluate(each, at).rotation_rows, differences(increment, at), atol=1e-7)


@pytest.mark.parametrize("relative", [False, True])
def test_goal_rows_are_minus_the_derivative_of_the_error(relative):
    rng = np.random.default_rng(5)
    goal = Goal(
        chain=chain(6),
        position=rng.normal(size=3),
        rotation=None,
        weight=2.0,
        measure=Measure(rot.to_matrix(rot.normalize(rng.normal(size=4))), (0, 2)),
        base=chain(7) if relative else None,
    )
    at = rng.normal(size=4)
    expected = differences(lambda x: stacked_errors([goal], x)[0], at)
    np.testing.assert_allclose(stacked_errors([goal], at)[1], -expected, atol=1e-6)


@pytest.mark.parametrize("relative", [False, True])
def test_orientation_rows_are_minus_the_derivative_of_the_error_where_it_is_met(relative):
    each, other = chain(8), chain(9) if relative else None
    at = np.random.default_rng(10).normal(size=4)
    state = evaluate(each, at).rotation
    wanted = evaluate(other, at).rotation.T @ state if relative else state
    goal = Goal(each, None, wanted, 1.0, base=other)
    expected = differences(lambda x: stacked_errors([goal], x)[0], at) / METRES_PER_RADIAN
    np.testing.assert_allclose(stacked_errors([goal], at)[1] / METRES_PER_RADIAN, -expected, atol=1e-6)


def left_jacobian(v):
    """Return J_l at one rotation vector, as the chain has it."""
    return exp_and_left_jacobian(v[None])[1][0]


def test_the_chains_own_exp_is_that_of_the_rotations_module():
    v = np.concatenate((np.random.default_rng(11).normal(size=(20, 3)), [[0, 0, 0], [1e-6, 0, 0], [3.1, 0.2, 0.1]]))
    turns, _ = exp_and_left_jacobian(v)
    np.testing.assert_allclose(turns, rot.to_matrix(rot.exp(v)), atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 9.9e-5, 1.01e-4, 1.0, 3.1])
def test_the_left_jacobian_is_its_own_series(angle):
    V = rot.skew(angle * AXIS)
    term, series = np.eye(3), np.eye(3)
    for k in range(2, 40):
        term = term @ V / k
        series = series + term
    np.testing.assert_allclose(left_jacobian(angle * AXIS), series, atol=2e-12)


@pytest.mark.parametrize("angle", [1e-6, 0.5, 3.0])
def test_the_left_jacobian_agrees_with_central_differences(angle):
    v, h = angle * AXIS, 1e-6
    for a in range(3):
        dv = h * np.eye(3)[a]
        turn = rot.multiply(rot.exp(v + dv), rot.conjugate(rot.exp(v - dv)))
        np.testing.assert_allclose(rot.log(turn) / (2 * h), left_jacobian(v)[:, a], atol=1e-8)
