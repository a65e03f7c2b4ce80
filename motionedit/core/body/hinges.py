"""Hinges: knees and elbows that bend about one axis in the input, with the limits they keep to."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

OFF_AXIS_ENERGY = 0.005  # of the whole: above it a joint is no hinge
FULL_BEND = float(np.radians(150.0))  # where a knee or an elbow ends, unless the input bends it further
# What the hinge of a joint with few channels may turn: all there is.
ANY_ANGLE = (-2.0 * np.pi, 2.0 * np.pi)
_STRAIGHT = float(np.radians(1.0))  # root mean square: a joint that hardly bends shows no axis


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint that turns about one axis fixed in its own frame.

    Attributes
    ----------
    axis : shape (3,)
        Unit vector, signed so that the input's mean angle is positive.
    limits : (low, high), rad
        [min(0, the input's least), max(150 degrees, the input's largest)].
    off_axis : float
        Share of the rotation's energy that is not about the axis, 0 to 1.
    is_second : bool
        Whether it is the second of two hinges of its joint: the first one's axis is fixed in the parent's frame, its
        own in the joint's.
    """

    joint: int
    axis: FloatArray
    limits: tuple[float, float]
    off_axis: float
    is_second: bool = False


def find_hinges(motion: Motion, anatomy: Anatomy, *, first: int) -> list[Hinge]:
    """Return the knees and elbows that are hinges, left before right, knees first.

    Frames before `first`, a rest pose, are left out.
    """
    joints = [leg.knee for leg in anatomy.legs or ()] + [arm.elbow for arm in anatomy.arms or ()]
    found = (hinge_of(motion, joint, first=first) for joint in joints)
    return [hinge for hinge in found if hinge is not None and hinge.off_axis < OFF_AXIS_ENERGY]


def channel_hinges(skeleton: Skeleton) -> dict[int, tuple[Hinge, ...]]:
    """Return the one or two hinges of each joint whose file has as many rotation channels: it turns about no more.

    R = R_i(a) R_j(b): what the file turns last is about an axis of the parent's frame, what it turns first about one
    of the joint's own.
    """
    found = {}
    for joint, axes in enumerate(skeleton.rotation_axes):
        if len(axes) in {1, 2}:
            hinges = (Hinge(joint, frozen(np.eye(3)[axis]), ANY_ANGLE, 0.0, i == 1) for i, axis in enumerate(axes))
            found[joint] = tuple(hinges)
    return found


def with_limits_of(hinges: tuple[Hinge, ...], found: Hinge) -> tuple[Hinge, ...]:
    """Return a joint's channel hinges, the one whose axis is nearest with the limits of the hinge found there."""
    along = [float(hinge.axis @ found.axis) for hinge in hinges]
    nearest = int(np.argmax(np.abs(along)))
    low, high = found.limits if along[nearest] > 0.0 else (-found.limits[1], -found.limits[0])
    return tuple(replace(each, limits=(low, high)) if i == nearest else each for i, each in enumerate(hinges))


def hinge_of(motion: Motion, joint: int, *, first: int) -> Hinge | None:
    """Return the hinge that fits a joint best, however badly; None where it does not bend.

    Uncentred PCA of v = log q(t): the axis is the first eigenvector of sum v v^T.
    """
    v = rot.log(motion.rotations[first:, joint])
    energies, axes = np.linalg.eigh(v.T @ v)
    total = float(energies.sum())
    if total < len(v) * _STRAIGHT**2:
        return None
    axis = axes[:, -1]
    angles = v @ axis
    if angles.sum() < 0.0:
        axis, angles = -axis, -angles
    limits = min(0.0, float(angles.min())), max(FULL_BEND, float(angles.max()))
    off_axis = float(np.clip(1.0 - energies[-1] / total, 0.0, 1.0))
    return Hinge(joint, frozen(axis), limits, off_axis)
