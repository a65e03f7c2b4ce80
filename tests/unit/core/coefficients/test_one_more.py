"""A clip as one more motion of the database: their covariance, and what of the clip is its own all along."""

import numpy as np
import pytest
from strokes import TIMELINE, database, model_of, place, stroke

from motionedit.core.coefficients.edit import edit_by_coefficients
from motionedit.core.coefficients.goal_chains import GoalRequest
from motionedit.core.coefficients.methods import Likeliest
from motionedit.core.coefficients.one_more import change_of_alpha, with_one_more
from motionedit.core.coefficients.projection import project
from motionedit.core.kinematics import Effector, effector_positions, forward


@pytest.fixture(scope="module")
def model():
    motions, hits = database(6)
    return model_of(motions, TIMELINE, hits)


def difference(model, *, seed=0, all_along=0.0):
    """Return how a clip differs from the mean, shape (F, n): it comes and goes, beside what is there all along."""
    shape = model.mean_rows.shape
    now_and_then = 0.1 * np.random.default_rng(seed).normal(size=shape)
    return now_and_then - now_and_then.mean(axis=0) + all_along * np.ones(shape)


def covariance(model, V):
    """Return C V, for C has a row for every value of a motion."""
    E = model.components.components
    return E.T @ (model.components.explained_variance[:, None] * (E @ V))


def motions_of(model):
    return model.components.mean + model.components.coefficients @ model.components.components


def test_what_differs_now_and_then_makes_the_covariance_of_all_motions(model):
    d = difference(model)
    every = np.vstack((motions_of(model), model.components.mean + d.ravel()))
    X, V = every - every.mean(axis=0), np.random.default_rng(2).normal(size=(d.size, 8))
    np.testing.assert_allclose(covariance(with_one_more(model, d), V), X.T @ (X @ V) / (len(X) - 1), atol=1e-9)


def test_the_mean_over_time_counts_in_full_where_motions_of_the_database_differ_as_much(model):
    means = model.component_rows[0].mean(axis=0)
    spread = np.sqrt(model.components.explained_variance[0]) * np.broadcast_to(means, model.mean_rows.shape)
    own = with_one_more(model, spread).component_rows[-1]
    np.testing.assert_allclose(own, spread, atol=1e-12)


@pytest.mark.parametrize("times", [4.0, 40.0])
def test_what_no_motion_differs_by_all_along_is_the_clips_own(model, times):
    means = model.component_rows.mean(axis=1).reshape(len(model.component_rows), -1, 3)
    usual = np.sqrt((1.0 + 1.0 / 6.0) * np.einsum("m,mjk->j", model.components.explained_variance, means**2))
    stance = np.zeros((len(usual), 3))
    stance[:, 1] = times * usual
    d = difference(model) + stance.ravel()
    kept = with_one_more(model, d).component_rows[-1].mean(axis=0).reshape(-1, 3)
    np.testing.assert_allclose(kept, stance / times**2, atol=1e-12)
    # What comes and goes is all there.
    np.testing.assert_allclose(np.diff(with_one_more(model, d).component_rows[-1], axis=0), np.diff(d, axis=0))


def test_a_clip_that_is_the_mean_adds_nothing(model):
    joined = with_one_more(model, np.zeros_like(model.mean_rows))
    np.testing.assert_array_equal(joined.component_rows[-1], 0.0)


def test_a_change_moves_the_coefficients_that_the_model_knows(model):
    joined = with_one_more(model, difference(model) + model.component_rows[0])
    change = np.random.default_rng(1).normal(size=len(joined.component_rows))
    moved = change @ joined.components.components
    np.testing.assert_allclose(change_of_alpha(change, model, joined), model.components.components @ moved, atol=1e-12)
    np.testing.assert_array_equal(change_of_alpha(change[:-1], model, model), change[:-1])


def test_edits_to_where_another_motion_has_its_hand_end_nearer_to_it():
    motions, hits = database(4)
    model, frame, hand = model_of(motions, TIMELINE, hits), 36, Effector(22, np.zeros(3))
    squares = {True: 0.0, False: 0.0}
    for seed in range(20, 60):
        clip, other = stroke(seed), stroke(seed + 60)
        (ours, theirs), map_ = (place(each, TIMELINE, hit=36.0) for each in (clip, other)), np.arange(23)
        asked = project(clip, model, joint_map=map_, alignment=ours[0], warp=ours[1], first=0)
        there = theirs[0].apply(forward(other).positions)
        goal = ours[0].undo(theirs[0].apply(effector_positions(forward(other), hand)))[frame]
        request = GoalRequest(frame, hand, goal, None)
        for one_more in squares:
            solver = Likeliest(0.3, None, one_more=one_more)
            edit = edit_by_coefficients(asked, model, [request], solver=solver, residual="keep", first=0)
            squares[one_more] += float(np.sum((ours[0].apply(forward(edit.motion).positions) - there) ** 2))
    assert squares[True] < 0.95 * squares[False], squares
