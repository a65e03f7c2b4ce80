"""What is said where constraints take in a rest pose in front of the take, which it leaves with a jump."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import kinematics
from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Constraint

# Metres at leg length 0.85 m: a visible way.
_MOVED = 0.01


def begins_within(constraint: Constraint, first: int) -> bool:
    """Return whether a constraint's points begin within the rest pose, which ends before frame `first`."""
    return bool(constraint.points) and constraint.points[0].start < first


def rest_pose_words(first: int) -> str:
    """Return ``the rest pose, frame 0``: the frames before `first`."""
    return "the rest pose, frame 0" if first == 1 else f"the rest pose, frames 0 to {first - 1}"


def moved_rest_pose(
    before: Motion, after: Motion, constraints: Sequence[Constraint], *, first: int, scale: float
) -> list[str]:
    """Return a warning where constraints whose points begin within the rest pose move it.

    What has no points, such as a floor, takes it in as it does the whole clip.

    Parameters
    ----------
    before, after : Motion
        In normalised metres, `scale` of them per clip unit.
    first : int
        The first frame of the take.
    """
    names = [each.name for each in constraints if begins_within(each, first)]
    if not names:
        return []
    rest = slice(first)
    places = [kinematics.forward(motion.at(rest)).positions for motion in (before, after)]
    way = float(np.max(rot.length(places[1] - places[0])))
    if way <= _MOVED:
        return []
    who = f"points of {', '.join(names)} begin within it"
    return [f"{rest_pose_words(first)}, is moved by {way / scale:.3g}: {who}; begin at frame {first} to leave it"]
