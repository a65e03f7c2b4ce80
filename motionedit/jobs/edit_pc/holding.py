"""An edit whose hands hold one thing as they did in the input."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.bends import find_bends
from motionedit.core.hands.closing import close_grips
from motionedit.core.hands.grips import find_grips
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.jobs.clip.facts import ClipFacts

# Metres at leg length 0.85 m by which hands that hold one thing come apart where a viewer sees it.
_SEEN = 0.03


def edit_holding(
    edit: CoefficientEdit, requests: Sequence[GoalRequest], facts: ClipFacts
) -> tuple[CoefficientEdit, list[str]]:
    """Return an edit whose hands are together where the clip's hold one thing, and what of that a viewer would see."""
    motion, anatomy = facts.clip.motion, facts.anatomy
    if anatomy.arms is None or not (edit.touched.any() or edit.moved.any()):
        return edit, []
    grips = find_grips(facts.poses, anatomy, frame_time=motion.frame_time, first=facts.first)
    if not grips:
        return edit, []
    bends = find_bends(motion.skeleton, facts.poses, anatomy, first=facts.first)
    left, right = ({each.frame for each in requests if _is_about(each, arm.shoulder, facts)} for arm in anatomy.arms)
    closed = close_grips(edit.motion, motion, grips, anatomy, bends, goals=(left, right))
    if closed is None:
        return edit, []
    worst = int(np.argmax(closed.off))
    seen = _SEEN * anatomy.leg_length / STANDARD_LEG
    rough = []
    if closed.off[worst] > seen:
        rough.append(
            f"hands that hold one thing come apart by {closed.off[worst]:.3g} at frame {worst}: farther than the arms "
            f"bring them back ({seen:.3g} would be seen)"
        )
    return replace(edit, motion=closed.motion, touched=edit.touched | closed.touched), rough


def _is_about(request: GoalRequest, shoulder: int, facts: ClipFacts) -> bool:
    """Return whether an arm moves a goal's effector, or what it is measured in."""
    joints = [request.effector.joint, *([] if request.measure.base is None else [request.measure.base])]
    return any(shoulder in facts.clip.motion.skeleton.chain(joint) for joint in joints)
