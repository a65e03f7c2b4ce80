"""An edit whose planted feet are put back by the legs, and its goals met again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.contacts import foot_plants
from motionedit.core.feet.put_back import put_back, standing_feet
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace
from motionedit.jobs.edit_pc.goals import seen

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from motionedit.core.body.contacts import Plant
    from motionedit.core.coefficients.edit import Change, CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.feet.put_back import Places, StandingFoot
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.jobs.clip.facts import ClipFacts

# Metres at leg length 0.85 m, and radians: what putting the feet back may move a goal by.
_SETTLED = 5e-6
# Times that: what is left of it after all rounds, 0.1 mm, is met.
_NEARLY = 20.0
_ROUNDS = 10
# Rounds after which the pelvis helps, too: a straight leg that is to go higher needs the pelvis tilted.
_WITHOUT_PELVIS = 4
# Seconds: a foot with a goal so shortly before it stands, or after, does not stand where it did. Put back there, it
# would swing far out on its way.
_NEARBY = 0.15


def edit_standing(
    solve: Callable[[Sequence[GoalRequest]], CoefficientEdit],
    again: Callable[[Motion, Sequence[GoalRequest], Sequence[int]], Motion],
    requests: Sequence[GoalRequest],
    facts: ClipFacts,
    *,
    places: Places,
) -> CoefficientEdit:
    """Return what `solve` makes of goals, with planted feet put back.

    A lower pelvis takes goals along, and so may the leg of a foot with a goal. They are met again by what is not
    part of a standing leg: `again` changes a motion so that goals are met while some joints are still. Where that does
    not reach so far, the whole body is asked: with no joint still, feet are firm.
    """
    edit = solve(requests)
    anatomy = facts.anatomy
    if anatomy.legs is None or not (edit.touched.any() or edit.moved.any()):
        return edit
    motion = facts.clip.motion
    fixed = {(request.effector.joint, request.frame) for request in requests}
    feet = standing_feet(motion, anatomy, foot_plants(plants_without(facts, fixed)), fixed=fixed)
    still = _still(motion, feet)
    # Where a goal is out of reach, what the solver has come to is kept.
    reached = kinematics.forward(edit.motion)
    asked = [
        request if edit.reasons[i] == "converged" else _reached(request, reached) for i, request in enumerate(requests)
    ]
    tolerance = _SETTLED * anatomy.leg_length / STANDARD_LEG
    found = legs_alone = edit
    for done in range(_ROUNDS):
        if done:
            found = replace(found, motion=again(found.motion, asked, still if done <= _WITHOUT_PELVIS else ()))
        kept = put_back(
            found.motion, motion, feet, anatomy, up=facts.up, travel=facts.travel, places=places, first=facts.first
        )
        found = replace(found, motion=kept.motion, touched=found.touched | kept.touched, moved=found.moved | kept.moved)
        poses = kinematics.forward(found.motion)
        off = [_off(request, poses, tolerance) for request in asked]
        if max(off, default=0.0) < 1.0:
            return found
        if done == _WITHOUT_PELVIS:
            legs_alone = replace(found, changes=_stood(edit, [i for i, each in enumerate(off) if each >= 1.0]))
    # What the whole body does not reach, either, it is not wrung for.
    return found if max(off) < _NEARLY else legs_alone


def _stood(edit: CoefficientEdit, missed: Collection[int]) -> tuple[Change, ...]:
    """Return an edit's changes, with feet that stand as the reason of what was met but for them."""
    return tuple(
        replace(
            change,
            reasons={
                i: "stood" if i in missed and reason == "converged" else reason for i, reason in change.reasons.items()
            },
        )
        for change in edit.changes
    )


def plants_without(facts: ClipFacts, fixed: Collection[tuple[int, int]]) -> list[Plant]:
    """Return the clip's plants but for those whose foot is meant to be elsewhere: `fixed` (joint, frame) nearby."""
    skeleton, points = facts.clip.motion.skeleton, facts.anatomy.sole_points
    thighs = [leg.thigh for leg in facts.anatomy.legs or ()]
    nearby = round(_NEARBY / facts.clip.motion.frame_time)

    def free(plant: Plant) -> bool:
        own = skeleton.chain(points[plant.point].effector.joint)
        return any(
            plant.start - nearby <= frame <= plant.stop + nearby
            and any(thigh in own and thigh in skeleton.chain(joint) for thigh in thighs)
            for joint, frame in fixed
        )

    return [plant for plant in facts.plants if not free(plant)]


def _still(motion: Motion, feet: Sequence[StandingFoot]) -> list[int]:
    """Return the joints that move the ankle of a foot without goals."""
    chains = [motion.skeleton.chain(each.foot.leg.ankle) for each in feet if not each.fixed]
    shared = [motion.skeleton.chain(each.foot.leg.thigh)[:-1] for each in feet]
    return sorted({int(j) for chain in (*chains, *shared) for j in chain})


def _reached(request: GoalRequest, poses: WorldPoses) -> GoalRequest:
    position, rotation = seen(poses, request.frame, request.effector, request.measure)
    return replace(
        request,
        position=None if request.position is None else position,
        rotation=None if request.rotation is None else rotation,
    )


def _off(request: GoalRequest, poses: WorldPoses, tolerance: float) -> float:
    """Return how far a goal is off, over the tolerance."""
    position, rotation = seen(poses, request.frame, request.effector, request.measure)
    off = 0.0
    if request.position is not None:
        counted = list(request.measure.counted)
        off = float(np.linalg.norm((request.position - position)[counted])) / tolerance
    if request.rotation is not None:
        off = max(off, float(rot.angle_between(rotation, request.rotation)) / _SETTLED)
    return off
