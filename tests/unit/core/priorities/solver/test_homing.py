"""The pull to the reference: a secant through two pulls ends what shrinks, or swings, by one factor."""

import numpy as np
import pytest

from motionedit.core.priorities.solver.homing import Memory, accelerated
from motionedit.core.priorities.solver.layers import Descent

SIZE = 9
PULL = np.random.default_rng(0).normal(size=(1, SIZE))
NOW = np.array([0])


def descent_of(home, *, tasks=None, Q=None, free=None):
    return Descent(
        np.zeros((1, SIZE)) if tasks is None else tasks,
        home,
        np.zeros((1, 0, SIZE)) if Q is None else Q,
        np.ones((1, SIZE), dtype=bool) if free is None else free,
        np.zeros((1, 0), dtype=int),
    )


def after(ratio, *, before=None, **now):
    """Return the pull that follows one of PULL, whose step was made in full, and left `ratio` of it."""
    memory = Memory.empty(1, SIZE)
    memory.keep(NOW, before or descent_of(PULL), PULL)
    return accelerated(memory, NOW, descent_of(ratio * PULL, **now))


@pytest.mark.parametrize("ratio", [-1.5, -0.6, 0.3, 0.6])
def test_a_pull_that_goes_on_by_a_factor_ends_at_once(ratio):
    # What is left adds up to ratio / (1 - ratio) of the first pull, however far it swings.
    np.testing.assert_allclose(after(ratio), ratio * PULL / (1.0 - ratio), rtol=1e-12)


def test_an_accelerated_pull_is_at_most_three_times_the_plain_one():
    np.testing.assert_allclose(after(0.9), 3.0 * 0.9 * PULL, rtol=1e-12)


def test_the_first_pull_is_as_it_is():
    home = accelerated(Memory.empty(1, SIZE), NOW, descent_of(PULL))
    np.testing.assert_array_equal(home, PULL)


def test_a_pull_beside_steps_for_the_tasks_is_as_it_is():
    np.testing.assert_array_equal(after(0.5, tasks=PULL), 0.5 * PULL)
    np.testing.assert_array_equal(after(0.5, before=descent_of(PULL, tasks=PULL)), 0.5 * PULL)


def test_hinges_that_reach_or_leave_a_limit_do_not_compare():
    free = np.ones((1, SIZE), dtype=bool)
    free[0, :3] = False
    np.testing.assert_array_equal(after(0.5, free=free), 0.5 * PULL)


def test_the_secant_stays_off_what_the_layers_see():
    row = np.zeros((1, 1, SIZE))
    row[0, 0, 4] = 1.0
    fast = after(-0.5, Q=row) - (-0.5) * PULL
    assert fast[0, 4] == 0.0
    assert np.abs(fast).max() > 0.1
