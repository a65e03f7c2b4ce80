"""The job behind `motionedit normalize`: clips of one behaviour onto one timeline ([PC] section 5).

Two phases: every clip is measured, the means are taken, then every clip is resampled and written.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.ground import travel_joint
from motionedit.core.body.quality import find_defects
from motionedit.core.bvh import resampled_bytes
from motionedit.core.timeline.alignment import aligned
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.warp import Timeline, make_warp
from motionedit.dataclass import dataclass
from motionedit.errors import (
    EXIT_CLIP_FAILED,
    EXIT_USAGE,
    MotionEditError,
    UsageError,
)
from motionedit.jobs.batch.run import BatchResult, ClipTask, Outcome, atomic_write, map_tasks, plan, run_batch
from motionedit.jobs.normalize.common_timeline import common_timeline, events_out_of_order
from motionedit.jobs.normalize.measures import ClipMeasure, MeasureClip, sound_measures
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, normalization_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.jobs.batch.run import RunOptions
    from motionedit.jobs.clip.facts import Line
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.normalize import NormalizeSpec


def run(loaded: LoadedSpec[NormalizeSpec], clips: Sequence[Path], output: Path, options: RunOptions) -> BatchResult:
    """Normalize clips and write them, with normalization.json, into a folder.

    Unless `options.keep_going`, nothing is written where one clip fails.

    Raises
    ------
    SpecError
        The clips' rates differ and the spec gives none.
    UsageError
        As `plan`; or standard input is given.
    """
    tasks = plan(clips, str(output), options=options, depends=loaded.files)
    if any(task.source is None for task in tasks):
        raise UsageError("'-' is not for normalize, which reads each clip twice; give files")
    if all(task.current for task in tasks) and (output / NAME).exists():
        return run_batch(tasks, _Resample(loaded, Timeline(2, 1.0), "hips"), options)
    # One clip that changed moves the means: all are made anew.
    tasks = [replace(task, current=False) for task in tasks]
    measured = map_tasks(MeasureClip(loaded, options.lenient, tuple(task.relative for task in tasks)), tasks, options)
    measures, failures = sound_measures(tasks, measured)
    if failures and (not options.keep_going or not measures):
        return _failed(tasks, failures)
    timeline, warnings = common_timeline(loaded, measures)
    bad_order = events_out_of_order(measures, timeline)
    if bad_order and not options.keep_going:
        return _failed(tasks, bad_order)
    failures |= bad_order
    good = [task for task in tasks if task.label not in failures]
    if not good:
        return _failed(tasks, failures)
    line: Line = "feet" if all(measure.stands for measure in measures) else "hips"
    by_label = {measure.label: measure for measure in measures}
    result = run_batch(
        [_MeasuredTask(**vars(task), measure=by_label[task.label]) for task in good],
        _Resample(loaded, timeline, line),
        options,
    )
    if not options.dry_run and not result.failures:
        done = [by_label[task.label] for task in good]
        _write_normalization(loaded, timeline, line, done, output)
    return _with_failures(result, tasks, failures, warnings)


@dataclass(frozen=True)
class _MeasuredTask(ClipTask):
    """A clip that has been measured."""

    measure: ClipMeasure | None = None


@dataclass(frozen=True)
class _Resample:
    """The second phase, on one clip: both stages of [PC] section 5 in one resample, then alignment."""

    loaded: LoadedSpec[NormalizeSpec]
    timeline: Timeline
    line: Line

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        measure = task.measure if isinstance(task, _MeasuredTask) else None
        if measure is None:
            raise TypeError("a clip is resampled after it has been measured")
        timeline = self.timeline
        warp = make_warp(timeline, first=measure.first, last=measure.last, events=measure.events, label=task.label)
        at = warp.to_source(np.arange(timeline.frames, dtype=np.float64))
        resampled = resample(clip.motion, at, frame_time=1.0 / timeline.frame_rate)
        motion = aligned(resampled, measure.alignments[self.line], travel=travel_joint(clip.motion))
        skeleton = clip.motion.skeleton
        defects = find_defects(clip.motion, first=measure.first)
        warnings = tuple(
            f"'{skeleton.names[defect.joint]}' jumps by {np.degrees(defect.angle):.0f} degrees into frame "
            f"{defect.worst}: a capture defect? fit-pca can leave it out (exclude_joints)"
            for defect in defects
        )
        unit = self.loaded.model.unit
        record = {
            "unit": None if unit is None else unit.name,
            "frames": [measure.frames, timeline.frames],
            "first_frame": measure.first,
            "events": dict(measure.events),
        }
        places = ", ".join(f"{name} {frame:.2f}" for name, frame in measure.events.items())
        details = (f"frames {measure.first} to {measure.last} -> {timeline.frames}; {places}".rstrip("; "),)
        return Outcome(resampled_bytes(clip, motion), record, warnings=warnings, motion=motion, details=details)


def _write_normalization(
    loaded: LoadedSpec[NormalizeSpec], timeline: Timeline, line: Line, measures: Sequence[ClipMeasure], output: Path
) -> None:
    spec = loaded.model
    rules = {
        "align": {
            "heading": spec.align.heading,
            "position": spec.align.position,
            "at": spec.align_event,
            "by": line,
        },
        "rest_pose": spec.rest_pose,
        "events": {name: _rule(loaded, name) for name in spec.events},
    }
    clips = tuple(
        NormalizedClip(
            clip=measure.clip,
            source=measure.label,
            digest=measure.digest,
            frames=measure.frames,
            duration=measure.duration,
            first=measure.first,
            events=measure.events,
            rotation=tuple(map(float, measure.alignments[line].rotation)),
            origin=tuple(map(float, measure.alignments[line].origin)),
        )
        for measure in measures
    )
    normalization = Normalization(timeline, measures[0].up, rules, clips)
    atomic_write(output / NAME, normalization_bytes(normalization))


def _rule(loaded: LoadedSpec[NormalizeSpec], name: str) -> dict[str, Any] | None:
    """Return an event's detect rule as the spec has it, for clips that come later; None where it has none."""
    event = loaded.data["events"][name]
    return event.get("detect") if isinstance(event, dict) else None


