"""Motions for the tests of the command line."""

import numpy as np
from channels import motion_from_channels

from motionedit.core.skeleton import EndSite, Skeleton

_ROOT = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
_JOINT = ("Zrotation", "Xrotation", "Yrotation")


def make_motion(*, frames=8, seed=0, frame_time=1 / 30, names=("Hips", "LeftArm", "LeftForeArm")):
    """Return a chain that moves a little, each joint 10 above its parent."""
    offsets = np.array([[0.0, 0.0, 0.0], *([[0.0, 10.0, 0.0]] * (len(names) - 1))])
    skeleton = Skeleton(
        tuple(names),
        np.arange(-1, len(names) - 1),
        offsets,
        (_ROOT, *([_JOINT] * (len(names) - 1))),
        (EndSite(len(names) - 1, np.array([0.0, 10.0, 0.0])),),
    )
    steps = np.random.default_rng(seed).normal(size=(frames, skeleton.channel_count))
    return motion_from_channels(skeleton, 10.0 + np.cumsum(steps, axis=0), frame_time=frame_time)
