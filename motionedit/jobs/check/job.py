"""Are clips fit for use, and a spec for them: a line a clip, limits that are passed, and errors."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.body import ground
from motionedit.core.body.anatomy import NOTHING_GIVEN
from motionedit.core.body.quality import find_defects
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import dataclass, replace
from motionedit.errors import EXIT_CLIP_FAILED, EXIT_DONE, EXIT_OUT_OF_TOLERANCE, MotionEditError, UsageError
from motionedit.jobs.batch.one_clip import read_task
from motionedit.jobs.batch.plan import find_clips
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.clip.metrics import clip_metrics, feet_of
from motionedit.jobs.clip.unit import likely_unit
from motionedit.regular_files import read_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.check.specs import SpecCheck
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.normalize.measures import ClipMeasure

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
class _Looked:
    """What a worker says of one clip.

    Its `record` without a verdict, None where there is a `failure`; the limits `passed`; the `errors` of the spec in
    it, and what normalize `measured`; where its feet `stand`, if that is not the floor.
    """

    record: dict[str, Any] | None
    passed: tuple[str, ...] = ()
    errors: tuple[MotionEditError, ...] = ()
    measured: ClipMeasure | None = None
    stand: str | None = None
    failure: MotionEditError | None = None


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

    A fault of the spec that several clips have is told whole in the first one's line.

    Raises
    ------
    UsageError
        No clip at all.
    """
    tasks = find_clips(clips)
    if check is not None:
        check = replace(check, others=tuple(task.relative for task in tasks))
    one = partial(_looked, limits=dict(limits), check=check, up=up, lenient=lenient)
    looked = zip(tasks, _each(one, tasks, jobs), strict=True)
    said: set[str] = set()
    for task, found in looked if check is None else _together(check, looked):
        yield _checked(task, found, limits, said)


def _each(one: Callable[[ClipTask], _Looked], tasks: Sequence[ClipTask], jobs: int) -> Iterator[_Looked]:
    if jobs == 1 or len(tasks) < 2:
        yield from map(one, tasks)
        return
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(jobs or None) as pool:
        yield from pool.map(one, tasks)


def _together(check: SpecCheck, looked: Iterator[tuple[ClipTask, _Looked]]) -> Iterator[tuple[ClipTask, _Looked]]:
    """Yield the clips, with what is wrong with them beside each other where the spec's command takes all at once."""
    if not check.takes_all:
        yield from looked
        return
    every = list(looked)
    unfit = check.unfit_together([(task, one.measured) for task, one in every if one.record and not one.errors])
    for task, one in every:
        more = unfit[task.label].errors if task.label in unfit else ()
        yield task, replace(one, errors=(*one.errors, *more), measured=None)


def exit_code(found: Sequence[Checked]) -> int:
    """Return 1 where a clip cannot be read, else 3 where one passes a limit or a spec does not fit, else 0."""
    statuses = {each.record["status"] for each in found}
    if "failed" in statuses:
        return EXIT_CLIP_FAILED
    return EXIT_OUT_OF_TOLERANCE if "unfit" in statuses else EXIT_DONE


def _looked(task: ClipTask, *, limits: Mapping[str, float], check: SpecCheck | None, up: str, lenient: bool) -> _Looked:
    faults, none = Faults(), None
    try:
        clip = read_task(task, lenient=lenient)
        facts = _facts(clip, task, check, faults, up=up)
    except MotionEditError as error:
        return _Looked(None, failure=error)
    measured = None if check is None else faults.get(partial(check.refuse_unfit, facts, task), otherwise=none)
    measures, stand = _measures(facts), _off_the_floor(facts)
    off = [] if stand is None else [f"{stand}: skate, depth and floating are measured from 0, the floor of the file"]
    record = {
        "frame_rate": facts.clip.motion.frame_rate,
        "up": ground.axis_name(facts.up),
        "unit": likely_unit(facts.anatomy.leg_length),
        "found": _found(facts),
        "measures": measures,
        "warnings": [*clip.warnings, *facts.warnings, *facts.anatomy.missing, *off],
    }
    passed = tuple(name for name, limit in limits.items() if measures[name] > limit)
    return _Looked(record, passed, tuple(faults.errors), measured, stand)


def _checked(task: ClipTask, looked: _Looked, limits: Mapping[str, float], said: set[str]) -> Checked:
    """Return what came of a clip; of faults whose place is in `said` its line gives the place alone."""
    if looked.record is None:
        failed = {"clip": task.label, "status": "failed", "message": str(looked.failure)}
        return Checked(failed, "", looked.failure)
    measures, errors = looked.record["measures"], [str(error) for error in looked.errors]
    passed = [f"{name} {measures[name]:.4g} above {limits[name]:.4g}" for name in looked.passed]
    places = [str(type(error)("", file=error.file, line=error.line, key=error.key)) for error in looked.errors]
    short = [f"{place}: as above" if place in said else error for place, error in zip(places, errors, strict=True)]
    said.update(place for place, error in zip(places, looked.errors, strict=True) if error.key is not None)
    record: dict[str, Any] = {
        "clip": task.label,
        "status": "unfit" if passed or errors else "ok",
        "message": "; ".join([*passed, *errors]) or None,
        **looked.record,
        "passed": list(looked.passed),
        "spec_errors": errors,
    }
    return Checked(record, _line(record, [*passed, *short], looked.stand))


def _facts(clip: Clip, task: ClipTask, check: SpecCheck | None, lacking: Faults, *, up: str) -> ClipFacts:
    """Return a clip's facts by the body and the up axis that a spec gives; joints that it lacks go to `lacking`."""
    if check is None:
        return facts_of(clip, up=up)
    given = lacking.get(partial(check.body_in, clip, task), otherwise=NOTHING_GIVEN)
    return facts_of(clip, up=check.loaded.model.up if up == "auto" else up, given=given)


def _measures(facts: ClipFacts) -> dict[str, float]:
    motion = facts.clip.motion
    measured = clip_metrics(facts, feet_of(facts, facts.world.blocks()), facts.phases, facts.steps)
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


def _line(record: Mapping[str, Any], reasons: Sequence[str], stand: str | None) -> str:
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
    why = f": {'; '.join(reasons)}" if reasons else ""
    return f"{record['clip']}: {record['status']}{why} ({'; '.join(words)})"
