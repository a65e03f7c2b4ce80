"""World-axis increments of a joint, which the unknowns of a solve are: what Jacobians are differences by."""

from dataclasses import replace

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward


def turned(motion, joint, w):
    """Return the motion with one joint turned by a world rotation vector: q <- exp(R_parent^-1 w) q."""
    parent = motion.skeleton.parents[joint]
    local = np.broadcast_to(w, (len(motion), 3))
    if parent >= 0:
        local = rot.rotate(rot.conjugate(forward(motion).rotations[:, parent]), local)
    rotations = motion.rotations.copy()
    rotations[:, joint] = rot.multiply(rot.exp(local), rotations[:, joint])
    return replace(motion, rotations=rotations)
