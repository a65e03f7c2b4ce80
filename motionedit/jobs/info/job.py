"""What is in a clip: the record that `motionedit info` prints as text and writes as JSON."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any

from motionedit.core.body import ground
from motionedit.core.body.contacts import foot_plants
from motionedit.core.body.hinges import find_hinges
from motionedit.core.body.quality import find_defects
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError, MotionEditError, together
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import find_clips
from motionedit.jobs.clip.facts import ClipFacts, facts_of
from motionedit.jobs.clip.metrics import clip_metrics, feet_of
from motionedit.jobs.clip.unit import likely_unit
from motionedit.jobs.info.poses import Question, ask, poses_at
from motionedit.jobs.info.text import describe

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.body.anatomy import Anatomy, Arm, Leg
    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True)
class InfoReport:
    """What was found: `text` for people, `records` for the JSON report, `failures` of clips that cannot be read."""

    text: str
    records: list[dict[str, Any]]
    failures: list[MotionEditError]


def run(
    clips: Sequence[Path],
    *,
    at: Sequence[str] = (),
    joints: Sequence[str] = (),
    contacts: bool = False,
    up: str = "auto",
    lenient: bool,
) -> InfoReport:
    """Describe clips one after the other; a clip that cannot be read is a failure, the others go on.

    Parameters
    ----------
    at, joints : sequences of str
        Times and effectors, as in a spec: each effector's pose is told at each time.
    contacts : bool
        Whether to list the plants of the feet.
    up : str
        The axis that is up, or ``auto``.

    Raises
    ------
    UsageError
        A time or effector that cannot be read; no clip at all.
    MotionEditErrors
        Times or effectors that no clip has.
    """
    question = ask(at, joints)
    texts, records = [], []
    told: dict[tuple[str, ...], str] = {}
    failures: list[MotionEditError] = []
    lacking: list[MotionEditError] = []
    for task in find_clips(clips):
        try:
            facts = facts_of(read_task(task, lenient=lenient), up=up)
        except ClipError as error:
            failures.append(error)
            records.append({"clip": task.label, "status": "failed", "message": str(error)})
            continue
        record, errors = _record(facts, question=question, contacts=contacts)
        lacking += errors
        failures += errors
        records.append(record)
        texts.append(describe(record, told))
    if lacking and all(record["status"] == "failed" for record in records):
        raise together("no clip has what is asked for", failures)
    return InfoReport("\n".join(texts), records, failures)


def _record(facts: ClipFacts, *, question: Question, contacts: bool) -> tuple[dict[str, Any], list[MotionEditError]]:
    """Return a clip's entry of the report, and what was asked for that it does not have."""
    motion, anatomy = facts.clip.motion, facts.anatomy
    skeleton = motion.skeleton
    poses, errors = poses_at(facts, question)
    record: dict[str, Any] = {
        "clip": facts.clip.label,
        "status": "failed" if errors else "ok",
        "message": "; ".join(map(str, errors)) or None,
        "frames": len(motion),
        "frame_rate": motion.frame_rate,
        "frame_time": motion.frame_time,
        "duration": motion.duration,
        "up": ground.axis_name(facts.up),
        "heading": facts.heading_frame().degrees,
        "rest_pose_frames": facts.first,
        "travel_joint": skeleton.names[facts.travel],
        "leg_length": anatomy.leg_length,
        "height": anatomy.height,
        "unit": likely_unit(anatomy.leg_length),
        "anatomy": _anatomy(skeleton, anatomy),
        "joints": _joints(skeleton),
        "channels": skeleton.channel_count,
        "hinges": _hinges(facts),
        "defects": _defects(facts),
        "metrics": _metrics(facts),
        "warnings": [*facts.clip.warnings, *facts.warnings, *anatomy.missing, *_repeated_names(skeleton)],
    }
    if contacts:
        record["contacts"] = _contacts(facts)
        record["plants"] = _plants(facts)
    if question:
        record["poses"] = poses
    return record, errors


