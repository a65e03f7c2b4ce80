"""A joint that turns past half a turn from its goal goes there on one side, and no arm swings over within a frame."""

import numpy as np
import pytest
from human import with_rotation
from person import BODY, edited, end, held_feet, swaying

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.kinds import Orientation
from motionedit.core.priorities.settings import LayeredSettings
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 60


def twisting(turn):
    """Return a person whose hand twists so far (rad) and back in its wrist."""
    motion = swaying(FRAMES)
    for frame in range(FRAMES):
        angle = turn * np.sin(np.pi * frame / (FRAMES - 1)) ** 2
        motion = with_rotation(motion, "RightHand", slice(frame, frame + 1), (angle, 0.3 * angle, 0.0))
    return motion


def turned_back(motion):
    """Return a hand that is held as it is in the first frame, all the time."""
    start = forward(motion).rotations[0, end("RightHand").joint]
    point = ControlPoint("hold", 0, FRAMES - 1, orientation=start)
    return Orientation(name="palm", priority=4, effector=end("RightHand"), points=(point,))


@pytest.mark.parametrize("turn", [2.5, 3.3, 4.5])
def test_a_hand_that_twists_past_half_a_turn_from_its_hold_is_held_without_a_jump(turn):
    motion = twisting(turn)
    palm = turned_back(motion)
    edit = edited(motion, [*held_feet(FRAMES), palm], LayeredSettings())
    steps = rot.angle_between(edit.motion.rotations[1:], edit.motion.rotations[:-1])
    own = rot.angle_between(motion.rotations[1:], motion.rotations[:-1])
    assert edit.errors[-1].angles.max() < 1e-4
    assert np.all(steps.max(axis=0) < np.maximum(1.5 * own.max(axis=0), 0.1))


def test_what_turns_by_less_is_solved_once():
    motion = twisting(1.5)
    run, _ = prepare(motion, [turned_back(motion)], BODY, LayeredSettings())
    assert run.asked.arcs == (None,)
