"""Frames solved one after the other: what a constraint controls starts where it was in the frame before, eq. (4)."""

import numpy as np
import pytest
from human import standing, with_rotation
from person import BODY, SKELETON, end, joint, path, swaying

from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.core.priorities.trajectories.positions import ControlPoint

# One iteration a frame: how far each comes shows where it started.
IN_ORDER = LayeredSettings(smoothing=PaperFilter(0), max_iterations=1)
FRAMES = 12
ARM = RecruitRule("joints", joints=tuple(map(joint, ("LeftArm", "LeftForeArm"))))
LEG = RecruitRule("joints", joints=tuple(map(joint, ("RightUpLeg", "RightLeg"))))
TRUNK = RecruitRule("joints", joints=(joint("Spine"),), root=True)


SHIFT = np.array([0.05, 0.1, 0.1])


def moved(first, last, recruit, name="LeftHand", priority=1):
    point = ControlPoint("hold", first, last, None, SHIFT)
    times = {"points": (point,), "ease_in": 0, "ease_out": 0}
    return Position(name=name, effector=end(name), recruit=recruit, priority=priority, **times)


def errors_of(motion, *constraints):
    """Return how far the left hand is from where it is wanted, shape (F,)."""
    after = edit_by_priorities(motion, constraints, BODY, IN_ORDER).motion
    return np.linalg.norm(path(after, "LeftHand") - path(motion, "LeftHand")[0] - SHIFT, axis=1)


@pytest.mark.parametrize("solver", ["", "numpy"])
@pytest.mark.parametrize("recruit", [ARM, TRUNK])
def test_each_frame_goes_on_from_where_the_one_before_it_came_whatever_else_is_asked_there(
    recruit, solver, monkeypatch
):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
    motion = standing(SKELETON, FRAMES)
    hand, other = moved(0, FRAMES - 1, recruit), moved(4, 7, LEG, "RightFoot", priority=0)
    alone, beside = errors_of(motion, hand), errors_of(motion, hand, other)
    assert (alone[4:] < 0.5 * alone[0]).all()
    np.testing.assert_allclose(beside, alone, rtol=1e-6, atol=1e-15)


@pytest.mark.parametrize("first", [1, 2, 3, 4, 5])
def test_the_first_frame_of_a_constraint_starts_from_the_input(first):
    motion = swaying(FRAMES)
    for frame in range(FRAMES):
        motion = with_rotation(motion, "LeftArm", frame, (0.05 * frame, 0.0, 0.1))
    alone = motion.at(slice(first, None))
    whole = edit_by_priorities(motion, [moved(first, FRAMES - 1, ARM)], BODY, IN_ORDER).motion
    cut = edit_by_priorities(alone, [moved(0, FRAMES - 1 - first, ARM)], BODY, IN_ORDER).motion
    np.testing.assert_allclose(whole.rotations[first:], cut.rotations, atol=1e-12)
    np.testing.assert_array_equal(whole.rotations[:first], motion.rotations[:first])
