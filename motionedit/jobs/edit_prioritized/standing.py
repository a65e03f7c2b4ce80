"""Where feet shall stand in a clip, found before the edit: goals for each foot, and a motion that meets them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import runs
from motionedit.core.body.contacts import Plant
from motionedit.core.body.whole import whole_joints
from motionedit.core.feet.goals import ground_under
from motionedit.core.feet.keep import onto_stances, within_legs
from motionedit.core.feet.path import carried, turned
from motionedit.core.feet.reach import CALMS_ANOTHER, CALMS_OWN, LOWERED, LOWERED_ON_PATH, reach_of
from motionedit.core.feet.stance import Stance, feet_of, foot_path, stance_of
from motionedit.core.feet.stands import body_shift, on_height, within_reach
from motionedit.core.kinematics import WorldPoses, forward, shifted
from motionedit.core.motion import Motion, scaled
from motionedit.core.priorities.task_targets import Targets
from motionedit.dataclass import replace
from motionedit.jobs.clip.facts import Poses
from motionedit.jobs.edit_prioritized.asked_path import asked_path
from motionedit.jobs.edit_prioritized.body import body_again
from motionedit.jobs.edit_prioritized.constraints import placed_at

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray
    from motionedit.core.feet.goals import FootGoal
    from motionedit.core.feet.path import NewPath
    from motionedit.core.feet.stance import Foot
    from motionedit.core.priorities.asks_to_stand import AsksToStand
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.trajectories.positions import Curve
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.edit_prioritized.body import SizedClip
    from motionedit.jobs.edit_prioritized.constraints import ClipConstraint
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.load import LoadedSpec


def on_feet(
    loaded: LoadedSpec[EditPrioritizedSpec],
    sized: SizedClip,
    constraints: Sequence[ClipConstraint],
    reference: ClipFacts,
    *,
    curve: Curve,
) -> tuple[SizedClip, list[ClipConstraint]]:
    """Return a clip whose feet stand already, by its legs alone, and constraints that know where.

    Parameters
    ----------
    reference : ClipFacts
        The clip whose plants and places are kept: the clip's own, or another version of it.
    """
    facts, scale = sized.facts, sized.scale
    standing = [each for each in constraints if each.constraint.stands]
    stances = _stances(sized, standing, reference)
    if not any(stance.down.any() for _, _, stance in stances):
        warned = replace(sized, warnings=(*sized.warnings, "footplants: no foot stands in it; nothing is held"))
        return warned, [each for each in constraints if each not in standing]
    follows = any(ask.follows_path for ask, _, _ in stances)
    path = asked_path(sized, constraints, curve) if follows else None
    if follows and path is None:
        sized = replace(sized, warnings=(*sized.warnings, _no_path(facts)))
    lowered = LOWERED if path is None else LOWERED_ON_PATH
    motion, poses, placed = _placed(facts, stances, path, lowered)
    held = within_legs(placed, poses, facts.anatomy, up=facts.up, lowered=lowered)
    kept = onto_stances(
        motion,
        poses,
        held,
        facts.anatomy,
        ground_under(facts.anatomy, facts.up, floor=_floor_of_feet(sized, constraints)),
        travel=facts.travel,
        first=facts.first,
        calms=CALMS_OWN if reference.clip is facts.clip else CALMS_ANOTHER,
    )
    # Of a long clip there is no room for the world transforms of both.
    del poses
    facts.world.forget_long()
    stood = replace(facts, clip=replace(facts.clip, motion=kept.motion), world=Poses(kept.motion))
    found = replace(
        sized,
        motion=scaled(kept.motion, scale),
        body=body_again(loaded, stood, sized.body),
        before=sized.motion,
        lowered=scale * kept.lowered,
        let_go=_heels_let_go(placed, held),
    )
    goals = {goal.foot.leg.ankle: goal for goal in kept.goals}
    return found, [part for each in constraints for part in _with_goals(each, goals, constraints, sized)]


def _placed(
    facts: ClipFacts, stances: Sequence[tuple[AsksToStand, Foot, Stance]], path: NewPath | None, lowered: float
) -> tuple[Motion, WorldPoses, list[tuple[Foot, Stance]]]:
    """Return the clip's motion carried to where its feet shall stand, its world transforms, and the stances there."""
    placed: list[tuple[Foot, Stance]] = []
    lifts = []
    for ask, foot, stance in stances:
        moved = stance if path is None or not ask.follows_path else carried(stance, path)
        lifted = moved if ask.height is None else on_height(moved, ask.height, facts.up)
        lifts.append((moved, lifted))
        placed.append((foot, lifted))
    lift = body_shift(lifts, facts.clip.motion.frame_time, facts.up)
    total = lift if path is None else path.shift + lift
    motion, poses = facts.clip.motion, facts.poses
    if np.any(total):
        motion = shifted(motion, total, facts.travel, poses=poses)
        motion = motion if path is None else turned(motion, path, poses, facts.travel)
        poses = forward(motion)
    low = lowered * facts.anatomy.leg_length
    within = [
        (foot, within_reach(stance, poses.positions[:, foot.leg.thigh], reach_of(poses, foot), low, facts.up))
        if ask.follows_path
        else (foot, stance)
        for (ask, _, _), (foot, stance) in zip(stances, placed, strict=True)
    ]
    return motion, poses, within


