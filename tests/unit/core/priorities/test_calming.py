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
from motionedit.core.priorities.visible import jerks_at, steps_at, unrest

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
    assert unrest(run, MOTION) == (0.0, 0.0)
    after = turned(30.0, [40])
    steps, jerks = steps_at(run, after), jerks_at(run, after)
    assert list(np.flatnonzero(steps)) == [39, 40, 41]
    assert np.degrees(steps.max()) == pytest.approx(30.0)
    assert {39, 40, 41} <= set(np.flatnonzero(jerks)) <= {38, 39, 40, 41, 42}
    assert unrest(run, after) == (steps.max(), jerks.max())


def test_a_body_that_jerks_without_a_step_is_seen():
    step, jerk = unrest(prepared(), turned(4.0, slice(40, 60, 2), "Hips"))
    assert step == 0.0
    assert jerk > 1.0


def test_a_clip_of_few_frames_jerks_nowhere():
    short = MOTION.at(slice(0, 3))
    run = prepare(short, held_feet(3), BODY, SMOOTH)[0]
    assert unrest(run, short) == (0.0, 0.0)


@pytest.mark.parametrize(("seen", "best"), [([5, 3, 4, 2], 3), ([5, 3, 4, 6], 1), ([5, 6, 7, 8], 0), ([5, 0, 9, 9], 1)])
def test_the_calmest_solution_is_kept(seen, best, monkeypatch):
    run = prepared()
    first, *others = [solve_frames(run, MOTION, reference=MOTION, pull_root=False) for _ in seen]
    solutions, looks = iter(others), iter(seen)
    monkeypatch.setattr(calming, "unrest", lambda *_: (float(next(looks)), 0.0))
    monkeypatch.setattr(calming, "_yielding", lambda found, *_: replace(found.run.asked))
    monkeypatch.setattr(calming, "_solved", lambda *_: next(solutions))
    found = calming.Reached(run, first)
    assert calmed(found, Passes()) is [first, *others][best]


def test_whether_a_layer_is_to_blame_is_judged_without_what_is_below(monkeypatch):
    run = prepared(reaching(FAR), CenterOfMass(name="com", priority=2))
    seen = []
    monkeypatch.setattr(calming, "unrest", lambda *_: (0.0, 0.0))
    alone = solve_in_passes(run_of(run.asked.only(range(len(held_feet(FRAMES)) + 1))), Passes())
    monkeypatch.setattr(calming, "unrest", lambda *_: (1.0, 0.0))
    monkeypatch.setattr(calming, "is_seen_at", lambda _, motion: seen.append(motion) or np.zeros(FRAMES, dtype=bool))
    solve_in_passes(run, Passes())
    _, hand, _ = seen
    assert rot.angle_between(hand.rotations, alone.state.motion.rotations).max() < 1e-6


@pytest.mark.parametrize(("shift", "gives_way"), [(FAR, True), ((0.0, 0.05, 0.1), False)])
def test_of_goals_that_count_only_a_missed_one_gives_way_further(shift, gives_way, monkeypatch):
    edit = edited(MOTION, [*held_feet(FRAMES), reaching(shift)], SMOOTH)
    assert (np.max(lefts_of(edit.asked, edit.motion)[-1]) > 1e-4) == gives_way
    run = prepared(reaching(shift))
    before = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    monkeypatch.setattr(calming, "unrest", lambda *_: (1.0, 0.0))
    levels = iter([False, True] * 3)
    monkeypatch.setattr(calming, "is_seen_at", lambda *_: np.full(FRAMES, next(levels)))
    after = calming._yielding(before, Passes(), 4.0)
    assert (after is not before.run.asked) == gives_way


def test_frames_that_are_not_solved_on_leave_those_beside_them_where_they_are():
    run = prepared(reaching(FAR))
    soft = run_of(replace(run.asked, softness=(*run.asked.softness[:-1], np.full(FRAMES, 0.01))))
    motion = solve_frames(soft, MOTION, reference=MOTION, pull_root=False).motion
    hardly = PassedBefore(None, motion, np.full(FRAMES, 1e-9))
    for again, moves in ((soft, True), (hardly.eased(soft), False)):
        after = solve_frames(again, motion, reference=motion, pull_root=True).motion
        assert (rot.angle_between(after.rotations, motion.rotations).max() > 1e-3) == moves
