"""Where constraints begin and end over others: they lead from and to where these have the motion."""

import numpy as np
import pytest
from person import BODY, edited, end, held, held_feet, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.priorities.continuity import switching
from motionedit.core.priorities.continuity.switching import eased_from_others
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.kinds import Orientation, Position
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter, Passes
from motionedit.core.priorities.targets import reached
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 80
MOTION = swaying(FRAMES)
SMOOTH = LayeredSettings()
MM = 1e-3


def riding(shift, first, last, *, priority=9, ease=12, name="RightHand"):
    point = ControlPoint("during", first, last, None, np.array(shift))
    return Position(name="ride", priority=priority, effector=end(name), points=(point,), ease_in=ease, ease_out=ease)


RIDE = np.array([0.0, 0.3, 0.1])
UNDER = held("RightHand", FRAMES, (0.1, 0.15, 0.2), priority=4)
OVER = riding(RIDE, 34, 44)


def targets_of(constraints, i, smoothing):
    asked = prepare(MOTION, constraints, BODY, LayeredSettings(smoothing=smoothing))[0].asked
    return asked.targets[i]


@pytest.mark.parametrize("priority", [9, 4, 2])
def test_a_ramp_begins_and_ends_where_the_others_have_the_task(priority):
    over = riding(RIDE, 34, 44, priority=priority)
    targets = targets_of([UNDER, over], 1, Passes())
    there = path(MOTION, "RightHand")[0] + np.array([0.1, 0.15, 0.2])
    assert (targets.first, targets.last) == (22, 56)
    np.testing.assert_allclose(targets.positions[[0, -1]], [there, there], atol=0.05 * MM)
    # Within the points it is where it was wanted, to the last bit.
    np.testing.assert_array_equal(targets.positions[12:23], path(MOTION, "RightHand")[34:45] + RIDE)


def test_the_papers_ramps_begin_and_end_in_the_input():
    targets = targets_of([UNDER, OVER], 1, PaperFilter())
    np.testing.assert_array_equal(targets.positions[[0, -1]], path(MOTION, "RightHand")[[22, 56]])


def test_turns_begin_and_end_where_the_others_have_them():
    wanted = rot.exp(np.array([0.0, 0.8, 0.2]))
    whole = ControlPoint("hold", 0, FRAMES - 1, None, None, wanted)
    short = ControlPoint("during", 34, 44, None, None, rot.exp(np.array([0.5, 0.0, 0.0])))
    head = end("Head")
    under = Orientation(name="a", priority=4, effector=head, points=(whole,))
    over = Orientation(name="b", priority=9, effector=head, points=(short,), ease_in=12, ease_out=12)
    targets = targets_of([under, over], 1, Passes())
    assert rot.angle_between(targets.rotations[[0, -1]], np.stack((wanted, wanted))).max() < 1e-4


@pytest.mark.parametrize("over", [OVER, riding((0.2, 0.1, 0.0), 34, 44, priority=2)])
def test_the_hand_does_not_jump_where_a_constraint_begins_over_another(over):
    edit = edited(MOTION, [*held_feet(FRAMES), UNDER, over], SMOOTH)
    steps = np.linalg.norm(np.diff(path(edit.motion, "RightHand"), axis=0), axis=1)
    own = np.linalg.norm(np.diff(path(MOTION, "RightHand"), axis=0), axis=1)
    # At the first and the last frames of the ramps, where the input's path would be 25 cm away.
    for frame in (21, 22, 55, 56):
        assert steps[frame] < own[frame] + 10.0 * MM


def test_the_hand_does_not_jump_where_a_ramp_ends_within_that_of_a_third():
    first, second = riding((0.0, 0.25, 0.1), 14, 22, priority=4), riding((0.15, 0.0, 0.1), 26, 40, priority=3)
    third = riding((0.1, 0.2, 0.0), 42, 50, priority=9)
    after, before = (path(each, "RightHand") for each in (edited(MOTION, [first, second, third]).motion, MOTION))
    bends = np.linalg.norm(np.diff(after - before, 2, axis=0), axis=1)
    # Where the first ends, 34, the third has begun to take over from both, 30.
    assert bends.max() < 20.0 * MM


