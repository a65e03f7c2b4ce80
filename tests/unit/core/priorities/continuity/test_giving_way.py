"""Goals out of reach give way: what is above is met, the path is smooth, and what is left is told."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, HARD, edited, end, held, held_feet, joint, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.giving_way import given_way
from motionedit.core.priorities.edit import edit_by_priorities, prepare
from motionedit.core.priorities.frames import run_of, solve_frames
from motionedit.core.priorities.kinds import CenterOfMass, Position, Posture
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.solver.homing import attraction
from motionedit.core.priorities.solver.problem import Reference
from motionedit.core.priorities.targets import lefts_of
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 90
MOTION = swaying(FRAMES)
MM = 1e-3
SMOOTH = LayeredSettings()
SHIFTS = [(0.6, 0.9, 0.9), (-1.5, 0.2, 0.5)]


def reaching(shift, name="RightHand", priority=4, first=35, last=50, ease=20):
    point = ControlPoint("hold", first, last, None, np.array(shift))
    return Position(name=name, priority=priority, effector=end(name), points=(point,), ease_in=ease, ease_out=ease)


def lefts(edit):
    """Return what is left of each constraint at every frame, shape (constraints, F)."""
    return np.array(lefts_of(edit.asked, edit.motion))


def largest_step(edit):
    """Return by how much a joint's change steps at most, degrees in a sixtieth of a second."""
    change = rot.multiply(rot.conjugate(MOTION.rotations), edit.motion.rotations)
    steps = rot.angle_between(change[:-1], change[1:])
    return np.degrees(steps.max()) / 60.0 / MOTION.frame_time


@pytest.fixture(params=["compiled", "numpy"])
def solver(request, monkeypatch):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", request.param if request.param == "numpy" else "")


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("shift", SHIFTS)
def test_what_is_above_a_goal_out_of_reach_is_met(shift):
    edit = edited(MOTION, [*held_feet(FRAMES), reaching(shift)], SMOOTH)
    *feet, hand = lefts(edit)
    assert np.max(feet) < 0.1 * MM
    assert hand.max() > 0.05


def going_out(shift):
    """Return a constraint that leads a hand from a place in reach to one out of it, and back; it has no ramps."""
    near = np.array([0.05, 0.1, 0.1])
    points = tuple(ControlPoint("at", f, f, None, np.array(s)) for f, s in ((20, near), (45, shift), (70, near)))
    return Position(name="hand", priority=4, effector=end("RightHand"), points=points)


@pytest.mark.compiled
@pytest.mark.parametrize("shift", SHIFTS)
@pytest.mark.parametrize(
    "below",
    [
        reaching((1.5, 0.8, 0.5), "LeftHand", 1),
        CenterOfMass(name="com", priority=2),
        reaching(SHIFTS[0][::-1], "Head", 3),
    ],
)
def test_a_layer_below_moves_a_constraint_by_less_than_a_tenth_of_a_millimetre(shift, below):
    asked = [*held_feet(FRAMES), going_out(shift)]
    alone, both = edited(MOTION, asked, SMOOTH), edited(MOTION, [*asked, below], SMOOTH)
    met = lefts(alone)[-1, 20:71] < 0.1 * MM
    assert 0 < np.count_nonzero(met) < len(met)
    apart = np.linalg.norm(path(alone.motion, "RightHand") - path(both.motion, "RightHand"), axis=1)[20:71]
    assert apart[met].max() < 0.1 * MM
    assert apart.max() < 2.0 * MM
    assert lefts(both)[:4].max() < 0.1 * MM


@pytest.mark.parametrize("shift", SHIFTS)
def test_the_motion_is_smooth_where_a_goal_gives_way(shift):
    # An arm that is led out in a third of a second, as far as it goes and farther.
    asked = [*held_feet(FRAMES), reaching(shift, ease=34)]
    assert largest_step(edited(MOTION, asked, SMOOTH)) < 10.0


@pytest.mark.parametrize("shift", SHIFTS)
def test_what_is_left_is_told_of_what_was_asked_and_not_of_the_path_in_its_place(shift):
    edit = edited(MOTION, [*held_feet(FRAMES), reaching(shift)], SMOOTH)
    errors = edit.errors[-1]
    wanted = path(MOTION, "RightHand")[35] + shift
    off = np.linalg.norm(path(edit.motion, "RightHand")[35:51] - wanted, axis=1)
    np.testing.assert_allclose(errors.positions[35 - errors.first :][:16], off, atol=1e-9)
    # Nor is it nearer than anything that the feet allow could be.
    hard = edited(MOTION, [*held_feet(FRAMES), reaching(shift)], HARD)
    assert off.min() > lefts(hard)[-1, 35:51].min() - 1e-3


def test_a_goal_in_reach_does_not_give_way():
    asked = [*held_feet(FRAMES), reaching((0.1, 0.1, 0.1))]
    assert lefts(edited(MOTION, asked, SMOOTH)).max() < 0.01 * MM