def _floor_of_feet(sized: SizedClip, constraints: Sequence[ClipConstraint]) -> float | None:
    """Return the height of the highest floor that is under a foot; one of hands alone, as a table, is none of feet."""
    skeleton, ankles = sized.motion.skeleton, {foot.leg.ankle for foot in feet_of(sized.facts.anatomy)}
    heights = [
        each.constraint.least.height / sized.scale
        for each in constraints
        if each.constraint.least is not None
        and any(ankles.intersection(skeleton.chain(joint)) for joint in each.constraint.looked_at())
    ]
    return max(heights, default=None)


def _no_path(facts: ClipFacts) -> str:
    skeleton = facts.clip.motion.skeleton
    name = " or ".join(skeleton.names[j] for j in whole_joints(facts.bones, facts.anatomy, travel=facts.travel))
    return (
        f"footplants: at: path follows nothing, so plants stay where they are: ask for a position of {name}, "
        "in the world or by heading"
    )


def _heels_let_go(asked: Sequence[tuple[Foot, Stance]], held: Sequence[tuple[Foot, Stance]]) -> tuple[str, ...]:
    """Return a line for each foot whose heel does not stand where it was to."""
    lines = []
    for (foot, before), (_, after) in zip(asked, held, strict=True):
        spans = ", ".join(f"{first}-{last}" for first, last in runs(before.heel & ~after.heel))
        if spans:
            lines.append(
                f"the {foot.side} heel is not held at frames {spans}: the leg is too short there, even with the pelvis "
                "lowered"
            )
    return tuple(lines)


def _stances(
    sized: SizedClip, standing: Sequence[ClipConstraint], reference: ClipFacts
) -> list[tuple[AsksToStand, Foot, Stance]]:
    """Return what is asked of each foot, and where it stands in the reference."""
    feet = {foot.leg.ankle: foot for foot in feet_of(sized.facts.anatomy)}
    found: dict[int, tuple[AsksToStand, Foot, Stance]] = {}
    for each in standing:
        ask: AsksToStand = each.constraint  # type: ignore[assignment]  # it stands
        foot = feet[ask.effector.joint]
        if ask.plants is None:
            plants = [plant for plant in reference.phases if plant.foot == foot.side]
        else:
            plants = [Plant(foot.side, part, foot.leg.ankle, 0, a, b, 0.0) for part, a, b in ask.plants]  # type: ignore[arg-type]
        found.setdefault(ask.effector.joint, (ask, foot, stance_of(foot_path(reference.poses, foot), plants)))
    return list(found.values())


def _with_goals(
    each: ClipConstraint, goals: dict[int, FootGoal], constraints: Sequence[ClipConstraint], sized: SizedClip
) -> list[ClipConstraint]:
    """Return a constraint as it is, or one for each stretch in which it says where its foot is."""
    if not each.constraint.stands:
        return [each]
    ask: AsksToStand = each.constraint  # type: ignore[assignment]  # it stands
    goal, first = goals[ask.effector.joint], sized.facts.first
    here = goal.down | ~_placed_by_others(goal.foot, constraints, sized)
    here[:first] = False
    if not goal.down.any():
        return []
    parts = []
    for number, (start, stop) in enumerate(runs(here)):
        span = slice(start, stop + 1)
        targets = Targets(start, stop, sized.scale * goal.places[span], goal.turns[span])
        held: Constraint = ask.within(targets, number=number)  # type: ignore[assignment]  # it is one
        parts.append(replace(each, constraint=held))
    return parts


def _placed_by_others(foot: Foot, constraints: Sequence[ClipConstraint], sized: SizedClip) -> BoolArray:
    """Return the frames at which another constraint places a foot, shape (F,): in the air it goes there."""
    others = [each.constraint for each in constraints if each.constraint.points and not each.constraint.stands]
    return placed_at(others, sized.motion, foot.leg.ankle)
