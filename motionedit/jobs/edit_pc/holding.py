"""An edit whose hands hold one thing as they did in the input."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.hands.closing import close_grips
from motionedit.core.hands.grips import SEEN_APART, find_grips
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.jobs.clip.facts import ClipFacts


@dataclass(frozen=True, eq=False)
class Holding:
    """An edit whose hands hold what they held.

    Attributes
    ----------
    edit : CoefficientEdit
    record : dict or None
        What the report says of the hands; None where nothing was looked for.
    rough : tuple of str
        What of it a viewer would see.
    """

    edit: CoefficientEdit
    record: dict[str, Any] | None = None
    rough: tuple[str, ...] = ()


def edit_holding(
    edit: CoefficientEdit, requests: Sequence[GoalRequest], facts: ClipFacts, *, left_alone: Collection[int] = ()
) -> Holding:
    """Return an edit whose hands are together where the clip's hold one thing, by arms without joints `left_alone`."""
    motion, anatomy = facts.clip.motion, facts.anatomy
    if anatomy.arms is None or not (edit.touched.any() or edit.moved.any()):
        return Holding(edit)
    grips = find_grips(facts.poses, anatomy, frame_time=motion.frame_time, first=facts.first)
    left, right = ({each.frame for each in requests if _is_about(each, arm.shoulder, facts)} for arm in anatomy.arms)
    if not grips:
        return Holding(edit, {"grips": [], "apart_max": None})
    closed = close_grips(
        edit.motion, facts.poses, grips, anatomy, facts.bends, goals=(left, right), left_alone=left_alone
    )
    worst = int(np.argmax(closed.off))
    apart, seen = float(closed.off[worst]), SEEN_APART * anatomy.leg_length / STANDARD_LEG
    line = (
        f"hands that hold one thing come apart by {apart:.3g} at frame {worst}: farther than the arms bring them back "
        f"({seen:.3g} would be seen)"
    )
    return Holding(
        replace(edit, motion=closed.motion, touched=edit.touched | closed.touched),
        {"grips": [{"first_frame": a, "last_frame": b} for a, b in grips], "apart_max": apart},
        (line,) if apart > seen else (),
    )


def _is_about(request: GoalRequest, shoulder: int, facts: ClipFacts) -> bool:
    """Return whether an arm moves a goal's effector, or what it is measured in."""
    joints = [request.effector.joint, *([] if request.measure.base is None else [request.measure.base])]
    return any(shoulder in facts.clip.motion.skeleton.chain(joint) for joint in joints)
