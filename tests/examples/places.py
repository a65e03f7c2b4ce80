"""Where a shipped clip has a joint and the club's head."""

import numpy as np

from motionedit.core import kinematics

CLUB_HEAD = np.array([0.0, -92.0, 0.0])


def joint(motion, poses, name):
    return poses.positions[:, motion.skeleton.names.index(name)]


def club_head(motion, poses):
    club = motion.skeleton.names.index("Club")
    return kinematics.effector_positions(poses, kinematics.Effector(club, CLUB_HEAD))
