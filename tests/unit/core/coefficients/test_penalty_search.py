"""The penalty search against norms whose answer is known."""

import numpy as np
import pytest

from motionedit.core.coefficients.penalty_search import PenaltySearch


def tries(norm_at, *, bound, tolerance=1e-4):
    """Return the penalties tried until a norm is inside the bound and within a tolerance of it."""
    search, tried = PenaltySearch((1.0 - 0.5 * tolerance) * bound), []
    while not search.ended:
        norm = norm_at(search.penalty)
        tried.append(search.penalty)
        if (1.0 - tolerance) * bound <= norm <= bound:
            break
        search.tried(norm, within=norm <= bound)
    return tried


@pytest.mark.parametrize("bound", [0.02, 0.3, 0.999])
def test_a_smooth_norm_meets_its_bound_in_a_few_tries(bound):
    tried = tries(lambda penalty: 1.0 / (1.0 + penalty), bound=bound)
    assert 1.0 / (1.0 + tried[-1]) == pytest.approx(bound, rel=1e-4)
    assert len(tried) <= 12


def test_a_penalty_that_is_too_small_at_first_is_raised():
    tried = tries(lambda penalty: 1e5 / penalty, bound=1.0)
    assert tried[-1] == pytest.approx(1e5, rel=2e-4)


def test_where_the_norm_jumps_over_the_bound_the_search_ends_beside_the_jump():
    tried = tries(lambda penalty: 9.0 if penalty < 0.123 else 0.5, bound=1.0)
    assert tried[-1] == pytest.approx(0.123, rel=1e-5)
    assert len(tried) <= 40


def test_a_norm_that_stays_inside_ends_the_search():
    tried = tries(lambda penalty: 0.5 - 0.4 * np.tanh(penalty), bound=1.0)
    assert min(tried) < 1e-11


def test_a_norm_of_zero_is_inside():
    tried = tries(lambda penalty: max(1.0 - penalty, 0.0), bound=0.5)
    assert 1.0 - tried[-1] == pytest.approx(0.5, rel=1e-4)
