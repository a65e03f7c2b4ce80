"""Legs that draw up as a body does it by itself: knees bend, hips and ankles turn, and the rest stays as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto, turns_freely
from motionedit.core.feet.reach import stretch
from motionedit.core.kinematics import forward
from motionedit.core.smooth import no_more_than

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.motion import Motion

# Of a leg that is straight: no ankle comes nearer to the hip's height, and one that should does less and less of it.
_NEAREST = 0.4


def drawn_up(motion: Motion, legs: Sequence[Leg], bends: Sequence[Bend], *, by: FloatArray, up: FloatArray) -> Motion:
    """Return a motion whose ankles are higher, each foot turned as it was, by the legs' joints alone.

    Legs whose joints do not turn freely stay as they are.

    Parameters
    ----------
    by : shape (F, L)
        By how much each leg's ankle shall be higher, clip units.
    up : shape (3,)
    """
    knees, poses = {bend.joint: bend for bend in bends}, forward(motion)
    goals = []
    for leg, wanted in zip(legs, by.T, strict=True):
        if leg.knee not in knees or not turns_freely(motion.skeleton, leg):
            continue
        hip, ankle = poses.positions[:, leg.thigh], poses.positions[:, leg.ankle]
        _, length = stretch(poses, leg)
        (rise,) = no_more_than((hip - ankle) @ up - _NEAREST * length, wanted)
        bend = knee_of(motion.skeleton, poses, leg, knees[leg.knee])
        goals.append(LegGoal(leg, bend, ankle + rise[:, None] * up, poses.rotations[:, leg.ankle]))
    return legs_onto(motion, poses, goals)
