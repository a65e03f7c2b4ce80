"""What comes to the compiled part from Python and makes no sense is an error, and no crash."""

from dataclasses import replace

import numpy as np
import pytest
from arms import arms_of, solved

from motionedit.core.compiled import compiled, solver_name
from motionedit.core.priorities.solver.layered import prepare_problem

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="no compiled solver here")


def test_buffers_of_a_wrong_size_are_an_error_and_no_crash():
    empty = np.zeros(0)
    with pytest.raises(ValueError, match="settings has 0 bytes"):
        compiled().solve({"settings": empty}, 0, 0, False)
    with pytest.raises(ValueError, match="settings is missing"):
        compiled().solve({}, 0, 0, False)
    with pytest.raises(ValueError, match="places has 0 bytes"):
        compiled().forward(np.array([-1]), empty, empty, empty, empty, empty, empty, 1)
    with pytest.raises(ValueError, match="rotations after"):
        compiled().smooth(np.zeros(4), empty, np.zeros(3), np.ones(1), np.zeros(4), 1, 0, 0.0)
    with pytest.raises(ValueError, match="smooth rows has 0 bytes"):
        compiled().low_pass(np.zeros(4), np.ones(1), empty, 4)
    with pytest.raises(ValueError, match="too few frames"):
        compiled().low_pass(np.zeros(2), np.ones(3), np.zeros(2), 2)
    with pytest.raises(ValueError, match="axes has 0 bytes"):
        compiled().smooth(np.zeros(4), np.zeros(4), empty, np.ones(1), np.zeros(4), 1, 0, 0.0)


def slips():
    """Yield what may be wrong in the buffers of `arms_of`: a buffer, a field, the record, the value, what is said."""
    far = 10**6
    for field, value in (("joint", far), ("parent", far), ("parent", 3), ("translation", far), ("column", far)):
        yield "nodes", field, 3, value, "nodes or columns"
    yield "nodes", "translation", 0, -1, "nodes or columns"  # the root's
    yield "nodes", "column", 1, 3, "nodes or columns"
    for field, value in (("node", -1), ("node", far), ("base", far), ("kind", far), ("kind", -1)):
        yield "tasks", field, 0, value, "tasks"
    for field, value in (("rows", 0), ("rows", 4), ("axes", (7, 0, 0)), ("axes", (-3, 0, 0)), ("width", 4)):
        yield "tasks", field, 0, value, "tasks"
    for field, value in (("targets", far), ("targets", -1), ("layer", 1), ("layer", -1)):
        yield "tasks", field, 0, value, "tasks"
    yield "hinges", "column", 0, far, "hinges"
    yield "hinges", "column", 0, 4, "hinges"  # twice
    for at, value in ((0, 1), (1, 1), (1, 2), (1, -1)):  # a second one without its first; neither
        yield "hinges", "second", at, value, "hinges"
    for field, value in (("nodes", 2**61), ("joints", -1), ("columns", 2**40), ("root", far)):
        yield "settings", field, 0, value, "sizes"


@pytest.mark.parametrize(("buffer", "field", "at", "value", "said"), list(slips()))
def test_an_index_that_is_none_is_an_error_and_no_crash(buffer, field, at, value, said):
    problem, motion = arms_of(0)
    with pytest.raises(ValueError, match=f"{said}.* that are none"):
        raw_solve(problem, motion, **{buffer: (field, at, value)})


def raw_solve(problem, motion, *, frames=tuple(range(8)), levels=(0,), in_order=False, **slip):
    """Solve a problem by its buffers, one field of which is another."""
    count = len(motion)
    buffers = {name: array.copy() for name, array in prepare_problem(problem).layout.buffers.items()}
    for buffer, (field, at, value) in slip.items():
        buffers[buffer][field][at] = value
    how = {
        "iterations": np.zeros(count, int),
        "converged": np.zeros(count, bool),
        "ranks": np.zeros((count, len(problem.layers)), int),
        "left": np.zeros((count, len(problem.layers))),
        "levels": np.array(levels),
    }
    own = {"rotations": motion.rotations.copy(), "translations": motion.translations.copy()}
    pull = {"reference_rotations": motion.rotations, "reference_root": np.zeros(0), "softness": problem.softness}
    compiled().solve({**buffers, **how, **own, **pull, "frames": np.array(frames)}, 0, len(frames), in_order)


@pytest.mark.parametrize("weights", [(1.0, 1.0, 1.0, 1.0, 1.0), (3.0, 0.3, 1.0, 0.5, 2.0)])
@pytest.mark.parametrize("seed", range(3))
def test_points_that_share_joints_are_weighed_alike_by_both_solvers(seed, weights, monkeypatch):
    problem, motion = arms_of(seed)
    (tasks,) = problem.layers
    layer = tuple(replace(task, weight=weight) for task, weight in zip(tasks, weights, strict=True))
    found = []
    for solver in ("", "numpy"):
        monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
        found.append(solved(replace(problem, layers=(layer,)), motion, np.arange(8)).motion.rotations)
    assert np.abs(found[0] - motion.rotations).max() > 0.01
    np.testing.assert_allclose(*found, atol=1e-9)


def test_frames_in_order_follow_each_other():
    problem, motion = arms_of(0)
    raw_solve(problem, motion, in_order=True)
    with pytest.raises(ValueError, match="frames that are none"):
        raw_solve(problem, motion, in_order=True, frames=range(8)[::-1])
    with pytest.raises(ValueError, match="frames that are none"):
        raw_solve(problem, motion, frames=range(1, 9))


def test_layers_are_told_of_under_priorities_that_there_are():
    problem, motion = arms_of(0)
    for level in (-1, 1):
        with pytest.raises(ValueError, match="levels that are none"):
            raw_solve(problem, motion, levels=(level,))


def test_layers_come_one_after_the_other():
    problem, motion = arms_of(0)
    (tasks,) = problem.layers
    two = replace(problem, layers=(tasks[:2], tasks[2:]), softness=np.zeros((8, 2)))
    with pytest.raises(ValueError, match="tasks that are none"):
        raw_solve(two, motion, levels=(0, 1), tasks=("layer", 0, 1))


@pytest.mark.parametrize(("parents", "places"), [((-1, 1), (0, -1)), ((-1, 0), (1, -1)), ((-2, 0), (0, -1))])
def test_a_skeleton_that_is_no_tree_is_an_error_and_no_crash(parents, places):
    buffers = [np.zeros(n) for n in (6, 8, 3, 6, 8)]
    with pytest.raises(ValueError, match="has no parent before it, or no translations"):
        compiled().forward(np.array(parents), np.array(places), *buffers, 1)
