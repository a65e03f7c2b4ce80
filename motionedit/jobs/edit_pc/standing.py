"""An edit whose planted feet are put back by the legs, and its goals met again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core import rotations as rot
from motionedit.core.feet.put_back import NEARBY, Fixed, put_back
from motionedit.core.kinematics import effector_positions, forward
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace
from motionedit.jobs.edit_pc.goals import goal_place
from motionedit.jobs.edit_pc.meeting import NEARLY, asked_again, ways_off

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.body.contacts import Plant
    from motionedit.core.coefficients.edit import Change, CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.feet.put_back import StandingFoot
    from motionedit.core.motion import Motion
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_pc.meeting import Again

_ROUNDS = 10
# Rounds after which the pelvis helps, too: a straight leg that is to go higher needs the pelvis tilted.
_WITHOUT_PELVIS = 4
# Metres at leg length 0.85 m: a goal that takes a foot that stands up by no more moves its plant, one higher lifts it.
_LIFTED = 0.03


def edit_standing(
    edit: CoefficientEdit,
    again: Again,
    requests: Sequence[GoalRequest],
    facts: ClipFacts,
    *,
    travel: int,
    feet: Sequence[StandingFoot],
    still: Collection[int] = (),
) -> CoefficientEdit:
    """Return an edit whose feet are put back where they stand.

    A lower pelvis takes goals along, and so may the leg of a foot with a goal. They are met again by what is not
    part of a standing leg: `again` changes a motion so that goals are met while some joints are still. Where that does
    not reach so far, the whole body is asked, with feet that are firm; but for joints that are `still` in any case.
    """
    anatomy = facts.anatomy
    if anatomy.legs is None or not (edit.touched.any() or edit.moved.any()):
        return edit
    motion = facts.clip.motion
    standing, asked = {*still, *_still(motion, feet)}, asked_again(edit, requests)
    found = legs_alone = edit
    for done in range(_ROUNDS):
        if done:
            whole = done > _WITHOUT_PELVIS
            found = replace(found, motion=again(found.motion, asked, still if whole else standing, firm=whole))
        kept = put_back(found.motion, motion, feet, anatomy, up=facts.up, travel=travel, first=facts.first)
        found = replace(found, motion=kept.motion, touched=found.touched | kept.touched, moved=found.moved | kept.moved)
        off = ways_off(forward(found.motion), asked, leg=anatomy.leg_length)
        if max(off, default=0.0) < 1.0:
            return found
        if done == _WITHOUT_PELVIS:
            legs_alone = replace(found, changes=_stood(edit, [i for i, each in enumerate(off) if each >= 1.0]))
    # What the whole body does not reach, either, it is not wrung for.
    return found if max(off) < NEARLY else legs_alone


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


def fixed_by(requests: Sequence[GoalRequest], facts: ClipFacts, *, kept: bool) -> list[Fixed]:
    """Return the joints that goals fix at their frames.

    Where feet are kept, one that stands where its goal has it in the room stands there; it is not free to be elsewhere
    in other frames.
    """
    off = ways_off(facts.poses, requests, leg=facts.anatomy.leg_length)

    def stands(request: GoalRequest) -> bool:
        joint, frame, in_room = request.effector.joint, request.frame, request.measure.base is None
        return kept and in_room and any(_moves(plant, joint, frame, facts) for plant in facts.plants)

    return [
        Fixed(each.effector.joint, each.frame, each.rotation is not None, _lifts(each, facts))
        for i, each in enumerate(requests)
        if off[i] >= 1.0 or not stands(each)
    ]


def _lifts(request: GoalRequest, facts: ClipFacts) -> bool:
    """Return whether a goal takes its effector up, more than along the ground, and as far as feet that lift do."""
    place = goal_place(request, facts.poses)
    if place is None:
        return False
    way = place - effector_positions(facts.poses.at(slice(request.frame, request.frame + 1)), request.effector)[0]
    up = float(way @ facts.up)
    return up > max(_LIFTED * facts.anatomy.leg_length / STANDARD_LEG, float(rot.length(way - up * facts.up)))


def plants_without(facts: ClipFacts, fixed: Collection[Fixed]) -> list[Plant]:
    """Return the clip's plants but for those whose foot is meant to be elsewhere, then or nearby."""
    nearby = round(NEARBY / facts.clip.motion.frame_time)
    return [
        plant
        for plant in facts.plants
        if not any(_moves(plant, each.joint, each.frame, facts, nearby=nearby) for each in fixed)
    ]


def _moves(plant: Plant, joint: int, frame: int, facts: ClipFacts, *, nearby: int = 0) -> bool:
    """Return whether a joint is one of a plant's leg, and it stands at a frame, or nearby."""
    skeleton = facts.clip.motion.skeleton
    own = skeleton.chain(facts.anatomy.sole_points[plant.point].effector.joint)
    return plant.start - nearby <= frame <= plant.stop + nearby and any(
        leg.thigh in own and leg.thigh in skeleton.chain(joint) for leg in facts.anatomy.legs or ()
    )


def _still(motion: Motion, feet: Sequence[StandingFoot]) -> list[int]:
    """Return the joints that move the ankle of a foot without goals."""
    chains = [motion.skeleton.chain(each.foot.leg.ankle) for each in feet if not each.fixed]
    shared = [motion.skeleton.chain(each.foot.leg.thigh)[:-1] for each in feet]
    return sorted({int(j) for chain in (*chains, *shared) for j in chain})
