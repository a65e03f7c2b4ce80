"""An edit whose knees and elbows bend as a body's do, and its goals met again by the rest of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.overbent import hold_bends
from motionedit.core.kinematics import forward
from motionedit.dataclass import replace
from motionedit.jobs.edit_pc.meeting import NEARLY, asked_again, ways_off

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_pc.meeting import Again

# To meet a goal again may bend a limb too far, too.
_ROUNDS = 4


def edit_bending(
    edit: CoefficientEdit,
    again: Again,
    stand: Callable[[CoefficientEdit, Collection[int]], CoefficientEdit],
    requests: Sequence[GoalRequest],
    facts: ClipFacts,
    *,
    left_alone: Collection[int] = (),
) -> CoefficientEdit:
    """Return an edit on its feet, by `stand`, whose knees and elbows bend within their limits.

    Those that do not are turned, and stay as they are where goals are met again; where the rest of the body does not
    reach these, the edit stays as it was. So do joints that are `left_alone`.
    """
    found = first = stand(edit, ())
    asked, still = asked_again(first, requests), frozenset[int]()
    bends = [bend for bend in facts.bends if bend.joint not in left_alone]
    for _ in range(_ROUNDS):
        held = hold_bends(found.motion, bends, first=facts.first)
        if not held.joints:
            return found
        still |= set(held.joints)
        touched = found.touched.copy()
        touched[facts.first :, list(held.joints)] = True
        found = stand(replace(found, motion=again(held.motion, asked, still), touched=touched), still)
        if max(ways_off(forward(found.motion), asked, leg=facts.anatomy.leg_length), default=0.0) >= NEARLY:
            break
    return first