def _failed(tasks: Sequence[ClipTask], failures: dict[str, MotionEditError]) -> BatchResult:
    """Return the result of a run that wrote nothing."""
    spec_alone = len(failures) == len(tasks) and all(e.exit_code == EXIT_USAGE for e in failures.values())
    records = [_failure_record(task, failures[task.label]) for task in tasks if task.label in failures]
    return BatchResult(
        records=records,
        paths=[],
        warnings=[],
        failures=list(failures.values()),
        exit_code=EXIT_USAGE if spec_alone else EXIT_CLIP_FAILED,
        seconds=[0.0] * len(records),
    )


def _failure_record(task: ClipTask, error: MotionEditError) -> dict[str, Any]:
    return {"clip": task.label, "output": None, "status": "failed", "message": str(error)}


def _with_failures(
    result: BatchResult, tasks: Sequence[ClipTask], failures: dict[str, MotionEditError], warnings: list[str]
) -> BatchResult:
    """Return the result with the clips that the first phase left out, in the order of the tasks."""
    entries = dict(
        zip(
            (record["clip"] for record in result.records), zip(result.records, result.seconds, strict=True), strict=True
        )
    )
    for task in tasks:
        if task.label in failures:
            entries[task.label] = (_failure_record(task, failures[task.label]), 0.0)
    ordered = [entries[task.label] for task in tasks if task.label in entries]
    return replace(
        result,
        records=[record for record, _ in ordered],
        seconds=[seconds for _, seconds in ordered],
        warnings=[*warnings, *result.warnings],
        failures=[*failures.values(), *result.failures],
        exit_code=EXIT_CLIP_FAILED if failures else result.exit_code,
    )
