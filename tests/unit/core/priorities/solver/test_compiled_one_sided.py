"""The compiled solver beside numpy's where rows are one-sided: floors, distances and bounds, between other layers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from person import BODY, edited, end, held, held_feet, path, swaying
from random_bodies import (
    FEASIBLE,
    INFEASIBLE,
    assert_no_neighbour_changes_a_bit,
    body_of,
    by_numpy,
    constraints_of,
    difference,
    is_met,
    motion_of,
)

from motionedit.core.compiled import compiled, solver_name
from motionedit.core.measure import Level
from motionedit.core.priorities.edit import edit_by_priorities, prepare
from motionedit.core.priorities.kinds import Distance, Floor
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.core.priorities.trajectories.lengths import LengthPoint

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="no compiled solver here")

SETTING = LayeredSettings(smoothing=PaperFilter(0), max_iterations=12)
SEEDS = {"seed": st.integers(0, 2**32 - 1), "joints": st.integers(3, 16), "count": st.integers(0, 4)}
PATIENT = {"deadline": None, "suppress_health_check": [HealthCheck.function_scoped_fixture]}


def edit_of(seed, joints, count, reach, **how):
    rng = np.random.default_rng(seed)
    motion = motion_of(rng, joints)
    body = body_of(rng, motion)
    return edit_by_priorities(motion, constraints_of(rng, motion, reach, count), body, replace(SETTING, **how))


# The same examples on every run: where a body stands exactly stretched, a rounding decides how far the last step goes.
@given(**SEEDS, reach=st.sampled_from([0.02, 0.1]))
@settings(max_examples=80, derandomize=True, **PATIENT)
def test_both_solvers_keep_limits_alike(patch, seed, joints, count, reach):
    mine = edit_of(seed, joints, count, reach)
    theirs = by_numpy(patch, lambda: edit_of(seed, joints, count, reach))
    assert (mine.solver, theirs.solver) == ("compiled", "numpy")
    np.testing.assert_array_equal(mine.ranks, theirs.ranks)
    assert difference(mine, theirs) < (FEASIBLE if is_met(mine) else INFEASIBLE)
    if is_met(mine):
        np.testing.assert_array_equal(mine.iterations, theirs.iterations)


@given(**SEEDS)
@settings(max_examples=60, **PATIENT)
def test_rows_that_take_part_in_a_neighbour_alone_change_no_bit(patch, seed, joints, count):
    assert_no_neighbour_changes_a_bit(patch, lambda threads: edit_of(seed, joints, count, 0.1, threads=threads))


def person_of():
    """Return a swaying person whose hands come no nearer, over a floor that the lowered hips would go through."""
    motion = swaying(40)
    near = LengthPoint("hold", 0, 39, length=0.3, bound="at_least")
    hands = Distance(name="hands", effector=end("LeftHand"), to=end("RightHand"), priority=7, points=(near,))
    toes = (end("LeftToeBase"), end("RightToeBase"), end("LeftFoot"))
    level = Level(np.array([0.0, 1.0, 0.0]), path(motion, "LeftToeBase")[:, 1].min())
    floor = Floor(name="floor", effector=toes, height=level, priority=9)
    lowered = held("Hips", 40, (0.0, -0.3, 0.0), priority=5)
    return motion, [floor, hands, lowered, held("LeftHand", 40, (-0.5, 0.0, 0.0), priority=3)]


def test_limits_are_solved_by_the_compiled_part_and_smoothed_as_numpy_does(patch):
    motion, constraints = person_of()
    mine = edited(motion, constraints, LayeredSettings())
    theirs = by_numpy(patch, lambda: edited(motion, constraints, LayeredSettings()))
    assert (mine.solver, theirs.solver) == ("compiled", "numpy")
    assert difference(mine, theirs) < INFEASIBLE
    assert max(mine.errors[i].positions.max() for i in (0, 1)) < 1e-4
    assert np.abs(mine.motion.rotations - motion.rotations).max() > 0.1


def test_a_frame_at_rest_above_its_floor_stays_as_it_is_to_the_bit():
    motion = swaying(1)
    floor = Floor(name="floor", effector=(end("LeftToeBase"),), height=Level(np.array([0.0, 1.0, 0.0]), -1.0))
    edit = edited(motion, [floor, *held_feet(1, priority=8)])
    np.testing.assert_array_equal(edit.motion.rotations, motion.rotations)
    np.testing.assert_array_equal(edit.motion.translations, motion.translations)


@pytest.mark.parametrize(
    ("kind", "field", "value"), [("distance", "base", -1), ("distance", "rows", 3), ("distance", "width", 3)]
)
def test_a_distance_that_is_none_is_an_error_and_no_crash(kind, field, value):
    motion, constraints = person_of()
    (group,) = prepare(motion, constraints, BODY, SETTING)[0].groups
    count = len(motion)
    buffers = {name: array.copy() for name, array in group.prepared.layout.buffers.items()}
    (at,) = np.flatnonzero(buffers["tasks"]["kind"] == compiled().row_kinds.index(kind))
    buffers |= {
        "rotations": motion.rotations.copy(),
        "translations": motion.translations.copy(),
        "reference_rotations": motion.rotations,
        "reference_root": np.zeros(0),
        "softness": group.problem.softness,
        "iterations": np.zeros(count, int),
        "converged": np.zeros(count, bool),
        "ranks": np.zeros((count, len(group.problem.layers)), int),
        "left": np.zeros((count, len(group.problem.layers))),
        "frames": np.arange(count),
        "levels": group.levels,
    }
    compiled().solve(buffers, 0, count, False)
    buffers["tasks"][field][at] = value
    with pytest.raises(ValueError, match="tasks that are none"):
        compiled().solve(buffers, 0, count, False)
