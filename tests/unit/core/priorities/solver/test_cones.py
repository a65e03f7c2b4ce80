"""Joints stay within their cones, whatever pulls at them, and both solvers keep them there alike."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, end, held_feet, swaying

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.limits import NO_LIMITS, human_limits, swing_and_twist
from motionedit.core.compiled import compiled
from motionedit.core.kinematics import forward
from motionedit.core.priorities.edit import edit_by_priorities, prepare
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.core.priorities.targets import lefts_of
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 40
MOTION = swaying(FRAMES)
LIMITS = human_limits(MOTION, forward(MOTION), find_anatomy(MOTION.skeleton), travel=BODY.travel, first=0)


def as_wide(swing, twist):
    return replace(LIMITS, swing=np.full(len(LIMITS), swing), twist=np.full(len(LIMITS), twist))


TIGHT = as_wide(0.2, 0.1)
HARD = LayeredSettings(smoothing=PaperFilter(0))


def reaching(shift):
    point = ControlPoint("hold", 15, 25, None, np.array(shift))
    return Position(name="hand", priority=4, effector=end("RightHand"), points=(point,), ease_in=10, ease_out=10)


def asked(shift=(0.1, 0.2, 0.25)):
    return [*held_feet(FRAMES), reaching(shift)]


def edit_within(limits, shift=(0.1, 0.2, 0.25), settings=HARD):
    return edit_by_priorities(MOTION, asked(shift), replace(BODY, limits=limits), settings)


def beyond(motion):
    """Return by how much any joint that is no hinge is beyond its tight cone, rad."""
    kept = ~np.isin(TIGHT.joints, [hinge.joint for hinge in BODY.hinges])
    q = rot.multiply(rot.conjugate(TIGHT.centers[kept]), motion.rotations[:, TIGHT.joints[kept]])
    swing, twist = swing_and_twist(q, TIGHT.along[kept])
    return max(np.max(swing - TIGHT.swing[kept]), np.max(np.abs(twist) - TIGHT.twist[kept]))


@pytest.mark.parametrize("solver", ["", "numpy"])
def test_joints_stay_within_their_cones_and_the_feet_stay_where_they_are(solver, monkeypatch):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
    free, kept = edit_within(NO_LIMITS), edit_within(TIGHT)
    assert beyond(free.motion) > 0.05
    assert beyond(kept.motion) < max(2e-6, beyond(MOTION) + 2e-6)
    *feet, hand = lefts_of(kept.asked, kept.motion)
    assert np.max(feet) < 1e-4
    assert hand.max() < 1e-4  # other joints do what these may not


def test_both_solvers_keep_cones_alike(monkeypatch):
    if compiled() is None:
        pytest.skip("no compiled solver here")
    one = edit_within(TIGHT)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    other = edit_within(TIGHT)
    assert one.solver == "compiled"
    np.testing.assert_array_equal(one.iterations, other.iterations)
    assert rot.angle_between(one.motion.rotations, other.motion.rotations).max() < 1e-9


def test_where_no_cone_is_passed_nothing_changes_to_the_last_bit():
    wide = as_wide(np.pi, np.pi)
    np.testing.assert_array_equal(edit_within(wide).motion.rotations, edit_within(NO_LIMITS).motion.rotations)


def test_a_hinge_has_limits_of_its_own_and_no_cone():
    run, _ = prepare(MOTION, asked(), replace(BODY, limits=LIMITS), HARD)
    hinged = {hinge.joint for hinge in BODY.hinges}
    for group in run.groups:
        columns, limits = group.problem.columns, group.problem.limits
        assert not hinged & set(columns.joints[limits.places].tolist())
