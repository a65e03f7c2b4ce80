"""A person with bent knees and elbows who sways a little, and what is often asked of such a one."""

import numpy as np
from human import skeleton_of, standing, with_rotation

from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.settings import Body, LayeredSettings, PaperFilter, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint

SKELETON = skeleton_of()
FEET = ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")
UP = np.array([0.0, 1.0, 0.0])
ONCE = LayeredSettings(smoothing=Passes(0))
# Frame by frame, and nothing gives way: what is out of reach is missed by as little as each frame can.
HARD = LayeredSettings(smoothing=PaperFilter(0))
BODY = Body(find_masses(SKELETON, find_anatomy(SKELETON)), (), 0, 0)
BENDS = {
    "LeftUpLeg": (-0.5, 0.0, 0.0),
    "LeftLeg": (0.9, 0.0, 0.0),
    "LeftFoot": (-0.4, 0.0, 0.0),
    "RightUpLeg": (-0.4, 0.0, 0.0),
    "RightLeg": (0.8, 0.0, 0.0),
    "RightFoot": (-0.4, 0.0, 0.0),
    "RightForeArm": (-0.7, 0.1, 0.0),
    "LeftForeArm": (-0.6, 0.0, 0.1),
}


def swaying(frames):
    """Return the person, who bends to one side in the third quarter of the frames."""
    motion = standing(SKELETON, frames)
    for name, vector in BENDS.items():
        motion = with_rotation(motion, name, slice(None), vector)
    return with_rotation(motion, "Spine", slice(frames // 2, 3 * frames // 4), (0.1, 0.2, 0.0))


def joint(name):
    return SKELETON.names.index(name)


def end(name, offset=(0.0, 0.0, 0.0)):
    return Effector(joint(name), np.array(offset, dtype=float))


def path(motion, name, offset=(0.0, 0.0, 0.0)):
    """Return where a point is, shape (F, 3)."""
    return effector_positions(forward(motion), end(name, offset))


def held(name, frames, shift=(0.0, 0.0, 0.0), **more):
    """Return a constraint that holds a joint where it is in frame 0, shifted, over all frames."""
    point = ControlPoint("hold", 0, frames - 1, None, np.array(shift, dtype=float))
    return Position(name=name, effector=end(name), points=(point,), **more)


def held_feet(frames, priority=10):
    return [held(name, frames, priority=priority) for name in FEET]


def edited(motion, constraints, settings=ONCE, body=BODY):
    return edit_by_priorities(motion, constraints, body, settings)
