"""What points that begin within a rest pose come to: that it is edited, too, and leaves the take with a jump."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from motionedit.core.priorities.kinds.constraint import Constraint


def begins_within(constraint: Constraint, first: int) -> bool:
    """Return whether a constraint's points begin within the rest pose, which ends before frame `first`."""
    return bool(constraint.points) and constraint.points[0].start < first


def rest_pose_words(first: int) -> str:
    """Return ``the rest pose, frame 0``: the frames before `first`."""
    return "the rest pose, frame 0" if first == 1 else f"the rest pose, frames 0 to {first - 1}"
