"""What is left of a constraint after an edit, frame by frame, measured by forward kinematics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import WorldPoses, effector_positions
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.constraints import Constraint, Targets
    from motionedit.core.priorities.sight import Sight


@dataclass(frozen=True, eq=False)
class ConstraintErrors:
    """What is left of a constraint: frames `first` on; lengths (n,) and radians (n,), None where it has none.

    `places` (n, 3) is where its effector is wanted in the world, or what an aim looks at; None for what only turns.
    Along axes that the constraint leaves free it is where the effector is.
    """

    first: int
    positions: FloatArray | None
    angles: FloatArray | None
    places: FloatArray | None = None


def errors_of(
    constraint: Constraint, targets: Targets, sight: Sight, motion: Motion, *, reference: Motion
) -> ConstraintErrors:
    """Return the errors of a constraint over its active interval, not weighted.

    Parameters
    ----------
    sight, motion
        The edited motion.
    reference : Motion
        The input.
    """
    span, poses = slice(targets.first, targets.last + 1), sight.poses
    if constraint.kind == "posture":
        joints = list(constraint.joints)
        off = rot.angle_between(motion.rotations[span, joints], reference.rotations[span, joints])
        return ConstraintErrors(targets.first, None, off.max(axis=1, initial=0.0))
    if constraint.kind == "com":
        path = sight.center[span] @ constraint.measure.T
        wanted = _wanted(constraint, targets, path)
        distance: FloatArray = np.linalg.norm(path - wanted, axis=1)
        return ConstraintErrors(targets.first, distance, None, wanted @ constraint.measure)
    joint = constraint.effector.joint
    place, turn = effector_positions(poses, constraint.effector)[span], poses.rotations[span, joint]
    if constraint.kind == "aim":
        at = targets.positions
        if constraint.aim_base is not None and at is not None:
            base = constraint.aim_base
            at = poses.positions[span, base] + rot.rotate(poses.rotations[span, base], at)
        return ConstraintErrors(targets.first, None, _off_aim(constraint, place if at is None else at, place, turn), at)
    if constraint.base is not None:
        inverse = rot.conjugate(poses.rotations[span, constraint.base])
        place = rot.rotate(inverse, place - poses.positions[span, constraint.base])
        turn = rot.multiply(inverse, turn)
    else:
        place = place @ constraint.measure.T
    angles = None if targets.rotations is None else rot.angle_between(turn, targets.rotations)
    if targets.positions is None:
        return ConstraintErrors(targets.first, None, angles)
    wanted = _wanted(constraint, targets, place)
    away: FloatArray = np.linalg.norm(place - wanted, axis=1)
    return ConstraintErrors(targets.first, away, angles, _in_world(constraint, wanted, poses, span))


def _wanted(constraint: Constraint, targets: Targets, path: FloatArray) -> FloatArray:
    """Return where the path should be along the axes that count, and where it is along the others, (n, 3)."""
    wanted = path.copy()
    if targets.positions is not None:
        axes = list(constraint.axes)
        wanted[:, axes] = targets.positions[:, axes]
    return wanted


def _in_world(constraint: Constraint, places: FloatArray, poses: WorldPoses, span: slice) -> FloatArray:
    """Return places along the measuring axes, or in the base's frame, as world positions, (n, 3)."""
    if constraint.base is None:
        return places @ constraint.measure
    world: FloatArray = poses.positions[span, constraint.base] + rot.rotate(
        poses.rotations[span, constraint.base], places
    )
    return world


def _off_aim(constraint: Constraint, at: FloatArray, place: FloatArray, turn: FloatArray) -> FloatArray:
    look = rot.rotate(turn, constraint.axis)
    way = at - place
    across = np.linalg.norm(rot.cross(look, way), axis=1)
    angle: FloatArray = np.arctan2(across, np.sum(look * way, axis=1))
    return angle
