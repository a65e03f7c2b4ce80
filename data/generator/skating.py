"""The walk's skating twin: the same body and path, but its feet slide to and fro, as retargeted or noisy takes do.

The walk itself is the truth beside it: only the legs differ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.feet.knees import knee_of
from motionedit.core.feet.legs import LegGoal, legs_onto
from motionedit.core.kinematics import forward

if TYPE_CHECKING:
    from motionedit.core.motion import Motion

# Each foot's way from its true place: cm, Hz and turns of a sine along x, then along z; the second foot's comes later.
_WAYS = (((1.3, 1.3, 0.1), (0.7, 2.3, 0.6)), ((1.8, 1.1, 0.35), (0.8, 2.6, 0.8)))
_LATER = 0.4  # turns


def skating(walk: Motion) -> Motion:
    """Return a walk (cm, y up) whose feet slide by some centimetres, its body as it was."""
    anatomy = anatomy_of(walk)
    poses, times = forward(walk), walk.frame_time * np.arange(len(walk))
    bends = {bend.joint: bend for bend in find_bends(walk.skeleton, poses, anatomy, first=0)}
    goals = []
    for number, leg in enumerate(anatomy.legs or ()):
        places = poses.positions[:, leg.ankle].copy()
        for axis, waves in zip((0, 2), _WAYS, strict=True):
            for size, rate, turn in waves:
                places[:, axis] += size * np.sin(2.0 * np.pi * (rate * times + turn + _LATER * number))
        knee = knee_of(walk.skeleton, poses, leg, bends[leg.knee])
        goals.append(LegGoal(leg, knee, places, poses.rotations[:, leg.ankle]))
    return legs_onto(walk, poses, goals)
