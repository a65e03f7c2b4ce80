"""Planted feet that an edit drags along while no constraint places them: it is easily forgotten.

With the root recruited and nothing to hold it, the cheapest way to raise a hand is to raise the whole body.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.plant_frames import frames_of
from motionedit.core.body.quality import foot_drift

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.trace import Trace
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.jobs.edit_prioritized.body import SizedClip

# Metres at leg length 0.85 m: a visible way.
_LOOSE = 0.01


def loose_feet(sized: SizedClip, constraints: Sequence[Constraint], before: Trace, after: Trace) -> list[str]:
    """Return a warning for each foot that moves while it is planted and no constraint places any part of it.

    Parameters
    ----------
    before, after : Trace
        By `feet_of`.
    """
    facts, down = sized.facts, None
    # Most edits move no planted foot at all.
    if foot_drift(before.tracks, after.tracks, facts.phases) * sized.scale > _LOOSE:
        down = frames_of(facts.phases)
    if down is None:
        return []
    ways = rot.length(down.of(after.tracks) - down.of(before.tracks))
    lines: list[str] = []
    for foot, leg in zip(("left", "right"), facts.anatomy.legs or (), strict=False):
        own = np.array([point.foot == foot for point in facts.anatomy.sole_points])[down.points]
        loose = np.where(own & ~_placed(sized, constraints, leg)[down.frames], ways, 0.0)
        worst = int(np.argmax(loose))
        if loose[worst] * sized.scale > _LOOSE:
            lines.append(
                f"the {foot} foot moves by {loose[worst]:.3g} at frame {down.frames[worst]} while it is planted, "
                "and no constraint holds it"
            )
    return lines


def _placed(sized: SizedClip, constraints: Sequence[Constraint], leg: Leg) -> BoolArray:
    """Return the frames at which a constraint places a leg's ankle or what hangs on it, shape (F,)."""
    skeleton, frames = sized.motion.skeleton, len(sized.motion)
    placed = np.zeros(frames, dtype=np.bool_)
    for each in constraints:
        if each.places_effector and each.at is not None and leg.ankle in skeleton.chain(each.at.joint):
            first, last = each.active(frames)
            placed[first : last + 1] = True
    return placed
