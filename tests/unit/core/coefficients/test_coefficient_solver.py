"""The solvers in coefficient space: Gauss-Newton with homing, the plausibility bound, Algorithm 1."""

from dataclasses import replace

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.coefficients.algorithm_1 import solve_damped
from motionedit.core.coefficients.chain import CoefficientChain, evaluate
from motionedit.core.coefficients.goals import Goal
from motionedit.core.coefficients.solver import BOUND_TOLERANCE, ERROR_STOP, solve_goals, step_metric
from motionedit.core.measure import Measure


def arm(seed=0, *, joints=6, unknowns=8, scale=0.3):
    """Return a bent arm of 0.15 m links that eight coefficients of falling influence move."""
    rng = np.random.default_rng(seed)
    return CoefficientChain(
        base_rotation=np.eye(3),
        base_position=np.zeros(3),
        translations=np.tile([0.0, 0.15, 0.0], (joints, 1)),
        references=rot.to_matrix(rot.exp(rng.normal(scale=0.4, size=(joints, 3)))),
        vectors=np.zeros((joints, 3)),
        rows=rng.normal(scale=scale, size=(joints, 3, unknowns)),
        travel_rows=rng.normal(scale=0.05, size=(3, unknowns)),
        offset=np.array([0.0, 0.15, 0.0]),
    )


VARIANCE = np.geomspace(4.0, 0.02, 8)


def goal_for(chain, shift, **changes):
    state = evaluate(chain, np.zeros(chain.rows.shape[2]))
    goal = Goal(chain, state.position + shift, None, 1.0)
    return replace(goal, **changes)


def solved(goals, *, start=None, bound=None):
    start = np.zeros(8) if start is None else start
    return solve_goals(goals, explained_variance=VARIANCE, start=start, bound=bound)


def left(goal, solution):
    return np.linalg.norm(goal.position - evaluate(goal.chain, solution.change).position)


@pytest.mark.parametrize("seed", range(6))
def test_a_near_goal_is_met_in_a_few_iterations(seed):
    goal = goal_for(arm(seed), 0.1 * rot.normalize(np.random.default_rng(seed).normal(size=3)))
    solution = solved([goal])
    assert left(goal, solution) < ERROR_STOP
    assert solution.iterations <= 12
    assert solution.reason == "converged"
    assert len(solution.history) == solution.iterations + 1


def test_a_goal_that_is_met_already_changes_nothing():
    solution = solved([goal_for(arm(), np.zeros(3))])
    np.testing.assert_array_equal(solution.change, np.zeros(8))
    assert solution.iterations == 0


def test_the_change_is_the_least_in_the_step_metric():
    chain = arm(1)
    goal = goal_for(chain, np.array([0.05, -0.03, 0.02]))
    solution = solved([goal])
    W = np.diag(step_metric(VARIANCE))
    J = evaluate(chain, solution.change).position_rows
    # At the least change, W beta is a combination of the goal's rows.
    coefficients, *_ = np.linalg.lstsq(J.T, W @ solution.change, rcond=None)
    np.testing.assert_allclose(J.T @ coefficients, W @ solution.change, atol=2e-2 * np.abs(solution.change).max())


def test_the_metric_spares_weak_components_but_does_not_forbid_the_strong_ones():
    metric = step_metric(np.array([100.0, 1.0, 0.01]))
    np.testing.assert_allclose(metric, [1.01, 2.0, 101.0])


def test_an_axis_alone_leaves_the_other_axes_free():
    goal = goal_for(arm(2), np.array([0.1, 9.0, 9.0]), measure=Measure(counted=(0,)))
    solution = solved([goal])
    assert abs(goal.position[0] - evaluate(goal.chain, solution.change).position[0]) < ERROR_STOP


def test_an_orientation_goal_is_met():
    chain = arm(3)
    now = evaluate(chain, np.zeros(8)).rotation
    wanted = rot.to_matrix(rot.exp(np.array([0.2, -0.1, 0.15]))) @ now
    solution = solved([Goal(chain, None, wanted, 1.0)])
    found = evaluate(chain, solution.change).rotation
    angle = float(rot.angle_between(rot.from_matrix(found), rot.from_matrix(wanted)))
    assert np.degrees(angle) < 0.01


