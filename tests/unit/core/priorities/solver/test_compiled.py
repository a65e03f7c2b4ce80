"""The compiled solver beside numpy's, on random skeletons, tasks, ranks and hinges."""

import os
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import pytest
from arms import arms_of, solved
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from person import edited, end, held_feet, swaying
from random_bodies import (
    FEASIBLE,
    FRAMES,
    INFEASIBLE,
    assert_no_neighbour_changes_a_bit,
    by_numpy,
    difference,
    motion_of,
    others_are_same,
    same_bits,
)

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.body.bends import turns_about
from motionedit.core.body.center_of_mass import Masses
from motionedit.core.body.hinges import Hinge
from motionedit.core.compiled import CHOICE, compiled, solver_name
from motionedit.core.kinematics import Effector
from motionedit.core.measure import Measure
from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import KINDS, CenterOfMass, Position
from motionedit.core.priorities.kinds.position import PositionTask
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import Body, LayeredSettings, PaperFilter, Passes
from motionedit.core.priorities.solver import compiled_solver
from motionedit.core.priorities.solver.layered import prepare_problem
from motionedit.core.priorities.trajectories.positions import ControlPoint

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="no compiled solver here")

NAMES = ("position", "orientation", "pose", "com", "aim", "posture")


def masses_of(rng, skeleton):
    shares = rng.uniform(size=len(skeleton)) * (rng.uniform(size=len(skeleton)) < 0.7)
    shares[-1] += 0.1
    return Masses(skeleton, frozen(shares / shares.sum()), frozen(rng.normal(scale=0.1, size=(len(skeleton), 3))), True)


def hinges_of(rng, skeleton, motion):
    found = []
    for joint in rng.choice(len(skeleton), size=min(2, len(skeleton) - 1), replace=False):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        upper, lower = rng.normal(size=(2, 3))
        angles = turns_about(axis, upper, rot.rotate(motion.rotations[:, joint], np.tile(lower, (len(motion), 1))))
        spread = rng.uniform(0.02, 1.0)
        limits = (angles.min() - spread, angles.max() + spread)
        found.append(Hinge(int(joint), frozen(axis), frozen(upper), frozen(lower), limits))
    return tuple(sorted(found, key=lambda hinge: hinge.joint))


def constraint_of(rng, skeleton, number, reach):
    joint = int(rng.integers(1, len(skeleton)))
    kind = NAMES[int(rng.integers(len(NAMES)))]
    offset = rng.normal(scale=0.1, size=3) * (rng.uniform() < 0.5)
    base = int(rng.integers(len(skeleton))) if rng.uniform() < 0.3 and kind in {"position", "orientation"} else None
    axes = ((0, 1, 2), (0, 2), (1,))[int(rng.integers(3))] if kind in {"position", "com"} else (0, 1, 2)
    rules = (RecruitRule(), RecruitRule("levels", levels=2))
    shift = rng.normal(scale=reach, size=3) if kind in {"position", "pose", "com"} else None
    turn = rot.exp(rng.normal(scale=0.3, size=3)) if kind in {"orientation", "pose"} and rng.uniform() < 0.5 else None
    place = rng.normal(scale=2.0, size=3) if kind == "aim" else None
    point = ControlPoint("hold", 0, FRAMES - 1, position=place, shift=shift, orientation=turn)
    axis = rng.normal(size=3)
    priority, weight = int(rng.integers(1, 4)), float(rng.uniform(0.3, 3.0))
    whole = {
        "effector": Effector(joint, offset),
        "measure": Measure(counted=axes, base=base if base != joint else None),
        "recruit": rules[int(rng.integers(2))] if kind in {"position", "orientation"} else rules[0],
        "points": () if kind == "posture" else (point,),
        "axis": axis / np.linalg.norm(axis),
        "joints": (joint,) if kind == "posture" else (),
    }
    has = {each.name for each in fields(KINDS[kind])}
    own = {key: value for key, value in whole.items() if key in has}
    return KINDS[kind](name=f"c{number}", priority=priority, weight=weight, **own)


def problem_of(seed, joints, count, reach):
    rng = np.random.default_rng(seed)
    motion = motion_of(rng, joints)
    skeleton = motion.skeleton
    hinges = hinges_of(rng, skeleton, motion) if rng.uniform() < 0.7 else ()
    body = Body(masses_of(rng, skeleton), hinges, 0, 0)
    return motion, [constraint_of(rng, skeleton, i, reach) for i in range(count)], body


