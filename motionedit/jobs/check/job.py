"""Are clips fit for use, and a spec for them: a line a clip, limits that are passed, and errors."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.blocks import blocks_of
from motionedit.core.body import ground
from motionedit.core.body.anatomy import NOTHING_GIVEN
from motionedit.core.body.quality import find_defects
from motionedit.core.body.steps import own_steps
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace
from motionedit.errors import EXIT_CLIP_FAILED, EXIT_DONE, EXIT_OUT_OF_TOLERANCE, MotionEditError, UsageError
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import find_clips
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.clip.metrics import clip_metrics, feet_of
from motionedit.jobs.info.job import likely_unit
from motionedit.regular_files import read_file

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.check.specs import SpecCheck
    from motionedit.jobs.clip.facts import ClipFacts

# Metres at leg length 0.85 m: feet that stand further above or below the floor of the file stand on another.
_OFF_THE_FLOOR = 0.1
# What a limit may be set on, each with its words; a clip passes it where its measure is larger.
MEASURES = {
    "foot_skate_mean": "m/s",
    "foot_skate_ratio": "share",
    "foot_sliding_share": "share",
    "foot_drift_max": "m",
    "floor_penetration_share": "share",
    "floor_penetration_max": "m",
    "foot_floating_max": "m",
    "jerk_rms": "units/s^3",
    "step_max": "degrees",
    "jumps": "count",
    "flips": "count",
    "rest_pose_frames": "count",
    "frames": "count",
}


@dataclass(frozen=True)
class Checked:
    """What came of one clip: its record, its line, and why it cannot be read, or that it cannot."""

    record: dict[str, Any]
    line: str
    failure: MotionEditError | None = None


def limits_of(pairs: Sequence[str], file: Path | None = None) -> dict[str, float]:
    """Return limits by measure, from a file of ``measure: number`` lines and ``measure=number`` words, which win.

    Raises
    ------
    UsageError
        A measure that is none, a limit that is no number, a file that cannot be read.
    """
    found: dict[str, float] = {}
    if file is not None:
        try:
            lines = read_file(file).decode("utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise UsageError(f"cannot read the limits: {error}", file=str(file)) from None
        for number, line in enumerate(lines, start=1):
            text = line.partition("#")[0].strip()
            if text:
                found |= _limit(text, ":", where=f"{file}:{number}")
    for pair in pairs:
        found |= _limit(pair, "=", where="--limit")
    return found


def _limit(text: str, sign: str, *, where: str) -> dict[str, float]:
    name, found, value = (part.strip() for part in text.partition(sign))
    if not found:
        raise UsageError(f"{where}: must be MEASURE{sign}NUMBER, not '{text}'")
    if name not in MEASURES:
        raise UsageError(f"{where}: no measure '{name}'; they are {', '.join(MEASURES)}")
    try:
        limit = float(value)
    except ValueError:
        limit = math.nan
    if not math.isfinite(limit):
        raise UsageError(f"{where}: {name}: must be a number, not '{value}'")
    return {name: limit}


def run(
    clips: Sequence[Path],
    *,
    limits: Mapping[str, float],
    check: SpecCheck | None = None,
    up: str = "auto",
    lenient: bool = False,
    jobs: int = 1,
) -> Iterator[Checked]:
    """Yield what came of each clip, in order, whatever the number of `jobs`.

    Raises
    ------
    UsageError
        No clip at all.
    """
    tasks = find_clips(clips)
    if check is not None:
        check = replace(check, others=tuple(task.relative for task in tasks))
    one = partial(_checked, limits=dict(limits), check=check, up=up, lenient=lenient)
    if jobs == 1 or len(tasks) < 2:
        yield from map(one, tasks)
        return
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(jobs or None) as pool:
        yield from pool.map(one, tasks)


def exit_code(found: Sequence[Checked]) -> int:
    """Return 1 where a clip cannot be read, else 3 where one passes a limit or a spec does not fit, else 0."""
    statuses = {each.record["status"] for each in found}
    if "failed" in statuses:
        return EXIT_CLIP_FAILED
    return EXIT_OUT_OF_TOLERANCE if "unfit" in statuses else EXIT_DONE


def _checked(
    task: ClipTask, *, limits: Mapping[str, float], check: SpecCheck | None, up: str, lenient: bool
) -> Checked:
    lacking = Faults()
    try:
        clip = read_task(task, lenient=lenient)
        facts = _facts(clip, task, check, lacking, up=up)
    except MotionEditError as error:
        return Checked({"clip": task.label, "status": "failed", "message": str(error)}, "", error)
    if check is not None:
        lacking.get(partial(check.refuse_lacking, facts, task), otherwise=None)
    measures = _measures(facts)
    passed = [name for name, limit in limits.items() if measures[name] > limit]
    errors, stand = [str(error) for error in lacking.errors], _off_the_floor(facts)
    off = [] if stand is None else [f"{stand}: skate, depth and floating are measured from 0, the floor of the file"]
    reasons = [f"{name} {measures[name]:.4g} above {limits[name]:.4g}" for name in passed] + errors
    record = {
        "clip": task.label,
        "status": "unfit" if reasons else "ok",
        "message": "; ".join(reasons) or None,
        "frame_rate": facts.clip.motion.frame_rate,
        "up": ground.axis_name(facts.up),
        "unit": likely_unit(facts.anatomy.leg_length),
        "found": _found(facts),
        "measures": measures,
        "passed": passed,
        "spec_errors": errors,
        "warnings": [*clip.warnings, *facts.warnings, *facts.anatomy.missing, *off],
    }
    return Checked(record, _line(record, stand))


def _facts(clip: Clip, task: ClipTask, check: SpecCheck | None, lacking: Faults, *, up: str) -> ClipFacts:
    """Return a clip's facts by the body and the up axis that a spec gives; joints that it lacks go to `lacking`."""
    if check is None:
        return facts_of(clip, up=up)
    given = lacking.get(partial(check.body_in, clip, task), otherwise=NOTHING_GIVEN)
    return facts_of(clip, up=check.loaded.model.up if up == "auto" else up, given=given)


