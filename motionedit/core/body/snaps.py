"""Knees and elbows that an edit snaps: they turn round, start or stop within a frame or two, as they do not before."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.steps import STEP_RATE
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.motion import Motion

# Degrees by which the bending of a sixtieth of a second differs from that of the next where a viewer sees it: from 90
# degrees a second one way to 90 the other.
SNAP = 3.0
# Times what the joint does in the input.
_OWN = 2.0


@dataclass(frozen=True)
class Snap:
    """A knee or an elbow that snaps: `degrees` at a frame, of which `most` would be seen."""

    joint: int
    frame: int
    degrees: float
    most: float


def snaps(after: Motion, bends: Sequence[Bend], *, first: int, touched: BoolArray) -> list[Snap]:
    """Return the joints whose bending changes within a sixtieth of a second by more than is seen, and than the input's.

    Parameters
    ----------
    after : Motion
        The edited motion.
    bends : sequence of Bend
        The input's, of the same `first`.
    first : int
        The first frame after a rest pose; earlier ones are left out.
    touched : shape (J,)
        The joints that the edit turned; others are not looked at.
    """
    found = []
    for bend in bends:
        if not touched[bend.joint]:
            continue
        taken = pace_changes(bend.angles_in(after.rotations[first:]), after.frame_time)
        worst = int(np.argmax(taken))
        if taken[worst] <= SNAP:
            continue
        most = max(SNAP, _OWN * float(pace_changes(bend.angles, after.frame_time).max()))
        if taken[worst] > most:
            found.append(Snap(bend.joint, first + worst, float(taken[worst]), most))
    return found


def pace_changes(angles: FloatArray, frame_time: float) -> FloatArray:
    """Return how the pace of angles (F,), rad, changes at each frame, shape (F,), degrees in a sixtieth of a second.

    |b(t + h) - 2 b(t) + b(t - h)| / (60 h)^2, h being a sixtieth of a second or one frame, the longer; 0 at the ends.
    """
    away = max(1, round(1.0 / (STEP_RATE * frame_time)))
    changes, b = np.zeros(len(angles)), np.unwrap(angles)
    changes[away:-away] = np.abs(b[2 * away :] - 2.0 * b[away:-away] + b[: -2 * away])
    degrees: FloatArray = np.degrees(changes) / (STEP_RATE * away * frame_time) ** 2
    return degrees
