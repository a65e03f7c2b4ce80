"""What the first solve is drawn to: the input, turned where a body meets what is asked by itself in another way."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.agreeing import overruled
from motionedit.core.priorities.groups import seen_by
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.groups import Asked


def drawn_to(asked: Asked) -> Motion:
    """Return the motion for which all freedom is used that constraints leave.

    It is the input, but for what `Constraint.by_itself` makes of it where nothing overrules the constraint.
    """
    motion, body = asked.motion, asked.body
    found = {}
    for i, (each, targets, recruits) in enumerate(zip(asked.constraints, asked.targets, asked.recruits, strict=True)):
        turned = each.by_itself(targets, recruits, body, partial(seen_by, [each], motion, body))
        if turned is not None:
            found[i] = turned
    if not found:
        return motion
    without, rotations = overruled(asked.constraints, asked.targets, len(motion)), motion.rotations.copy()
    for i, turned in found.items():
        asks = np.flatnonzero(~without[asked.targets[i].span, i])
        rotations[asked.targets[i].first + asks[:, None], turned.joints] = turned.rotations[asks]
    return replace(motion, rotations=rotations)