def _measures(facts: ClipFacts) -> dict[str, float]:
    motion = facts.clip.motion
    steps = own_steps(motion, first=facts.first)
    measured = clip_metrics(facts, feet_of(facts, blocks_of(facts.poses)), facts.phases, steps)
    defects = find_defects(motion, first=facts.first)
    counted = {
        "jumps": sum(len(defect.frames) for defect in defects),
        "flips": sum(defect.flips for defect in defects),
        "rest_pose_frames": facts.first,
        "frames": len(motion),
    }
    return {name: counted[name] if name in counted else float(measured[name]) for name in MEASURES}


def _off_the_floor(facts: ClipFacts) -> str | None:
    """Return at which height toes stand, where that is not the floor that measures go by."""
    heights, points = facts.tracks @ facts.up, facts.anatomy.sole_points
    toes = [plant for plant in facts.phases if points[plant.point].part == "toe"]
    stands = [float(heights[plant.start : plant.stop + 1, plant.point].mean()) for plant in toes]
    height = float(median(np.array(stands))) if stands else 0.0
    if abs(height) <= _OFF_THE_FLOOR * facts.anatomy.leg_length / STANDARD_LEG:
        return None
    return f"feet stand at {ground.axis_name(facts.up)} = {height:.4g}"


def _found(facts: ClipFacts) -> list[str]:
    anatomy = facts.anatomy
    parts = {"legs": anatomy.legs, "arms": anatomy.arms, "head": anatomy.head}
    return [part for part, found in parts.items() if found is not None]


def _line(record: Mapping[str, Any], stand: str | None) -> str:
    """Return a clip's line."""
    measures, unit = record["measures"], record["unit"]
    words = [
        f"{record['frame_rate']:.4g} Hz",
        f"{measures['frames']} frames",
        "unit unknown" if unit is None else f"{unit['name']}{'' if unit['likely'] else '?'}",
        f"{record['up']} up",
        ", ".join(record["found"]) or "nothing of a body found",
        f"skate {100.0 * measures['foot_skate_mean']:.3g} cm/s, {100.0 * measures['foot_skate_ratio']:.3g} %",
        f"sliding {100.0 * measures['foot_sliding_share']:.3g} %",
        f"under floor {100.0 * measures['floor_penetration_share']:.3g} %",
        f"floating {100.0 * measures['foot_floating_max']:.3g} cm",
        f"{measures['jumps']} jumps, {measures['flips']} flips",
        f"rest pose {measures['rest_pose_frames']}",
    ]
    if stand is not None:
        words.append(stand)
    reasons = f": {record['message']}" if record["message"] else ""
    return f"{record['clip']}: {record['status']}{reasons} ({'; '.join(words)})"
