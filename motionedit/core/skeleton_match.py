"""Matching two skeletons by joint names: which joint is which, or a message that shows the difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.errors import ClipError

if TYPE_CHECKING:
    from motionedit.core.arrays import IntArray
    from motionedit.core.skeleton import Skeleton

# Offsets may differ by this share of the skeleton's height.
OFFSET_TOLERANCE = 1e-3

# A message names this many joints at most.
_NAMED = 4


def match_joints(reference: Skeleton, other: Skeleton, *, height: float, label: str, against: str) -> IntArray:
    """Return the other's joint of each joint of the reference, shape (J,); the order of joints may differ.

    Parameters
    ----------
    height : float
        The reference's, clip units.
    label, against : str
        The two clips' (or the model's) names, for messages.

    Raises
    ------
    ClipError
        If names, parents or offsets differ; it says which.
    """
    if other is reference:
        return np.arange(len(reference))
    missing = [name for name in reference.names if name not in other.names]
    extra = [name for name in other.names if name not in reference.names]
    if missing or extra or len(reference) != len(other):
        parts = []
        if missing:
            parts.append(f"lacks {_listed(missing)}")
        if extra:
            parts.append(f"also has {_listed(extra)}")
        difference = " and ".join(parts) or f"has {len(other)} joints, not {len(reference)}"
        raise ClipError(f"another skeleton than {against}: {difference}", file=label)
    joint_map = _same_names(reference, other)
    for j, name in enumerate(reference.names):
        here, there = _parent_name(reference, j), _parent_name(other, int(joint_map[j]))
        if here != there:
            message = f"another skeleton than {against}: '{name}' hangs on '{there}', not on '{here}'"
            raise ClipError(message, file=label)
    distance = np.linalg.norm(other.offsets[joint_map] - reference.offsets, axis=1)
    # A position channel takes OFFSET's place: where every axis has one, OFFSET says nothing.
    distance[[j for j, axes in enumerate(reference.position_axes) if len(axes) == 3]] = 0.0
    off = [reference.names[j] for j in np.flatnonzero(distance > OFFSET_TOLERANCE * height)]
    if off:
        message = (
            f"another skeleton than {against}: the offset of {_listed(off)} differs by up to {distance.max():.4g}, "
            f"more than 0.1 % of the height {height:.4g}"
        )
        raise ClipError(message, file=label)
    return joint_map


def _same_names(reference: Skeleton, other: Skeleton) -> IntArray:
    if reference.names == other.names:
        return np.arange(len(reference))
    place = {name: j for j, name in enumerate(other.names)}
    return np.array([place[name] for name in reference.names], dtype=np.intp)


def _parent_name(skeleton: Skeleton, joint: int) -> str:
    parent = int(skeleton.parents[joint])
    return skeleton.names[parent] if parent >= 0 else "nothing"


def _listed(names: list[str]) -> str:
    shown = ", ".join(f"'{name}'" for name in names[:_NAMED])
    return shown if len(names) <= _NAMED else f"{shown} and {len(names) - _NAMED} more"
