"""Far turns: a joint that shall turn by more than half a turn is led there the way round that its neighbours go.

A frame goes the shorter way to its target. Where the input turns past half a turn from a hold, the shorter way changes
to the other side from one frame to the next, and a whole arm with it. So where turns are far, frames are first solved
for a part of the way, and go on from there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.rotation_vectors import least_turned
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.task_targets import Targets

# Radians: what turns by no more goes there in one.
_FAR = 2.0


def arcs_of(targets: Targets, own: Targets) -> FloatArray | None:
    """Return the rotation vectors from a joint's own rotations to its targets, shape (n, 3); None where none is far.

    Of the ways round that follow each other in time that one is taken whose longest is the least.
    """
    if targets.rotations is None or own.rotations is None or not len(targets.rotations):
        return None
    shortest = rot.log(rot.between(own.rotations, targets.rotations))
    if np.linalg.norm(shortest, axis=1).max() <= _FAR:
        return None
    return least_turned(shortest, np.ones(len(shortest)))


def parts_of(asked: Asked) -> Iterator[tuple[tuple[Targets, ...], BoolArray]]:
    """Yield targets on the way to those of what is asked, nearer each time, and the frames (F,) at which these are far.

    An arc of angle a is gone in ceil(a / 2 rad) equal parts; the last of them is not yielded.
    """
    longest = max((float(np.linalg.norm(arc, axis=1).max()) for arc in asked.arcs if arc is not None), default=0.0)
    count = int(np.ceil(longest / _FAR))
    for part in range(1, count):
        targets, frames = list(asked.targets), np.zeros(len(asked.motion), dtype=np.bool_)
        for i, (arc, whole) in enumerate(zip(asked.arcs, asked.targets, strict=True)):
            if arc is None or whole.rotations is None:
                continue
            far = np.linalg.norm(arc, axis=1) > _FAR
            frames[whole.span] |= far
            back = np.where(far, part / count - 1.0, 0.0)[:, None] * arc
            targets[i] = replace(whole, rotations=rot.multiply(whole.rotations, rot.exp(back)))
        yield tuple(targets), frames
