"""The share of a change that goals at several frames speak for."""

import numpy as np
import pytest

from motionedit.core.coefficients.evidence import likeliest_share

SHARE, MOST = 0.1, 0.6


def share_of(asked, *, most=MOST):
    """Return g of asked numbers (8,): components move the first two, a residual all of them."""
    components, residual = np.eye(8)[:, :2] * np.sqrt(1.0 - SHARE), np.eye(8) * np.sqrt(SHARE)
    jacobian = np.concatenate((4.0 * components, residual), axis=1)
    return likeliest_share(np.asarray(asked, dtype=float), jacobian, components=2, share=SHARE, most=most)


def test_goals_that_the_components_go_through_leave_the_share_as_the_database_has_it():
    assert share_of([0.1, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]) == SHARE
    drawn = np.random.default_rng(1).normal(size=(40, 8))
    drawn *= np.sqrt(SHARE + (1.0 - SHARE) * np.array([16.0, 16.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert np.mean([share_of(asked) for asked in drawn]) < 2.0 * SHARE


def test_goals_that_the_components_do_not_go_through_speak_for_more():
    assert share_of([0.1, 0.1, 0.2, -0.2, 0.2, 0.2, -0.1, 0.2]) == MOST
    assert SHARE < share_of([0.4, -0.5, 0.1, 0.1, -0.1, 0.1, 0.1, 0.1]) < MOST


@pytest.mark.parametrize("factor", [1e-3, 30.0, -1.0])
def test_the_share_depends_on_the_kind_of_change_and_not_on_its_size(factor):
    asked = np.array([0.4, -0.5, 0.1, 0.1, -0.1, 0.1, 0.1, 0.1])
    assert share_of(factor * asked) == share_of(asked)


def test_nothing_asked_for_and_nothing_allowed_say_nothing():
    assert share_of(np.zeros(8)) == SHARE
    assert share_of(np.ones(8), most=SHARE) == SHARE
    assert likeliest_share(np.ones(2), np.zeros((2, 5)), components=2, share=SHARE, most=MOST) == SHARE
