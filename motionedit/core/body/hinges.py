"""Hinges: knees and elbows that bend about one axis in the input, with the limits they keep to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

OFF_AXIS_ENERGY = 0.005  # of the whole: above it a joint that a user calls a hinge is none in the input
FULL_BEND = float(np.radians(150.0))  # where a knee or an elbow ends, unless the input bends it further
# What the hinge of a joint with few channels may turn: all there is.
ANY_ANGLE = (-2.0 * np.pi, 2.0 * np.pi)
_LEAST_BEND = float(np.radians(3.0))  # a limb that an edit stretches stays bent so much: straight, it has no side
_STRAIGHT = float(np.radians(1.0))  # root mean square: a joint that hardly bends shows no axis


@dataclass(frozen=True, eq=False)
class Hinge:
    """A joint that turns about one axis.

    Attributes
    ----------
    axis : shape (3,)
        Unit vector in the frame of the joint's parent; a second hinge's in the joint's own.
    upper, lower : shape (3,)
        Its angle is the one about the axis from `upper`, in the parent's frame, to `lower`, in the joint's.
    limits : (low, high), rad
    off_axis : float
        Share of the input's rotation that is not about the axis, 0 to 1, where that is known.
    is_second : bool
        Whether it is the second of two hinges of its joint.
    """

    joint: int
    axis: FloatArray
    upper: FloatArray
    lower: FloatArray
    limits: tuple[float, float]
    off_axis: float = 0.0
    is_second: bool = False


def find_hinges(bends: Sequence[Bend]) -> list[Hinge]:
    """Return the knees and elbows as hinges, in their order.

    What an edit adds to one is about the axis that it bends about, however noisy the input is about the others; it
    keeps within [min(3 degrees, the input's least), max(150 degrees, the input's largest)] of its bend.
    """
    return [Hinge(each.joint, each.axis, each.upper, each.lower, _limits(*each.bent, _LEAST_BEND)) for each in bends]


def plain_hinge(joint: int, axis: FloatArray, limits: tuple[float, float], off_axis: float = 0.0) -> Hinge:
    """Return a hinge whose angle is 0 where its joint is not turned."""
    side = frozen(_square_to(axis))
    return Hinge(joint, frozen(axis), side, side, limits, off_axis)


def channel_hinges(skeleton: Skeleton) -> dict[int, tuple[Hinge, ...]]:
    """Return the one or two hinges of each joint whose file has as many rotation channels: it turns about no more.

    R = R_i(a) R_j(b): what the file turns last is about an axis of the parent's frame, what it turns first about one
    of the joint's own.
    """
    found = {}
    for joint, axes in enumerate(skeleton.rotation_axes):
        if len(axes) in {1, 2}:
            # What is along the other one's axis shows the angle about each.
            other = np.eye(3)[list(axes[::-1])] if len(axes) == 2 else [_square_to(np.eye(3)[axes[0]])]
            found[joint] = tuple(
                Hinge(joint, frozen(np.eye(3)[axis]), frozen(side), frozen(side), ANY_ANGLE, is_second=i == 1)
                for i, (axis, side) in enumerate(zip(axes, other, strict=True))
            )
    return found


def with_limits_of(hinges: tuple[Hinge, ...], found: Hinge) -> tuple[Hinge, ...]:
    """Return a joint's channel hinges, the one whose axis is nearest with the limits of the hinge found there."""
    along = [float(hinge.axis @ found.axis) for hinge in hinges]
    nearest = int(np.argmax(np.abs(along)))
    low, high = found.limits if along[nearest] > 0.0 else (-found.limits[1], -found.limits[0])
    limited = replace(hinges[nearest], upper=found.upper, lower=found.lower, limits=(low, high))
    return tuple(limited if i == nearest else each for i, each in enumerate(hinges))


def hinge_of(motion: Motion, joint: int, *, first: int) -> Hinge | None:
    """Return the hinge that fits a joint best, however badly; None where it does not bend.

    Uncentred PCA of v = log q(t): the axis is the first eigenvector of sum v v^T, signed so that the mean angle is
    positive. Frames before `first`, a rest pose, are left out.
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
    off_axis = float(np.clip(1.0 - energies[-1] / total, 0.0, 1.0))
    return plain_hinge(joint, axis, _limits(float(angles.min()), float(angles.max()), 0.0), off_axis)


def _limits(least: float, most: float, least_bend: float) -> tuple[float, float]:
    return min(least_bend, least), max(FULL_BEND, most)


def _square_to(axis: FloatArray) -> FloatArray:
    """Return a unit vector square to an axis."""
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    square: FloatArray = side / np.linalg.norm(side)
    return square
