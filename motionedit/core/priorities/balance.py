"""Where the center of mass shall be: it goes with its support, by default as in the input ([PRIO] section 4.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core.priorities.constraints import Constraint, Targets
from motionedit.core.priorities.trajectories import position_targets

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import WorldPoses


def support_points(constraint: Constraint, poses: WorldPoses, goals: Mapping[int, FloatArray] | None) -> FloatArray:
    """Return the mean of the support A, shape (F, 3): goals (F, 3; nan where there is none) stand before poses."""
    places = poses.positions[:, list(constraint.support)].copy()
    for i, joint in enumerate(constraint.support):
        if goals is not None and joint in goals:
            places[:, i] = np.where(np.isnan(goals[joint]), places[:, i], goals[joint])
    mean: FloatArray = places.mean(axis=1)
    return mean


def com_targets(
    constraint: Constraint,
    poses: WorldPoses,
    path: FloatArray,
    *,
    support: FloatArray | None,
    curve: Literal["time", "index"],
) -> Targets:
    """Return the CoM's targets, P' = mean(A') + K (P - mean(A)) with K = 1, and the points' displacement map on it.

    Parameters
    ----------
    poses : WorldPoses
        The input's.
    path : shape (F, 3)
        The input's center of mass.
    support : shape (F, 3) or None
        mean(A') of the edited motion; None: the input's own path.
    """
    if support is not None and constraint.support:
        path = support + path - support_points(constraint, poses, None)
    along = path @ constraint.measure.T
    first, last = constraint.active(len(path))
    _, positions = position_targets(
        along, constraint.points, ease_in=constraint.ease_in, ease_out=constraint.ease_out, curve=curve
    )
    return Targets(first, last, positions)
