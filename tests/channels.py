"""Motions out of plain channel values."""

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion, write_poses


def motion_from_channels(skeleton, values, *, frame_time):
    """Return the motion of a file's rows, shape (F, C): degrees and clip units."""
    rotations = np.empty((len(values), len(skeleton), 4))
    translations = np.empty((len(values), len(skeleton.translated), 3))
    write_poses(skeleton, values, rotations=rotations, translations=translations)
    return Motion(skeleton, frozen(rotations), frozen(translations), frame_time)