# The same examples on every run: where a body stands exactly stretched, a rounding decides how far the last step goes.
@given(
    seed=st.integers(0, 2**32 - 1),
    joints=st.integers(3, 16),
    count=st.integers(1, 5),
    reach=st.sampled_from([0.02, 0.1]),
)
@settings(max_examples=80, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_both_solvers_move_a_body_alike(patch, seed, joints, count, reach):
    motion, constraints, body = problem_of(seed, joints, count, reach)
    setting = LayeredSettings(smoothing=Passes(0), max_iterations=12)
    mine = edit_by_priorities(motion, constraints, body, setting)
    theirs = by_numpy(patch, lambda: edit_by_priorities(motion, constraints, body, setting))
    errors = [e for each in mine.errors for e in (each.positions, each.angles) if e is not None]
    met = max(e.max() for e in errors) < 1e-3
    np.testing.assert_array_equal(mine.ranks, theirs.ranks)
    assert difference(mine, theirs) < (FEASIBLE if met else INFEASIBLE)
    if met:
        np.testing.assert_array_equal(mine.iterations, theirs.iterations)


@pytest.mark.parametrize("seed", range(12))
def test_both_solvers_take_the_same_first_steps(patch, seed):
    # Few, so that what is weighed, shared and measured otherwise is not met all the same in the end.
    motion, constraints, body = problem_of(seed, 3 + seed % 6, 3, 0.3)
    setting = LayeredSettings(smoothing=PaperFilter(0), max_iterations=2)
    mine = edit_by_priorities(motion, constraints, body, setting)
    theirs = by_numpy(patch, lambda: edit_by_priorities(motion, constraints, body, setting))
    assert not mine.converged.all()
    assert difference(mine, theirs) < FEASIBLE


def test_the_compiled_part_is_that_of_this_tree():
    assert Path(compiled().__file__).is_relative_to(Path(__file__).resolve().parents[5])


@given(seed=st.integers(0, 2**32 - 1), joints=st.integers(3, 16), count=st.integers(1, 5))
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_neither_the_width_of_vectors_nor_the_neighbours_change_a_bit(patch, seed, joints, count):
    motion, constraints, body = problem_of(seed, joints, count, 0.1)
    setting = LayeredSettings(smoothing=Passes(0), max_iterations=12)
    assert_no_neighbour_changes_a_bit(
        patch, lambda threads: edit_by_priorities(motion, constraints, body, replace(setting, threads=threads))
    )


def test_frames_that_take_a_lane_after_each_other_change_no_bit(patch):
    motion = swaying(30)
    points = (ControlPoint("hold", 14, 15, shift=np.array([0.2, 0.6, 0.5])),)
    hand = Position(name="hand", effector=end("RightHand"), points=points, ease_in=12, ease_out=12, priority=2)
    asked = [*held_feet(30), hand, CenterOfMass(name="com")]
    edit = edited(motion, asked, LayeredSettings())
    assert len(set(edit.iterations.tolist())) > 5
    others_are_same(patch, lambda: edited(motion, asked, LayeredSettings()), edit)


def test_a_solver_that_the_processor_does_not_have_is_refused():
    with pytest.raises(ValueError, match="no solver 'avx1024'"):
        compiled().solve({}, 0, 0, False, "avx1024")


@pytest.mark.parametrize("seed", range(10))
def test_both_solvers_make_soft_rows_least_alike(patch, seed):
    problem, motion = arms_of(seed)
    rng, frames = np.random.default_rng(seed), np.arange(len(motion))
    soft = rng.uniform(0.01, 0.3, size=(len(motion), 1)) * (rng.uniform(size=(len(motion), 1)) < 0.8)
    problem = replace(problem, softness=soft, mobility=rng.uniform(0.3, 1.0, size=7), max_iterations=60)
    mine, theirs = (
        solved(problem, motion, frames),
        by_numpy(patch, lambda: solved(problem, motion, frames)),
    )
    assert difference(mine, theirs) < FEASIBLE
    np.testing.assert_array_equal(mine.ranks, theirs.ranks)
    # Softness leaves something of the error for a shorter way.
    hard = solved(replace(problem, softness=np.zeros_like(soft)), motion, frames)
    far = rot.angle_between(mine.motion.rotations, motion.rotations).sum(axis=1)
    farther = rot.angle_between(hard.motion.rotations, motion.rotations).sum(axis=1)
    softened = soft[:, 0] > 0.0
    assert (far[softened] < farther[softened]).all()


def test_layers_of_one_priority_are_told_of_as_one_at_the_frames_that_are_solved(patch):
    problem, motion = arms_of(1)
    (tasks,) = problem.layers
    some = np.array([1, 2, 5, 6])
    cut = tuple(replace(each, task=replace(each.task, targets=each.task.targets[some])) for each in tasks)
    three = replace(problem, layers=(cut[:1], cut[1:2], cut[2:]), softness=np.zeros((len(some), 3)))
    one_by_one = solved(three, motion, some)
    for found in (
        solved(three, motion, some, levels=[1, 1, 3]),
        by_numpy(patch, lambda: solved(three, motion, some, levels=[1, 1, 3])),
    ):
        np.testing.assert_array_equal(found.ranks[:, 1], one_by_one.ranks[:, :2].sum(axis=1))
        np.testing.assert_array_equal(found.ranks[:, 3], one_by_one.ranks[:, 2])
        np.testing.assert_allclose(found.left[:, 1], one_by_one.left[:, :2].max(axis=1), atol=FEASIBLE)
        np.testing.assert_allclose(found.left[:, 3], one_by_one.left[:, 2], atol=FEASIBLE)
        assert not found.ranks[:, [0, 2]].any()
        assert not found.left[:, [0, 2]].any()
        assert found.ranks[some].any(axis=1).all()
        assert found.left[some].any(axis=1).all()
        others = np.setdiff1d(np.arange(len(motion)), some)
        for rest in (found.ranks, found.left, found.iterations, found.converged):
            assert not rest[others].any()
        np.testing.assert_array_equal(found.motion.rotations[others], motion.rotations[others])


@pytest.mark.parametrize("seed", range(30))
def test_rows_that_depend_on_each_other_in_a_neighbour_alone_change_no_bit(patch, seed):
    problem, motion = arms_of(seed)
    frames = np.arange(len(motion))
    together = solved(problem, motion, frames)
    with patch.context() as parted:
        parted.setattr(compiled_solver, "_LEAST_SHARE", 1)
        same_bits(solved(problem, motion, frames, threads=len(motion)), together)


def test_no_frames_are_solved_at_once():
    problem, motion = arms_of(0)
    none = replace(
        problem,
        layers=tuple(
            tuple(replace(each, task=replace(each.task, targets=each.task.targets[:0])) for each in layer)
            for layer in problem.layers
        ),
        softness=problem.softness[:0],
    )
    solution = solved(none, motion, np.arange(0))
    np.testing.assert_array_equal(solution.motion.rotations, motion.rotations)
    assert not solution.iterations.any()


@pytest.mark.parametrize("smoothing", [Passes(2, 1.5), PaperFilter(2, 10.0)])
@pytest.mark.parametrize("seed", range(6))
def test_both_smooth_alike(patch, seed, smoothing):
    motion, constraints, body = problem_of(seed, 9, 3, 0.05)
    setting = LayeredSettings(smoothing=smoothing, max_iterations=12)
    mine = edit_by_priorities(motion, constraints, body, setting)
    theirs = by_numpy(patch, lambda: edit_by_priorities(motion, constraints, body, setting))
    assert difference(mine, theirs) < INFEASIBLE
    np.testing.assert_array_equal(mine.touched, theirs.touched)


@pytest.mark.parametrize("threads", [2, 3, 7])
def test_the_number_of_threads_changes_no_bit(threads):
    rng = np.random.default_rng(4)
    motion = motion_of(rng, 12, 300)
    hold = ControlPoint("hold", 0, 299, shift=np.ones(3) * 0.05)
    hand = Position(name="hand", effector=Effector(11, np.zeros(3)), points=(hold,))
    body = Body(masses_of(rng, motion.skeleton), (), 0, 0)
    one = edit_by_priorities(motion, [hand], body, LayeredSettings())
    other = edit_by_priorities(motion, [hand], body, replace(LayeredSettings(), threads=threads))
    np.testing.assert_array_equal(one.motion.rotations, other.motion.rotations)
    np.testing.assert_array_equal(one.iterations, other.iterations)


def test_a_variable_of_the_environment_keeps_the_compiled_part_out(patch):
    assert solver_name() == "compiled"
    patch.setenv(CHOICE, "numpy")
    assert solver_name() == "numpy"
    assert os.environ[CHOICE] == "numpy"


@dataclass(frozen=True, eq=False)
class Unknown:
    """A task that the compiled solver does not know."""

    task: PositionTask

    def evaluate(self, poses, local, frames):
        return self.task.evaluate(poses, local, frames)

    def compiled(self):
        return None


def test_a_task_that_the_compiled_solver_does_not_know_is_solved_by_numpy(patch):
    problem, motion = arms_of(3)
    (layer,) = problem.layers
    unknown = replace(problem, layers=((replace(layer[0], task=Unknown(layer[0].task)), *layer[1:]),))
    frames = np.arange(len(motion))
    assert prepare_problem(problem).layout is not None
    assert prepare_problem(unknown).layout is None
    mine, theirs = solved(unknown, motion, frames), by_numpy(patch, lambda: solved(problem, motion, frames))
    # Forward kinematics are compiled here and numpy's there.
    assert difference(mine, theirs) < FEASIBLE
    np.testing.assert_array_equal(mine.iterations, theirs.iterations)
    assert mine.iterations.max() > 0
