"""What a viewer would see is seen, and calmed: what need not be met gives way further where it is to blame."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, edited, end, held_feet, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward
from motionedit.core.priorities.continuity import calming
from motionedit.core.priorities.continuity.calming import calmed
from motionedit.core.priorities.continuity.giving_way import within_reach
from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.continuity.smoothing import PassedBefore
from motionedit.core.priorities.continuity.visible import Seen
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.frames import run_of, solve_frames
from motionedit.core.priorities.kinds import CenterOfMass, Position
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.targets import lefts_of
from motionedit.core.priorities.trajectories.positions import ControlPoint

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


def stiff_run():
    """Return an edit that is feasible, of a body with stiffness."""
    body = replace(BODY, mobility=np.ones(len(MOTION.skeleton)))
    return prepare(MOTION, [*held_feet(FRAMES), reaching((0.0, 0.25, 0.3), ease=3)], body, SMOOTH)[0]


def test_the_world_transforms_that_were_looked_at_are_the_calm_motions_own():
    state = solve_in_passes(stiff_run(), Passes()).state
    poses = forward(state.motion)
    np.testing.assert_array_equal(state.poses.positions, poses.positions)
    np.testing.assert_array_equal(state.poses.rotations, poses.rotations)


def looking_so(monkeypatch, *found):
    """Let each look at a solution find what is seen at all frames, one after the other."""
    seen = (Seen(np.full(FRAMES, float(each)), np.zeros(FRAMES)) for each in found)
    monkeypatch.setattr(calming, "seen_of", lambda *_, **__: next(seen))


def of_two_layers(monkeypatch, *found, shift=FAR):
    """Return an edit's hand where looks at the whole, at the feet, and at the hand, tried again, find so much."""
    run = prepared(reaching(shift))
    before = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    tried = []
    smooth = calming._smooth
    monkeypatch.setattr(calming, "_smooth", lambda *asked: tried.append(smooth(*asked)) or tried[-1])
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


@pytest.mark.parametrize(
    ("jerks", "kept"), [([1.14], 0), ([1.2, 1.19], 1), ([1.2, 1.2], 0), ([1.5, 1.4], 1), ([1.5, 1.6], 0)]
)
def test_passes_with_a_firm_root_are_kept_where_the_body_jerks_less(jerks, kept, monkeypatch):
    run = stiff_run()
    before = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    tried = []
    passes = calming.in_passes
    monkeypatch.setattr(calming, "in_passes", lambda run, *more: tried.append(passes(run, *more)) or tried[-1])
    none = np.zeros(FRAMES)
    seen = (Seen(none, none, each) for each in jerks)
    monkeypatch.setattr(calming, "seen_of", lambda *_, **__: next(seen))
    after = calmed(before, Passes())
    assert len(tried) == len(jerks) - 1
    assert after is [before.state, *tried][kept]


def test_a_firm_root_is_not_kept_where_more_is_seen(monkeypatch):
    run = stiff_run()
    before = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    seen = (Seen(np.full(FRAMES, much), np.zeros(FRAMES), jerk) for much, jerk in ((0.0, 1.5), (1.0, 1.2)))
    monkeypatch.setattr(calming, "seen_of", lambda *_, **__: next(seen))
    assert calmed(before, Passes()) is before.state


def test_passes_with_a_firm_root_shift_it_less_and_meet_the_goals():
    run = stiff_run()
    found = within_reach(run, solve_frames(run, MOTION, reference=MOTION, pull_root=False), Passes())
    layers = calming._Layers(run.asked, found.state, Seen(np.zeros(FRAMES), np.zeros(FRAMES), 9.0))
    firm = calming._steadied(layers, Passes()).state.motion
    assert firm is not found.state.motion
    shifts = [np.abs(np.diff(each.translations, 3, axis=0)).sum() for each in (found.state.motion, firm)]
    assert shifts[1] < shifts[0]
    assert np.array(lefts_of(run.asked, firm))[:, 35:51].max() < 1e-4


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


@pytest.mark.parametrize(("softness", "much"), [(0.01, 0.990099), (1e-3, 0.5), (1e-5, 1e-4)])
def test_soft_goals_are_eased_by_how_soft_they_are_where_frames_are_not_solved_on(softness, much):
    run = prepared(reaching(FAR))
    soft = run_of(replace(run.asked, softness=(*run.asked.softness[:-1], np.full(FRAMES, softness))))
    share = np.zeros(FRAMES)
    share[40:45] = 1.0, 0.75, 0.5, 0.25, 0.0
    own, eased = soft.asked.targets, PassedBefore(None, MOTION, share).eased(soft).asked.targets
    assert all(one is other for one, other in zip(own[:-1], eased[:-1], strict=True))
    here = slice(40 - own[-1].first, 45 - own[-1].first)
    toward = path(MOTION, "RightHand")[40:45] - own[-1].positions[here]
    part = much * np.array([[0.0], [0.25], [0.5], [0.75], [1.0]])
    np.testing.assert_allclose(eased[-1].positions[here] - own[-1].positions[here], part * toward, atol=1e-5)
