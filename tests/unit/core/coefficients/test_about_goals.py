"""Components about goals: laid over each other there on the ground, weaker far from them."""

import numpy as np
import pytest
from strokes import TIMELINE, database, model_of

from motionedit.core import rotations as rot
from motionedit.core.coefficients.about_goals import components_about

GOAL = 36
# A small change along a component: what is left of second order is its square.
STEP = 1e-5


@pytest.fixture(scope="module")
def model():
    motions, hits = database(6)
    return model_of(motions, TIMELINE, hits)


def travel(model, rows):
    """Return the travel (F, 3) of rows, and the quaternions (F, 4) of its joint."""
    return rows[:, :3], rot.multiply(model.space.references[0], rot.exp(rows[:, 3:6]))


def test_at_the_goal_no_component_turns_or_moves_the_body_on_the_ground(model):
    about = components_about(model, np.array([float(GOAL)]), believed=1.0, heading=True, position=True)
    _, q0 = travel(model, model.mean_rows)
    for before, after in zip(model.component_rows, about.component_rows, strict=True):
        p, q = travel(model, model.mean_rows + STEP * after)
        turn = rot.log(rot.multiply(q[GOAL], rot.conjugate(q0[GOAL]))) @ model.up / STEP
        assert abs(turn) < 1e-4
        assert np.abs((p - model.mean_rows[:, :3])[GOAL][[0, 2]]).max() < 1e-12
        assert np.abs(before - after).max() > 1e-3
        # The body is where it was in itself: joints and heights are untouched.
        np.testing.assert_array_equal(after[:, 6:], before[:, 6:])
        np.testing.assert_allclose(after[:, 1], before[:, 1], atol=1e-12)


def test_a_clip_is_moved_as_a_whole(model):
    about = components_about(model, np.array([float(GOAL)]), believed=1.0, heading=True, position=True)
    for before, after in zip(model.component_rows, about.component_rows, strict=True):
        (p, q), (p_moved, q_moved) = (travel(model, model.mean_rows + STEP * E) for E in (before, after))
        steps, moved = (rot.rotate(rot.conjugate(r[:-1]), np.diff(x, axis=0)) for r, x in ((q, p), (q_moved, p_moved)))
        np.testing.assert_allclose(moved, steps, atol=20.0 * STEP**2)


def test_far_from_all_goals_as_much_is_believed_as_is_said(model):
    goals = np.array([5.0, 15.0])
    about = components_about(model, goals, believed=0.4, heading=False, position=False)
    weights = np.linalg.norm(about.component_rows[0], axis=1) / np.linalg.norm(model.component_rows[0], axis=1)
    np.testing.assert_allclose(weights[[5, 15]], 1.0)
    assert weights[-1] == pytest.approx(0.4, abs=0.02)
    assert np.all(np.diff(weights[15:]) < 0.0)


def test_all_of_a_model_is_believed_where_nothing_is_said_against_it(model):
    about = components_about(model, np.array([10.0]), believed=1.0, heading=False, position=False)
    np.testing.assert_array_equal(about.component_rows, model.component_rows)