def _anatomy(skeleton: Skeleton, anatomy: Anatomy) -> dict[str, Any]:
    def named(joint: int | None) -> str | None:
        return None if joint is None else skeleton.names[joint]

    found: dict[str, Any] = {"head": named(anatomy.head)}
    legs = zip(("left_leg", "right_leg"), map(_leg, anatomy.legs or ()), strict=False)
    arms = zip(("left_arm", "right_arm"), map(_arm, anatomy.arms or ()), strict=False)
    limbs = dict.fromkeys(("left_leg", "right_leg", "left_arm", "right_arm"), None) | dict(legs) | dict(arms)
    for limb, parts in limbs.items():
        found[limb] = parts and {part: named(joint) for part, joint in parts.items()}
    return found


def _leg(leg: Leg) -> dict[str, int | None]:
    return {"thigh": leg.thigh, "knee": leg.knee, "ankle": leg.ankle, "toe": leg.toe}


def _arm(arm: Arm) -> dict[str, int | None]:
    return {"clavicle": arm.clavicle, "shoulder": arm.shoulder, "elbow": arm.elbow, "wrist": arm.wrist}


def _joints(skeleton: Skeleton) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "parent": None if parent < 0 else skeleton.names[parent],
            "depth": len(skeleton.chain(j)) - 1,
            "channels": list(skeleton.channels[j]),
            "offset": skeleton.offsets[j],
            "end_sites": [site.offset for site in skeleton.end_sites if site.joint == j],
        }
        for j, (name, parent) in enumerate(zip(skeleton.names, skeleton.parents, strict=True))
    ]


def _hinges(facts: ClipFacts) -> list[dict[str, Any]]:
    motion = facts.clip.motion
    return [
        {
            "joint": motion.skeleton.names[hinge.joint],
            "axis": hinge.axis,
            "limits": [math.degrees(limit) for limit in hinge.limits],
        }
        for hinge in find_hinges(facts.bends)
    ]


def _defects(facts: ClipFacts) -> list[dict[str, Any]]:
    motion = facts.clip.motion
    return [
        {
            "joint": motion.skeleton.names[defect.joint],
            "frames": list(defect.frames),
            "frame": defect.worst,
            "angle": math.degrees(defect.angle),
            "flips": defect.flips,
        }
        for defect in find_defects(motion, first=facts.first)
    ]


def _metrics(facts: ClipFacts) -> dict[str, Any]:
    trace = feet_of(facts, facts.world.blocks())
    return clip_metrics(facts, trace, facts.phases, facts.steps)


def _contacts(facts: ClipFacts) -> list[dict[str, Any]]:
    motion = facts.clip.motion
    return [
        {
            "foot": plant.foot,
            "part": plant.part,
            "joint": motion.skeleton.names[plant.joint],
            "frames": [plant.start, plant.stop],
            "seconds": plant.frames * motion.frame_time,
            "height": plant.height,
        }
        for plant in facts.plants
    ]


def _plants(facts: ClipFacts) -> list[dict[str, Any]]:
    """Return when whole feet stand, with the phases of heel and toe, and those in which `footplants` hold them."""
    return [
        {
            "foot": plant.foot,
            "frames": [plant.start, plant.stop],
            "seconds": (plant.stop - plant.start + 1) * facts.clip.motion.frame_time,
            **{
                part: [[phase.start, phase.stop] for phase in plant.phases if phase.part == part]
                for part in ("heel", "toe")
            },
            "held": {
                part: [
                    [phase.start, phase.stop]
                    for phase in facts.phases
                    if (phase.foot, phase.part) == (plant.foot, part) and plant.start <= phase.start <= plant.stop
                ]
                for part in ("heel", "toe")
            },
        }
        for plant in foot_plants(facts.plants)
    ]


def _repeated_names(skeleton: Skeleton) -> list[str]:
    counts = Counter(skeleton.names)
    return [f"{count} joints are called '{name}'" for name, count in counts.items() if count > 1]
