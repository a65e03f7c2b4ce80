"""What a viewer sees of an edit: joints whose change steps, and frames at which the body jerks."""

import numpy as np
import pytest
from person import BODY, held_feet, joint, swaying

from motionedit.core import blocks
from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.continuity.visible import jerks_of, seen_of, steps_at
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.settings import LayeredSettings, Passes

FRAMES = 90
MOTION = swaying(FRAMES)
STEP = 8.0 * 0.6  # degrees from frame to frame that are seen at 100 frames a second


def prepared(motion=MOTION):
    return prepare(motion, held_feet(len(motion)), BODY, LayeredSettings())[0]


def turned(degrees, frames, name="Spine", motion=MOTION):
    """Return a motion with a joint turned at some frames."""
    rotations = motion.rotations.copy()
    turn = rot.exp(np.radians([degrees, 0.0, 0.0]))
    rotations[frames, joint(name)] = rot.multiply(turn, rotations[frames, joint(name)])
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


def test_a_viewer_sees_a_joint_that_steps_and_a_body_that_jerks_where_they_do():
    run = prepared()
    assert not seen_of(run, MOTION).much.any()
    seen = seen_of(run, turned(30.0, [40]))
    assert list(np.flatnonzero(seen.steps)) == [39, 40, 41]
    assert STEP * seen.steps.max() == pytest.approx(30.0)
    assert {39, 40, 41} <= set(np.flatnonzero(seen.jerks)) <= {38, 39, 40, 41, 42}
    assert list(np.flatnonzero(seen.much)) == list(np.flatnonzero(seen.steps + seen.jerks))


def test_what_a_solution_knows_of_its_steps_is_what_is_seen_of_it():
    run = prepared()
    state = solve_in_passes(run, Passes()).state
    assert state.steps.tolist() == steps_at(run, state.motion).tolist()


def test_a_body_that_jerks_without_a_step_is_seen():
    seen = seen_of(prepared(), turned(4.0, slice(40, 60, 2), "Hips"))
    assert not seen.steps.any()
    assert seen.jerks.max() > 1.0


def test_a_clip_of_few_frames_jerks_nowhere():
    short = MOTION.at(slice(0, 3))
    assert not seen_of(prepared(short), short).much.any()
    four = MOTION.at(slice(0, 4))
    assert list(np.flatnonzero(jerks_of(prepared(four), turned(30.0, [1], "Hips", four))[0])) == [1, 2]


def looked_at(frames, degrees=30.0, within=None):
    """Return the frames at which a joint that is turned at some frames steps."""
    share = None if within is None else np.isin(np.arange(FRAMES), within).astype(float)
    return list(np.flatnonzero(steps_at(prepared(), turned(degrees, frames), within=share)))


@pytest.mark.parametrize(("frames", "seen"), [([0], [0, 1]), ([89], [88, 89]), (slice(40, 90), [39, 40])])
def test_steps_are_seen_at_both_of_their_frames_and_at_a_clips_ends(frames, seen):
    assert looked_at(frames) == seen


def test_steps_are_looked_for_among_the_frames_that_are_asked_for():
    assert looked_at([40], within=range(45, 60)) == []
    assert looked_at([40], within=[40, 41]) == [40, 41]
    assert looked_at([40], within=range(30, 41)) == [39, 40]
    assert looked_at([40], within=[]) == []


def test_a_joint_that_steps_by_itself_may_step_as_much_once_more():
    own = turned(20.0, [10], "Spine")
    assert list(np.flatnonzero(steps_at(prepared(own), turned(15.0, [40], "Spine", own)))) == []
    assert list(np.flatnonzero(steps_at(prepared(own), turned(25.0, [40], "Spine", own)))) == [39, 40, 41]
    assert list(np.flatnonzero(steps_at(prepared(own), turned(15.0, [40], "Neck", own)))) == [39, 40, 41]


def test_a_jerk_is_seen_in_the_middle_of_its_frames():
    found = jerks_of(prepared(), turned(30.0, [40], "Hips"))[0]
    assert list(np.flatnonzero(found)) == [38, 39, 40, 41, 42]
    np.testing.assert_allclose(found[38:40], found[42:40:-1], rtol=0.05)


def test_a_frame_that_jerks_twice_as_much_as_it_did_is_seen_and_no_less():
    own = turned(30.0, [40], "Hips")
    run = prepared(own)
    assert not jerks_of(run, turned(25.0, [40], "Hips", own))[0].any()
    assert jerks_of(run, turned(60.0, [40], "Hips", own))[0].any()


@pytest.mark.parametrize("block", [7, 30])
def test_a_long_motion_is_seen_as_a_short_one_block_by_block(monkeypatch, block):
    run, after = prepared(), turned(30.0, [13, 14, 60])
    steps, jerks = steps_at(run, after), jerks_of(run, after)[0]
    monkeypatch.setattr(blocks, "BLOCK_FRAMES", block)
    np.testing.assert_array_equal(steps_at(run, after), steps)
    np.testing.assert_allclose(jerks_of(run, after)[0], jerks, rtol=1e-12)