def test_what_others_do_not_move_keeps_its_targets():
    still = MOTION.rotations[:1].repeat(FRAMES, axis=0)
    standing = type(MOTION)(MOTION.skeleton, still, MOTION.translations, MOTION.frame_time)
    asked = prepare(standing, [held("LeftFoot", FRAMES), OVER], BODY, LayeredSettings(smoothing=PaperFilter()))[0].asked
    assert eased_from_others(asked, Passes()).asked.targets[1] is asked.targets[1]
    alone = asked.only([1])
    assert eased_from_others(alone, Passes()).asked.targets[0] is alone.targets[0]


def test_without_eases_nothing_is_moved():
    sudden = riding(RIDE, 34, 44, ease=0)
    targets = targets_of([UNDER, sudden], 1, Passes())
    np.testing.assert_array_equal(targets.positions, path(MOTION, "RightHand")[34:45] + RIDE)


@pytest.mark.parametrize(("first", "last"), [(30, FRAMES - 2), (1, 20), (1, FRAMES - 2)])
def test_a_ride_to_a_frame_before_the_clips_end_leaves_its_place_slowly(first, last):
    shift = np.array([0.0, 0.25, 0.1])
    edit = edited(MOTION, [riding(shift, first, last)], SMOOTH)
    moved = path(edit.motion, "RightHand") - path(MOTION, "RightHand")
    for end_frame, inside in ((FRAMES - 1, last), (0, first)):
        if abs(end_frame - inside) == 1:
            # One frame of twelve of Hermite's cubic.
            s = 11.0 / 12.0
            np.testing.assert_allclose(moved[end_frame], (3 * s**2 - 2 * s**3) * shift, atol=0.01 * MM)
    np.testing.assert_allclose(moved[first : last + 1], np.tile(shift, (last - first + 1, 1)), atol=0.01 * MM)


def test_where_a_motion_has_a_task_is_read_off_the_whole_edit_of_the_others():
    asked = prepare(MOTION, [UNDER, OVER], BODY, LayeredSettings(smoothing=PaperFilter()))[0].asked
    alone = edited(MOTION, [UNDER], SMOOTH).motion
    eased = eased_from_others(asked, Passes()).asked.targets[1]
    share = 1.0 - OVER.share(FRAMES)[22:57, None]
    expected = asked.targets[1].positions + share * (
        reached(asked, 1, alone).positions - reached(asked, 1, MOTION).positions
    )
    np.testing.assert_allclose(eased.positions, expected, atol=1e-12)


@pytest.mark.parametrize("feet", [[], held_feet(FRAMES)])
def test_the_hand_goes_on_smoothly_beyond_the_end_of_its_ramp(feet):
    edit = edited(MOTION, [*feet, riding((0.1, 0.25, 0.1), 34, 44)], SMOOTH)
    moved = path(edit.motion, "RightHand") - path(MOTION, "RightHand")
    bends = np.linalg.norm(np.diff(moved, n=2, axis=0), axis=1)
    # What passes smooth over the ramp's end is some millimetres outside of it: the ramp goes on from there, not from 0.
    for outside, inside in ((21, 22), (57, 56)):
        assert np.linalg.norm(moved[outside]) > 0.5 * MM
        assert np.linalg.norm(moved[inside] - moved[outside]) < 0.5 * MM
    assert bends[20] < 0.2 * bends.max()
    assert edit.errors[-1].positions.max() < 0.1 * MM


def overlapping(count):
    """Return windows of all joints of an arm and a leg, each within the ramps of those beside it."""
    names = ["RightHand", "LeftHand", "Head", "RightForeArm", "LeftForeArm"]
    return [
        riding(0.02 * RIDE, 16 + n, 18 + n, priority=4 + n % 3, ease=14, name=names[n % len(names)])
        for n in range(count)
    ]


@pytest.mark.parametrize("count", [5, 10, pytest.param(40, marks=pytest.mark.compiled)])
def test_of_many_that_overlap_few_sets_of_others_are_solved(count, monkeypatch):
    whole, at_ramps = [], []

    def watch(name, runs):
        real = getattr(switching, name)
        monkeypatch.setattr(switching, name, lambda run, *more: runs.append(run) or real(run, *more))

    watch("solve_in_passes", whole)
    watch("solve_from_input", at_ramps)
    prepare(MOTION, overlapping(count), BODY, SMOOTH)
    assert count <= len(whole) + len(at_ramps) <= max(32, 2 * count)
    # Many together that are many all in all: at the 14 frames of a ramp, and the one outside.
    sizes = [len(run.asked.constraints) for run in whole]
    assert max(sizes) <= 8 if count == 40 else not at_ramps
    assert all(np.count_nonzero(~run.idle) <= 15 < FRAMES for run in at_ramps)
