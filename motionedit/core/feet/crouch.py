"""A body that goes down by its legs: knees bend, hips and ankles turn, and feet stay where they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto, turns_freely
from motionedit.core.kinematics import forward

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.motion import Motion

# Metres at a leg of 0.85 m: no body goes lower by its legs, and one that should does less and less of it.
_LOWEST = 0.6


def crouched(motion: Motion, legs: Sequence[Leg], bends: Sequence[Bend], *, down: FloatArray, up: FloatArray) -> Motion:
    """Return a motion whose legs are bent as if its hips were lower, the rest of it as it is.

    Legs whose joints do not turn freely stay as they are.

    Parameters
    ----------
    down : shape (F,)
        How far the body is to go down, normalised metres.
    up : shape (3,)
    """
    knees, poses = {bend.joint: bend for bend in bends}, forward(motion)
    goals = [
        LegGoal(
            leg,
            knee_of(motion.skeleton, poses, leg, knees[leg.knee]),
            poses.positions[:, leg.ankle],
            poses.rotations[:, leg.ankle],
        )
        for leg in legs
        if leg.knee in knees and turns_freely(motion.skeleton, leg)
    ]
    lower = down * (1.0 + (down / _LOWEST) ** 4) ** -0.25
    return legs_onto(motion, poses, goals, shift=-lower[:, None] * up)
