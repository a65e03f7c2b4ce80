"""Which constraints a missed one gave way to, and how seldom that takes a solve."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, edited, end, held, swaying

from motionedit.core.priorities import blame
from motionedit.core.priorities.blame import Blames
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 30
MOTION = swaying(FRAMES)
FRAME = 15


def reach(shift, *, priority=5, name="LeftHand"):
    point = ControlPoint("during", 10, 20, None, np.array(shift))
    return Position(name="reach", priority=priority, effector=end(name), points=(point,), ease_in=5, ease_out=5)


def blames_of(constraints):
    return Blames(edited(MOTION, constraints).asked)


@pytest.fixture
def solves(monkeypatch):
    """Return a list that grows with each frame that is solved again."""
    found, real = [], blame.solve_frames

    def counted(*args, **more):
        found.append(args)
        return real(*args, **more)

    monkeypatch.setattr(blame, "solve_frames", counted)
    return found


@pytest.mark.parametrize("others", [3, 30])
def test_the_one_that_stands_in_the_way_is_found_among_many(others, solves):
    away = [held("RightHand", FRAMES, (0.0, 0.0, 0.0), priority=9)] * others
    blames = blames_of([*away, held("LeftHand", FRAMES, (0.0, 0.0, 0.0), priority=9), reach([0.0, 0.2, 0.0])])
    assert blames.of(others + 1, FRAME).by == (others,)
    assert len(solves) <= 15


def test_of_one_frame_what_constraints_leave_of_each_other_is_solved_once(solves):
    count = 8
    blames = blames_of([reach([0.02 * n, 0.1, 0.0]) for n in range(count)])
    for i in range(count):
        blames.of(i, FRAME)
    # With all, alone, and without each.
    assert len(solves) <= 1 + 2 * count


def test_those_that_stand_in_the_way_together_are_all_to_blame():
    twice = [held("LeftHand", FRAMES, (0.0, 0.0, 0.0), priority=9)] * 2
    assert blames_of([*twice, reach([0.0, 0.2, 0.0])]).of(2, FRAME).by == (0, 1)


def test_nobody_is_to_blame_for_what_is_out_of_reach():
    far = reach([0.0, 9.0, 0.0])
    assert blames_of([held("RightHand", FRAMES, (0.0, 0.0, 0.0), priority=2), far]).of(1, FRAME).by == ()


@pytest.mark.parametrize("rest", [1, 3])
def test_who_is_to_blame_is_found_behind_a_rest_pose_of_any_length(rest):
    held_hand = held("LeftHand", FRAMES, (0.0, 0.0, 0.0), priority=9)
    edit = edited(MOTION, [held_hand, reach([0.0, 0.2, 0.0])], body=replace(BODY, first=rest))
    assert Blames(edit.asked).of(1, FRAME).by == (0,)
