"""Planted feet and hands on one thing that an edit drags along while no constraint holds them: it is easily forgotten.

With the root recruited and nothing to hold it, the cheapest way to raise a hand is to raise the whole body; and a club
that one hand takes along is no longer in the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.plant_frames import frames_of
from motionedit.core.body.quality import foot_drift
from motionedit.core.hands.grips import SEEN_APART, find_grips, seen_by
from motionedit.core.kinematics import forward_of
from motionedit.dataclass import dataclass
from motionedit.jobs.edit_prioritized.constraints import placed_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Arm
    from motionedit.core.body.trace import Trace
    from motionedit.core.motion import Motion
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
        loose = np.where(own & ~placed_at(constraints, sized.motion, leg.ankle)[down.frames], ways, 0.0)
        worst = int(np.argmax(loose))
        if loose[worst] * sized.scale > _LOOSE:
            lines.append(
                f"the {foot} foot moves by {loose[worst]:.3g} at frame {down.frames[worst]} while it is planted, "
                "and no constraint holds it"
            )
    return lines


@dataclass(frozen=True, eq=False)
class Grip:
    """An interval, both ends in, in which the hands hold one thing; where one sees the other, (n, 3), clip units."""

    first: int
    last: int
    seen: FloatArray


def grips_in(sized: SizedClip) -> list[Grip]:
    """Return where the hands of a clip hold one thing."""
    facts = sized.facts
    frame_time = facts.clip.motion.frame_time
    found = find_grips(facts.poses, facts.anatomy, frame_time=frame_time, first=facts.first)
    if not found:
        return []
    left, right = ((facts.poses.positions[:, j], facts.poses.rotations[:, j]) for j in _wrists(facts.anatomy.arms))
    seen = seen_by(right, left)
    return [Grip(a, b, seen[a : b + 1]) for a, b in found]


def loose_hands(
    sized: SizedClip, constraints: Sequence[Constraint], edited: Motion, grips: Sequence[Grip]
) -> list[str]:
    """Return a warning where hands that hold one thing come apart, and no constraint places both of them.

    Parameters
    ----------
    edited : Motion
        In normalised metres.
    grips : sequence of Grip
        By `grips_in` of the input.
    """
    lines: list[str] = []
    for grip in grips:
        span = slice(grip.first, grip.last + 1)
        part, wrists = edited.at(span), _wrists(sized.facts.anatomy.arms)
        left, right = (forward_of(part, j) for j in wrists)
        apart = rot.length(seen_by(right, left) / sized.scale - grip.seen)
        placed = [placed_at(constraints, sized.motion, j)[span] for j in wrists]
        apart[placed[0] & placed[1]] = 0.0
        worst = int(np.argmax(apart))
        if apart[worst] * sized.scale > SEEN_APART:
            one, other = (sized.motion.skeleton.names[j] for j in wrists)
            lines.append(
                f"hands that hold one thing come apart by {apart[worst]:.3g} at frame {grip.first + worst}, and no "
                f"constraint keeps them together; {{type: pose, effector: {one}, relative_to: {other}}} does"
            )
    return lines


def _wrists(arms: tuple[Arm, Arm] | None) -> list[int]:
    return [arm.wrist for arm in arms or ()]
