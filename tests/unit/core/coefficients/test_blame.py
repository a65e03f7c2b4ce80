"""Which goals a missed one gave way to, on points that three unknowns each move along the axes."""

import numpy as np

from motionedit.core.coefficients.blame import rivals_of
from motionedit.core.coefficients.chain import CoefficientChain
from motionedit.core.coefficients.goals import Goal
from motionedit.core.coefficients.likeliest import likeliest_change

SIZE = 12
THERE, ELSEWHERE = [0.6, 0.0, 0.0], [-0.2, 0.3, 0.1]


def point(which, target):
    """Return a goal for the first point, 0, to the fourth."""
    rows = np.zeros((3, SIZE))
    rows[:, 3 * which : 3 * which + 3] = np.eye(3)
    chain = CoefficientChain(
        base_rotation=np.eye(3),
        base_position=np.zeros(3),
        translations=np.zeros((1, 3)),
        references=np.eye(3)[None],
        vectors=np.zeros((1, 3)),
        rows=np.zeros((1, 3, SIZE)),
        travel_rows=rows,
        offset=np.zeros(3),
    )
    return Goal(chain, np.array(target), None, 1.0)


def blamed(*layers, bound=None):
    found = likeliest_change(layers, size=SIZE, bound=bound)
    return rivals_of(layers, found, size=SIZE, bound=bound)


def test_goals_that_are_all_met_give_way_to_none():
    assert blamed([point(0, THERE)], [point(1, ELSEWHERE)]) == {}


def test_a_goal_gives_way_to_the_one_that_is_in_its_way_and_not_to_others_above():
    assert blamed([point(0, THERE)], [point(1, THERE)], [point(0, ELSEWHERE)]) == {2: (0,)}


def test_two_goals_of_one_layer_that_contradict_each_other_are_each_others():
    assert blamed([point(0, THERE), point(1, THERE), point(0, ELSEWHERE)]) == {0: (2,), 2: (0,)}


def test_what_is_out_of_reach_by_itself_gives_way_to_none():
    assert blamed([point(0, THERE)], [point(1, [0.0, 2.0, 0.0])], bound=1.0) == {}


def test_two_that_are_each_in_the_way_are_both_named():
    assert blamed([point(0, THERE)], [point(0, THERE)], [point(0, ELSEWHERE)]) == {2: (0, 1)}


def test_where_a_bound_is_long_enough_for_any_two_those_are_named_without_which_all_are_met():
    layers = [point(0, THERE)], [point(1, THERE)], [point(2, THERE)]
    assert blamed(*layers, bound=1.0) == {2: (0, 1)}


def test_where_no_one_alone_makes_room_all_are_named():
    layers = [[point(which, [0.45, 0.0, 0.0])] for which in range(3)]
    assert blamed(*layers, [point(3, [0.8, 0.0, 0.0])], bound=1.0) == {3: (0, 1, 2)}