def test_what_has_a_path_is_kept_to_it_and_what_has_none_stays_soft():
    hand = held("RightHand", FRAMES, SHIFTS[0], priority=4)
    keep = Posture(name="keep", joints=(joint("Spine"),), priority=hand.priority)
    run, _ = prepare(MOTION, [*held_feet(FRAMES), hand, keep], BODY, SMOOTH)
    missed = np.zeros(FRAMES, dtype=np.bool_)
    missed[40:46] = True
    last = len(run.asked.constraints) - 1
    asked, smooth = given_way(run.asked, {last - 1: missed, last: missed}, Passes())
    kept, soft = (asked.softness[k] for k in (last - 1, last))
    lambdas = np.array([0.012, 0.12])  # m/rad
    np.testing.assert_allclose([kept[43], soft[43]], lambdas**2)
    np.testing.assert_allclose(kept[soft > 0.0] / soft[soft > 0.0], 0.01)
    ramp = round(0.3 / MOTION.frame_time)
    np.testing.assert_array_equal(np.flatnonzero(soft), np.arange(41 - ramp, 45 + ramp))
    t = 0.5
    halfway = t**3 * (10.0 - 15.0 * t + 6.0 * t * t)
    np.testing.assert_allclose(soft[40 - ramp // 2], (lambdas[1] * halfway) ** 2)
    # The path is the smooth edit's.
    assert lefts_of(asked, smooth.motion)[last - 1][43] < 0.1 * MM < lefts_of(run.asked, smooth.motion)[last - 1][43]


@pytest.mark.compiled
@pytest.mark.parametrize("threads", [2, 5])
def test_the_number_of_threads_changes_no_byte(threads):
    motion = Motion(
        MOTION.skeleton,
        np.tile(MOTION.rotations, (4, 1, 1)),
        np.tile(MOTION.translations, (4, 1, 1)),
        MOTION.frame_time,
    )
    asked = [*held_feet(len(motion)), reaching(SHIFTS[0], last=200)]
    one, other = (
        edit_by_priorities(motion, asked, BODY, replace(SMOOTH, threads=count)).motion for count in (1, threads)
    )
    assert one.rotations.tobytes() == other.rotations.tobytes()
    assert one.translations.tobytes() == other.translations.tobytes()


# Not the first of SHIFTS: there some frames swing to and fro until their iterations run out, and roundings grow.
@pytest.mark.compiled
@pytest.mark.parametrize("shift", [SHIFTS[1], (0.6, 0.9, 0.5)])
def test_both_solvers_give_way_alike(shift, monkeypatch):
    asked = [*held_feet(FRAMES), reaching(shift), CenterOfMass(name="com", priority=2)]
    one = edited(MOTION, asked, SMOOTH).motion
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    other = edited(MOTION, asked, SMOOTH).motion
    assert rot.angle_between(one.rotations, other.rotations).max() < 1e-7
    assert np.abs(one.translations - other.translations).max() < 1e-7


def test_the_papers_smoothing_gives_way_to_nothing(monkeypatch):
    def never(*_):
        raise AssertionError

    monkeypatch.setattr("motionedit.core.priorities.continuity.passes.within_reach", never)
    edited(MOTION, [reaching(SHIFTS[0])], HARD)
    with pytest.raises(AssertionError):
        edited(MOTION, [reaching(SHIFTS[0])], SMOOTH)


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("softness", [0.01, 0.04, 0.3])
def test_a_soft_layer_makes_the_error_and_the_change_least_together(softness):
    shift = np.array([0.02, 0.03, 0.04])
    run, _ = prepare(MOTION, [reaching(shift)], BODY, LayeredSettings(smoothing=Passes(0), max_iterations=200))
    soft = run_of(replace(run.asked, softness=(np.full(FRAMES, softness),), recruits=(_turning_only(run),)))
    motion = solve_frames(soft, MOTION, reference=MOTION, pull_root=False).motion
    (group,) = soft.groups
    frames = np.arange(35, 51)
    columns = group.problem.columns
    poses = forward(motion).at(slice(35, 51))
    part = motion.at(frames)
    z = attraction(columns, Reference(MOTION.rotations[frames], None), poses, part, np.arange(len(frames)))
    (layer,) = group.problem.layers
    e, J = layer[0].task.evaluate(poses, part.rotations, frames - group.frames[0])
    # d/dw of |e|^2 + lambda^2 |z|^2 is nothing, all turns being along or against their pull.
    slope = (np.swapaxes(J, 1, 2) @ e[..., None])[..., 0] + softness * z
    assert np.linalg.norm(z, axis=1).min() > 0.01
    assert np.abs(slope).max() < 1e-4 * softness + 1e-5


def _turning_only(run):
    (mine,) = run.asked.recruits
    return mine._replace(root=False)
