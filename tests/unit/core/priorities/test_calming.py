"""What a viewer would see is seen, and calmed: what need not be met gives way further where it is to blame."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, edited, end, held_feet, joint, swaying

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities import calming
from motionedit.core.priorities.calming import calmed
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.frames import run_of, solve_frames
from motionedit.core.priorities.giving_way import within_reach
from motionedit.core.priorities.kinds import CenterOfMass, Position
from motionedit.core.priorities.passes import solve_in_passes
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.smoothing import PassedBefore
from motionedit.core.priorities.targets import lefts_of
from motionedit.core.priorities.trajectories import ControlPoint
from motionedit.core.priorities.visible import Seen, seen_of, steps_at

FRAMES = 90
MOTION = swaying(FRAMES)
SMOOTH = LayeredSettings()
FAR = (-1.5, 0.2, 0.5)


def reaching(shift, priority=4, first=35, last=50, ease=20):
    point = ControlPoint("hold", first, last, None, np.array(shift))
    hand = end("RightHand")
    return Position(name="hand", priority=priority, effector=hand, points=(point,), ease_in=ease, ease_out=ease)


def prepared(*constraints):
    return prepare(MOTION, [*held_feet(FRAMES), *constraints], BODY, SMOOTH)[0]


def turned(degrees, frames, name="Spine"):
    """Return the motion with a joint turned at some frames."""
    rotations = MOTION.rotations.copy()
    turn = rot.exp(np.radians([degrees, 0.0, 0.0]))
    rotations[frames, joint(name)] = rot.multiply(turn, rotations[frames, joint(name)])
    return Motion(MOTION.skeleton, rotations, MOTION.translations, MOTION.frame_time)


def test_a_viewer_sees_a_joint_that_steps_and_a_body_that_jerks_where_they_do():
    run = prepared()
    assert not seen_of(run, MOTION).much.any()
    seen = seen_of(run, turned(30.0, [40]))
    assert list(np.flatnonzero(seen.steps)) == [39, 40, 41]
    assert 8.0 * 0.6 * seen.steps.max() == pytest.approx(30.0)
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
    run = prepare(short, held_feet(3), BODY, SMOOTH)[0]
    assert not seen_of(run, short).much.any()


def looking_so(monkeypatch, *found):
    """Let each look at a solution find what is seen at all frames, one after the other."""
    seen = (Seen(np.full(FRAMES, float(each)), np.zeros(FRAMES)) for each in found)
    monkeypatch.setattr(calming, "seen_of", lambda *_, **__: next(seen))


def of_two_layers(monkeypatch, *found, shift=FAR):
    """Return an edit's hand where looks at the whole, at the feet, and at the hand, tried again, find so much."""
    run = prepared(reaching(shift))
    before = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    tried = []
    solved = calming._solved
    monkeypatch.setattr(calming, "_solved", lambda *asked: tried.append(solved(*asked)) or tried[-1])
    looking_so(monkeypatch, *found)
    return before, calmed(before, Passes()), tried


@pytest.mark.parametrize(("seen", "best"), [([5, 3, 4, 2], 3), ([5, 3, 4, 6], 1), ([5, 6, 7, 8], 0), ([5, 0], 1)])
def test_the_calmest_solution_is_kept(seen, best, monkeypatch):
    before, after, tried = of_two_layers(monkeypatch, seen[0], 0, *seen[1:])
    _feet, *others = [layers.state for layers in tried]
    assert after is [before.state, *others][best]


def test_a_layer_is_not_to_blame_for_what_is_seen_without_it(monkeypatch):
    before, after, tried = of_two_layers(monkeypatch, 5, 5)
    assert after is before.state
    assert len(tried) == 1


@pytest.mark.parametrize(("shift", "tries"), [(FAR, 4), ((0.0, 0.05, 0.1), 1)])
def test_of_goals_that_count_only_a_missed_one_gives_way_further(shift, tries, monkeypatch):
    edit = edited(MOTION, [*held_feet(FRAMES), reaching(shift)], SMOOTH)
    assert (np.max(lefts_of(edit.asked, edit.motion)[-1]) > 1e-4) == (tries > 1)
    _before, _after, tried = of_two_layers(monkeypatch, 5, 0, 4, 3, 2, shift=shift)
    assert len(tried) == tries


def test_whether_a_layer_is_to_blame_is_judged_without_what_is_below(monkeypatch):
    run = prepared(reaching(FAR), CenterOfMass(name="com", priority=2))
    seen = []
    monkeypatch.setattr(calming, "_calmest", lambda layers, *_: seen.append(layers) or layers)
    alone = solve_in_passes(run_of(run.asked.only(range(len(held_feet(FRAMES)) + 1))), Passes()).state.motion
    seen.clear()
    looking_so(monkeypatch, 5, 5, 5)
    solve_in_passes(run, Passes())
    hand, _com = seen
    assert rot.angle_between(hand.state.motion.rotations, alone.rotations).max() < 1e-6


def test_frames_that_are_not_solved_on_leave_those_beside_them_where_they_are():
    run = prepared(reaching(FAR))
    soft = run_of(replace(run.asked, softness=(*run.asked.softness[:-1], np.full(FRAMES, 0.01))))
    motion = solve_frames(soft, MOTION, reference=MOTION, pull_root=False).motion
    hardly = PassedBefore(None, motion, np.full(FRAMES, 1e-9))
    moved = []
    for again in (soft, hardly.eased(soft)):
        after = solve_frames(again, motion, reference=motion, pull_root=True).motion
        moved.append(rot.angle_between(after.rotations, motion.rotations).max())
    assert moved[0] > 0.01
    assert moved[1] < 0.05 * moved[0]
