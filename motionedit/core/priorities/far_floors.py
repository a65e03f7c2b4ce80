"""Far floors: a body that is far below its floor is lifted there as a whole, from where frames are solved.

An iteration takes an error back by no more than the largest that is clamped, shared by all points of the body: from
metres below none arrives. Where the root is free to move, and nothing is more important, the lift is the solution.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.kinematics import shifted
from motionedit.core.priorities.groups import seen_by
from motionedit.core.priorities.solver.constants import LARGEST_ERROR

if TYPE_CHECKING:
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.groups import Asked


def lifted(asked: Asked) -> Motion:
    """Return the motion with its root lifted in frames that are far below a floor of the most important layer."""
    motion, shift = asked.motion, np.zeros((len(asked.motion), 3))
    first = [i for i, each in enumerate(asked.constraints) if each.priority == asked.levels[0]]
    floors = [(i, asked.constraints[i].least) for i in first if asked.recruits[i].root]
    if len(floors) < len(first) or any(level is None for _, level in floors):
        return motion
    for i, level in floors:
        each = asked.constraints[i]
        below = each.errors(asked.targets[i], seen_by([each], motion, asked.body), reference=motion).positions
        if level is None or below is None:
            continue
        far = np.where(below > LARGEST_ERROR, below, 0.0)
        span = asked.targets[i].span
        shift[span] += np.maximum(far - shift[span] @ level.up, 0.0)[:, None] * level.up
    return shifted(motion, shift, asked.body.travel) if shift.any() else motion
