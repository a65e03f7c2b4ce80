"""An edit whose planted feet are put back by the legs, and its goals met again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.contacts import foot_plants
from motionedit.core.feet.legs import keep_feet, standing_feet
from motionedit.core.units import STANDARD_LEG
from motionedit.jobs.edit_pc.goals import seen

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.feet.legs import Places
    from motionedit.core.kinematics import WorldPoses
    from motionedit.jobs.clip.facts import ClipFacts

# Metres at leg length 0.85 m, and radians: what the feet's turn moves a goal by that is left as it is.
_SETTLED = 2e-6
_ROUNDS = 8


def edit_standing(
    solve: Callable[[Sequence[GoalRequest]], CoefficientEdit],
    requests: Sequence[GoalRequest],
    facts: ClipFacts,
    *,
    places: Places,
) -> CoefficientEdit:
    """Return what `solve` makes of goals, with planted feet put back.

    A lower pelvis moves what the goals are about, and so may the leg of a foot with a goal; the solver is then asked
    for as much less, until the goals are met with the feet in place.
    """
    edit = solve(requests)
    legs = facts.anatomy.legs
    if legs is None or not (edit.touched.any() or edit.moved.any()):
        return edit
    motion = facts.clip.motion
    fixed = {(request.effector.joint, request.frame) for request in requests}
    feet = standing_feet(motion, legs, foot_plants(facts.plants), fixed=fixed)
    tolerance = _SETTLED * facts.anatomy.leg_length / STANDARD_LEG
    asked = list(requests)
    for _ in range(_ROUNDS):
        kept = keep_feet(edit.motion, motion, feet, up=facts.up, travel=facts.travel, places=places)
        before, after = kinematics.forward(edit.motion), kinematics.forward(kept.motion)
        aims = [_aim(request, before, after) for request in requests]
        off = max((_apart(old, new, tolerance) for old, new in zip(asked, aims, strict=True)), default=0.0)
        if off < 1.0:
            break
        asked = aims
        edit = solve(asked)
    else:
        kept = keep_feet(edit.motion, motion, feet, up=facts.up, travel=facts.travel, places=places)
    return replace(edit, motion=kept.motion, touched=edit.touched | kept.touched, moved=edit.moved | kept.moved)


def _aim(request: GoalRequest, before: WorldPoses, after: WorldPoses) -> GoalRequest:
    """Return the request less what putting the feet back adds."""
    (x, q), (x_kept, q_kept) = (seen(p, request.frame, request.effector, request.measure) for p in (before, after))
    position, rotation = request.position, request.rotation
    return replace(
        request,
        position=None if position is None else position - (x_kept - x),
        rotation=None if rotation is None else rot.multiply(rot.multiply(q, rot.conjugate(q_kept)), rotation),
    )


def _apart(old: GoalRequest, new: GoalRequest, tolerance: float) -> float:
    """Return how far two aims are apart, over the tolerance."""
    apart = 0.0
    if old.position is not None and new.position is not None:
        apart = float(np.linalg.norm(old.position - new.position)) / tolerance
    if old.rotation is not None and new.rotation is not None:
        apart = max(apart, float(rot.angle_between(old.rotation, new.rotation)) / _SETTLED)
    return apart
