"""Rows of one side: which take part in an iteration, and that no step violates those that do not."""

import numpy as np
import pytest
from person import UP, edited, end, path, swaying

from motionedit.core.compiled import CHOICE
from motionedit.core.measure import Level
from motionedit.core.priorities.kinds import Floor
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.solver import numpy_step
from motionedit.core.priorities.solver.layers import Descent
from motionedit.core.priorities.solver.one_sided import Evaluated, Rows, Sides

E = np.array([[-1.0, 0.2, -0.5, -2.0], [-1.0, -0.2, -0.5, -2.0]])
J = np.broadcast_to(np.eye(4), (2, 4, 4))
SIDED = np.array([False, True, True, True])


@pytest.fixture
def rows():
    return Rows([Evaluated(E, J, SIDED), Evaluated(E[:, :1], J[:, :1], np.array([False]))])


def test_at_first_only_rows_of_two_sides_take_part(rows):
    assert [e.shape[1] for e, _ in rows.taking_part(slice(None))] == [1, 1]


def test_the_row_that_a_step_violates_most_is_taken_in_and_the_last_time_all(rows):
    step = np.array([[0.0, 0.0, -1.0, -1.0], [0.0, 0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(rows.take_in(step, left=1), [True, False])
    np.testing.assert_array_equal(rows.active, [[False, True, False], [False, False, False]])
    np.testing.assert_array_equal(rows.take_in(step, left=0), [True, False])
    np.testing.assert_array_equal(rows.active, [[True, True, False], [False, False, False]])
    assert not rows.take_in(step, left=0).any()


def test_a_row_that_a_step_meets_anyway_does_not_take_part_though_it_is_violated_now(rows):
    assert not rows.take_in(np.array([[0.0, 0.3, 0.0, 0.0]] * 2), left=0).any()


def test_rows_that_take_part_stand_with_those_of_their_layer_and_zeros_fill_up(rows):
    rows.take_in(np.array([[0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, 0.0]]), left=0)
    (e, A), _ = rows.taking_part(slice(None))
    np.testing.assert_array_equal(e, [[-1.0, 0.2, -0.5], [-1.0, 0.0, 0.0]])
    np.testing.assert_array_equal(A[0], np.eye(4)[:3])
    np.testing.assert_array_equal(A[1, 1:], 0.0)


def test_what_is_left_of_a_row_of_one_side_is_what_it_lacks():
    np.testing.assert_array_equal(Evaluated(E, J, SIDED).left, [[-1.0, 0.2, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0]])


def test_frames_are_told_apart_in_which_other_rows_take_part_than_before():
    sides = Sides(3)
    np.testing.assert_array_equal(sides.unchanged(np.arange(3), np.array([[True], [False], [True]])), [0, 1, 0])
    np.testing.assert_array_equal(sides.unchanged(np.array([0, 2]), np.array([[True], [False]])), [1, 0])


def test_a_descent_takes_frames_of_one_that_has_more_rows_or_fewer():
    def descent(rows, value):
        n = np.full((2, 3), float(value))
        return Descent(n, n.copy(), np.full((2, rows, 3), float(value)), n > 0.0, np.full((2, 1), rows))

    for few, many in ((1, 2), (2, 1)):
        one = descent(few, 1)
        one.replace_rows(np.array([1]), Descent(*(part[:1] for part in vars(descent(many, 2)).values())))
        np.testing.assert_array_equal(one.Q[1, :many], 2.0)
        np.testing.assert_array_equal(one.Q[1, many:], 0.0)
        np.testing.assert_array_equal(one.Q[0, :few], 1.0)
        np.testing.assert_array_equal(one.Q[0, few:], 0.0)
        np.testing.assert_array_equal(one.tasks, [[1.0] * 3, [2.0] * 3])


@pytest.fixture
def shifted_root(monkeypatch):
    """Return a setter of what the secant adds to the root's shift along an axis, in every iteration."""

    def shift(axis, way):
        def wild(memory, frames, descent):
            del memory, frames
            home = descent.home.copy()
            # In the only iteration the gain of the pull is annealed to this share.
            home[:, axis - 3] += way * 2.0**10
            return home

        monkeypatch.setenv(CHOICE, "numpy")
        monkeypatch.setattr(numpy_step, "accelerated", wild)

    return shift


def root_after(height):
    """Return how far the root is moved by a floor so far under the right hand, shape (1, 3)."""
    motion = swaying(1)
    level = Level(UP, path(motion, "RightHand")[:, 1].min() - height)
    floor = Floor(name="floor", effector=(end("RightHand"),), height=level)
    once = LayeredSettings(smoothing=Passes(0), max_iterations=1)
    return edited(motion, [floor], once).motion.translations[:, 0] - motion.translations[:, 0]


def test_an_accelerated_step_that_would_violate_a_row_is_not_taken(shifted_root):
    shifted_root(1, -0.1)
    np.testing.assert_array_equal(root_after(0.05), 0.0)
    np.testing.assert_allclose(root_after(0.2), [[0.0, -0.1, 0.0]])


def test_a_step_is_not_accelerated_where_a_row_has_just_been_taken_in(shifted_root):
    shifted_root(0, 0.1)
    assert np.abs(root_after(-0.01)[:, 0]).max() < 0.01
    np.testing.assert_allclose(root_after(0.2)[:, 0], 0.1)