def test_goals_that_contradict_each_other_split_by_the_square_of_their_weights():
    chain = arm(4)
    near, far = goal_for(chain, np.array([0.05, 0.0, 0.0])), goal_for(chain, np.array([-0.05, 0.0, 0.0]))
    solution = solved([replace(near, weight=10.0), far])
    assert left(near, solution) == pytest.approx(0.1 / 101, rel=1e-2)
    even = solved([near, far])
    assert left(near, even) == pytest.approx(0.05, rel=1e-3)


def test_a_goal_out_of_reach_ends_at_the_bound():
    goal = goal_for(arm(5), np.array([3.0, 0.0, 0.0]))
    bound = 4.0
    solution = solved([goal], bound=bound)
    norm = np.linalg.norm(solution.change / np.sqrt(VARIANCE))
    assert solution.reason == "bound"
    assert (1 - 2 * BOUND_TOLERANCE) * bound <= norm <= (1 + BOUND_TOLERANCE) * bound
    assert left(goal, solution) > 1.0


def test_inside_the_bound_nothing_comes_nearer_to_the_goal():
    goal = goal_for(arm(5), np.array([3.0, 0.0, 0.0]))
    solution = solved([goal], bound=3.0)
    here = left(goal, solution)
    rng = np.random.default_rng(0)
    z = solution.change / np.sqrt(VARIANCE)
    for _ in range(200):
        other = z + 0.02 * rng.normal(size=8)
        other *= 3.0 / np.linalg.norm(other)
        state = evaluate(goal.chain, other * np.sqrt(VARIANCE))
        assert np.linalg.norm(goal.position - state.position) > here - 1e-6


def test_the_bound_counts_from_the_mean_motion_not_from_the_input():
    goal = goal_for(arm(6), np.array([0.3, 0.1, 0.0]))
    start = np.sqrt(VARIANCE) * 1.5
    solution = solved([goal], start=start, bound=np.linalg.norm(start / np.sqrt(VARIANCE)))
    assert np.linalg.norm((start + solution.change) / np.sqrt(VARIANCE)) <= np.sqrt(8) * 1.5 * (1 + BOUND_TOLERANCE)


def test_a_goal_that_no_component_moves_is_left_as_it_is():
    chain = replace(arm(), rows=np.zeros((6, 3, 8)), travel_rows=np.zeros((3, 8)))
    solution = solved([goal_for(chain, np.array([0.1, 0.0, 0.0]))], bound=3.0)
    np.testing.assert_array_equal(solution.change, np.zeros(8))
    assert solution.reason != "converged"


def damped(goal, *, damping=10.0, tolerance=1.0, max_iterations=1500):
    return solve_damped([goal], size=8, damping=damping, tolerance=tolerance, max_iterations=max_iterations, unit=0.01)


def test_the_papers_algorithm_stops_within_a_centimetre():
    goal = goal_for(arm(7), np.array([0.08, 0.02, 0.0]))
    solution = damped(goal)
    assert solution.reason == "converged"
    assert left(goal, solution) < 0.01
    assert solution.history[0] == pytest.approx(np.hypot(0.08, 0.02))


def test_the_papers_iterations_grow_with_the_square_of_the_damping():
    goal = goal_for(arm(7), np.array([0.02, 0.0, 0.0]))
    few, many = damped(goal, damping=200.0).iterations, damped(goal, damping=800.0).iterations
    assert many / few == pytest.approx(16.0, rel=0.25)


def test_the_papers_algorithm_ends_at_its_cap_and_without_one_where_nothing_moves():
    goal = goal_for(replace(arm(8), travel_rows=np.zeros((3, 8))), np.array([9.0, 0.0, 0.0]))
    capped = damped(goal, max_iterations=20)
    assert (capped.iterations, capped.reason) == (20, "iterations")
    free = damped(goal, damping=1.0, max_iterations=None)
    assert free.reason == "stalled"
