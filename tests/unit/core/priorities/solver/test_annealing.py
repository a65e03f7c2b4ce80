"""Iterations come to their end where what is missed stays as it is, and not before."""

import numpy as np
import pytest
from person import HARD, edited, held, held_feet, swaying

from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.solver.annealing import Annealing
from motionedit.core.priorities.solver.constants import ANNEALED_ITERATIONS, HASTY_ITERATIONS, STALE_ITERATIONS

MOST = 40
LAST = MOST - ANNEALED_ITERATIONS
EARLY = HASTY_ITERATIONS + STALE_ITERATIONS - 1


def first_annealed(errors, softness=(0.0, 0.0), *, top=0.0, ends_early=True):
    """Return the first iteration whose factor is not 1 where errors(iteration) are left of two layers below the first.

    Of that one `top` ** iteration is left.
    """
    annealing = Annealing(1, 3, MOST, ends_early=ends_early)
    soft, frame = np.array([[0.0, *softness]]), np.array([0])
    factors = [annealing.factors(frame, np.array([[top**i, *errors(i)]]), soft, i)[0] for i in range(MOST)]
    first = next(i for i, each in enumerate(factors) if each < 1.0)
    np.testing.assert_array_equal(factors[first : first + 4], [4.0**-1, 4.0**-2, 4.0**-3, 4.0**-4])
    return first


@pytest.mark.parametrize(
    ("errors", "first"),
    [
        (lambda _: (0.0, 0.5), EARLY),
        (lambda i: (0.0, 0.97**i), LAST),
        (lambda i: (0.0, 1.03**i), LAST),
        (lambda i: (0.0, 0.97 ** min(i, 20)), 20 + STALE_ITERATIONS),
        # The most important one decides.
        (lambda i: (0.5, 0.97**i), EARLY),
        (lambda i: (0.97**i, 0.5), LAST),
        # What is nearly met is gone on with, and what is met needs no end.
        (lambda _: (0.0, 0.04), LAST),
        (lambda _: (0.04, 0.5), LAST),
        (lambda _: (0.0, 0.0), LAST),
    ],
)
def test_a_frame_is_annealed_once_what_it_misses_stays_so(errors, first):
    assert first_annealed(errors) == first


def test_layers_that_give_way_need_not_be_met():
    assert first_annealed(lambda _: (0.0, 0.5), (0.0, 0.01)) == EARLY
    assert first_annealed(lambda _: (0.0, 0.04), (0.0, 0.01)) == EARLY
    assert first_annealed(lambda i: (0.0, 0.97**i), (0.0, 0.01)) == LAST
    assert first_annealed(lambda i: (0.5, 0.97**i), (0.01, 0.0)) == LAST


def test_what_gives_way_is_over_once_it_is_annealed():
    annealing, frames = Annealing(2, 1, MOST, ends_early=True), np.arange(2)
    soft = np.array([[0.01], [0.0]])
    over = []
    for i in range(MOST):
        annealing.factors(frames, np.full((2, 1), 0.5), soft, i)
        over.append(annealing.are_over(frames, soft, i))
    assert np.flatnonzero(np.array(over)[:, 0])[0] == EARLY + ANNEALED_ITERATIONS - 1
    assert not np.array(over)[:, 1].any()


def test_the_first_layer_is_not_waited_for_but_may_be_out_of_reach_itself():
    assert first_annealed(lambda _: (0.5, 0.0), top=0.9) == EARLY
    assert first_annealed(lambda _: (0.0, 0.0), top=0.9) == LAST
    assert first_annealed(lambda i: (0.97**i, 0.0), top=1.0) == EARLY


def test_with_limits_and_as_the_paper_has_it_nothing_ends_early():
    assert first_annealed(lambda _: (0.0, 0.5), ends_early=False) == LAST


def test_what_is_out_of_reach_ends_early_and_leaves_what_is_above_it_exact():
    motion, soon = swaying(8), LayeredSettings(smoothing=Passes(0))
    reached, far = (
        edited(motion, [*held_feet(8), held("RightHand", 8, shift, priority=2)], soon)
        for shift in ((0.1, 0.1, 0.1), (0.0, 2.0, 1.0))
    )
    assert far.converged.all()
    assert far.iterations.max() < LAST
    assert max(each.positions.max() for each in far.errors[:-1]) < 1e-6
    assert reached.errors[-1].positions.max() < 1e-6


def test_as_the_paper_has_it_what_is_out_of_reach_is_gone_to_as_far_as_any_step_leads():
    asked = [*held_feet(8), held("RightHand", 8, (0.0, 2.0, 1.0), priority=2)]
    hard, soon = (edited(swaying(8), asked, each) for each in (HARD, LayeredSettings(smoothing=Passes(0))))
    assert hard.iterations.min() > soon.iterations.max()
    assert hard.errors[-1].positions.max() < soon.errors[-1].positions.min() - 1e-3


def test_goals_in_conflict_are_gone_to_however_far_off_they_are():
    hands = [held("RightHand", 8, (0.0, high, 4.0)) for high in (0.0, 0.3)]
    left = [each.positions.max() for each in edited(swaying(8), hands, LayeredSettings()).errors]
    assert max(left) < 0.21
    assert sum(left) < 0.4
