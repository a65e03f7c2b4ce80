"""Many constraints of a layer that ask for the same task: one task toward the mean of their targets."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, HARD, edited, end, held, path, swaying

from motionedit.core.measure import Measure
from motionedit.core.priorities import as_one
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.frames import solve_from_input
from motionedit.core.priorities.groups import groups_of
from motionedit.core.priorities.settings import LayeredSettings

FRAMES = 10
MOTION = swaying(FRAMES)
SEED = np.random.default_rng(3)
SHIFTS = SEED.normal(0.0, 0.05, (12, 3))
WEIGHTS = SEED.uniform(0.5, 3.0, 12)
MEAN = (WEIGHTS**2) @ SHIFTS / (WEIGHTS**2).sum()


def holds(count=12, name="RightHand"):
    return [
        held(name, FRAMES, shift, weight=weight) for shift, weight in zip(SHIFTS[:count], WEIGHTS[:count], strict=True)
    ]


def run_of(constraints):
    return prepare(MOTION, constraints, BODY, HARD)[0]


def tasks_of(constraints):
    return groups_of(run_of(constraints).asked)[0].members[0]


@pytest.mark.parametrize(("count", "tasks"), [(8, 8), (9, 1), (12, 1)])
def test_few_are_a_task_each_and_many_are_one(count, tasks):
    assert len(tasks_of(holds(count))) == tasks


def test_only_those_that_are_the_same_are_one():
    several = holds()
    other = replace(several[0], measure=Measure(counted=(0, 1)))
    off = replace(several[0], effector=end("RightHand", (0.0, 0.0, 0.1)))
    left = held("LeftHand", FRAMES)
    assert tasks_of([*several, other, off, left]) == (tuple(range(12)), (12,), (13,), (14,))


def test_the_point_is_at_the_mean_by_the_squares_of_weights_and_each_has_its_own_error():
    edit = edited(MOTION, holds(), HARD)
    place = path(MOTION, "RightHand")[0] + MEAN
    np.testing.assert_allclose(path(edit.motion, "RightHand"), np.tile(place, (FRAMES, 1)), atol=1e-5)
    for shift, errors in zip(SHIFTS, edit.errors, strict=True):
        np.testing.assert_allclose(errors.positions, np.linalg.norm(shift - MEAN), atol=1e-5)


@pytest.mark.parametrize("settings", [HARD, LayeredSettings()])
def test_it_is_where_all_of_them_would_have_the_point(settings, monkeypatch):
    one = edited(MOTION, holds(), settings)
    monkeypatch.setattr(as_one, "_FEW", 12)
    each = edited(MOTION, holds(), settings)
    assert np.abs(path(one.motion, "RightHand") - path(each.motion, "RightHand")).max() < 1e-3


def test_what_is_left_of_the_one_is_not_less_than_what_is_left_of_any():
    run = run_of(holds())
    left = solve_from_input(run).left[:, 0]
    assert (left >= np.abs(SHIFTS - MEAN).max() - 1e-6).all()
    new = run.aimed_at(tuple(replace(each, positions=2.0 * each.positions) for each in run.asked.targets))
    assert new.groups[0].problem.layers[0][0].apart.min() > 1.5 * run.groups[0].problem.layers[0][0].apart.max()
