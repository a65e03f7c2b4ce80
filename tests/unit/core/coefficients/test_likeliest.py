"""The likeliest change, on goals that are points moved by a few unknowns."""

import numpy as np
import pytest

from motionedit.core.coefficients import solver
from motionedit.core.coefficients.chain import CoefficientChain
from motionedit.core.coefficients.goals import Goal
from motionedit.core.coefficients.likeliest import likeliest_change
from motionedit.core.coefficients.penalty_search import PenaltySearch


def arm(target, unknowns=6, seed=0, weight=1.0):
    """Return a goal for the end of two bones, each turned by the same unknowns."""
    rows = np.random.default_rng(seed).normal(size=(2, 3, unknowns))
    chain = CoefficientChain(
        base_rotation=np.eye(3),
        base_position=np.zeros(3),
        translations=np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0]]),
        references=np.tile(np.eye(3), (2, 1, 1)),
        vectors=np.array([[0.0, 0.1, 0.0], [0.0, 0.5, 0.2]]),
        rows=rows,
        travel_rows=np.zeros((3, unknowns)),
        offset=np.array([0.3, 0.0, 0.0]),
    )
    return Goal(chain, np.asarray(target, dtype=float), None, weight)


def error(goal, y):
    from motionedit.core.coefficients.goals import stacked_errors

    return np.linalg.norm(stacked_errors([goal], y)[0])


def test_a_goal_is_met_by_the_least_y():
    goal = arm([0.5, 0.2, -0.3])
    found = likeliest_change([[goal]], size=6, bound=None)
    assert found.reasons == ("converged",)
    assert error(goal, found.change) < 1e-5
    # No other solution nearby is smaller: y is in the range of J^T.
    from motionedit.core.coefficients.goals import stacked_errors

    _, J = stacked_errors([goal], found.change)
    across = found.change - np.linalg.lstsq(J.T, found.change, rcond=None)[0] @ J
    assert np.linalg.norm(across) < 0.05 * np.linalg.norm(found.change)


def test_a_bound_is_kept():
    goal = arm([0.5, 0.2, -0.3])
    free = np.linalg.norm(likeliest_change([[goal]], size=6, bound=None).change)
    found = likeliest_change([[goal]], size=6, bound=0.5 * free)
    assert found.reasons == ("bound",)
    assert np.linalg.norm(found.change) == pytest.approx(0.5 * free, rel=1e-3)


@pytest.mark.parametrize("bound", [None, 50.0])
def test_a_layer_below_takes_nothing_from_one_above(bound):
    above, below = arm([0.55, 0.1, -0.2]), arm([-0.4, 0.3, 0.2])
    found = likeliest_change([[above], [below]], size=6, bound=bound)
    assert error(above, found.change) < 1e-5
    assert found.reasons == ("converged", "gave way")
    # It is as near as the one above leaves it: nearer than without it, and stationary there.
    alone = likeliest_change([[above]], size=6, bound=bound)
    assert error(below, found.change) < error(below, alone.change) + 1e-9


def test_what_is_out_of_reach_is_as_near_as_can_be():
    found = likeliest_change([[arm([2.0, 0.0, 0.0])]], size=6, bound=None)
    assert found.reason != "converged"
    assert error(arm([2.0, 0.0, 0.0]), found.change) == pytest.approx(1.3, abs=1e-3)


def test_the_bound_is_used_up_where_the_search_for_the_penalty_stops_short(monkeypatch):
    # As if |y| jumped: the search ends with what it has, somewhat within the bound.
    class Short(PenaltySearch):
        def tried(self, norm, *, within):
            super().tried(norm, within=within)
            self.ended |= within and norm > 0.45

    monkeypatch.setattr(solver, "PenaltySearch", Short)
    found = likeliest_change([[arm([2.0, 0.0, 0.0])]], size=6, bound=0.5)
    assert np.linalg.norm(found.change) == pytest.approx(0.5, rel=1e-4)
