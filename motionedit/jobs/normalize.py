"""The job behind `motionedit normalize`: clips of one behaviour onto one timeline ([PC] section 5).

Two phases: every clip is measured, the means are taken, then every clip is resampled and written.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.bvh import resampled_bytes
from motionedit.core.ground import axis_name
from motionedit.core.quality import find_defects
from motionedit.core.skeleton_match import match_joints
from motionedit.core.timeline.alignment import aligned
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.warp import Timeline, make_warp, round_half_up
from motionedit.errors import (
    EXIT_CLIP_FAILED,
    EXIT_USAGE,
    ClipError,
    MotionEditError,
    UsageError,
)
from motionedit.jobs import resolve
from motionedit.jobs.batch import BatchResult, Outcome, atomic_write, map_tasks, plan, read_task, run_batch
from motionedit.jobs.clip_facts import facts_of
from motionedit.jobs.events import event_frames
from motionedit.jobs.normalization_file import NAME, Normalization, NormalizedClip, normalization_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.bvh import Clip
    from motionedit.core.skeleton import Skeleton
    from motionedit.jobs.batch import ClipTask, RunOptions
    from motionedit.jobs.clip_facts import ClipFacts
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.normalize import NormalizeSpec
    from motionedit.spec.times import Time

# Frame rates that differ by less than this share are one rate written with fewer or more digits.
RATE_TOLERANCE = 2e-3

# An event whose places after the first stage spread by more than this share of the timeline was found badly.
SPREAD_TOLERANCE = 0.05


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
        return run_batch(tasks, _Resample(loaded, Timeline(2, 1.0), {}), options)
    # One clip that changed moves the means: all are made anew.
    tasks = [replace(task, current=False) for task in tasks]
    measured = map_tasks(_Measure(loaded, options.lenient, tuple(task.relative for task in tasks)), tasks, options)
    measures, failures = _sound(tasks, measured)
    if failures and (not options.keep_going or not measures):
        return _failed(tasks, failures)
    timeline, warnings = _timeline(loaded, measures)
    bad_order = _unordered(measures, timeline)
    if bad_order and not options.keep_going:
        return _failed(tasks, bad_order)
    failures |= bad_order
    good = [task for task in tasks if task.label not in failures]
    if not good:
        return _failed(tasks, failures)
    by_label = {measure.label: measure for measure in measures}
    work = _Resample(loaded, timeline, by_label)
    result = run_batch(good, work, options)
    if not options.dry_run and not result.failures:
        done = [by_label[task.label] for task in good]
        _write_normalization(loaded, timeline, done, output)
    return _with_failures(result, tasks, failures, warnings)


@dataclass(frozen=True, eq=False)
class _Measured:
    """What the first phase takes from a clip: no frames."""

    label: str
    clip: str
    digest: str
    frames: int
    frame_time: float
    first: int
    events: dict[str, float]
    skeleton: Skeleton
    up: str
    height: float
    rotation: tuple[float, ...]
    origin: tuple[float, ...]

    @property
    def last(self) -> int:
        return self.frames - 1

    @property
    def duration(self) -> float:
        return (self.last - self.first) * self.frame_time


@dataclass(frozen=True)
class _Measure:
    """The first phase, on one clip."""

    loaded: LoadedSpec[NormalizeSpec]
    lenient: bool
    others: tuple[str, ...]

    def __call__(self, task: ClipTask) -> _Measured:
        spec = self.loaded.model
        clip = read_task(task, lenient=self.lenient)
        facts = facts_of(clip, up=spec.up, keep_rest_pose=spec.rest_pose == "keep")
        if facts.last - facts.first < 1:
            raise ClipError("has one frame; a motion needs two", file=task.label)
        events = _events(self.loaded, task, facts, self.others)
        align = spec.align
        at = None if spec.align_event is None else events[spec.align_event]
        alignment = facts.alignment(heading=align.heading, position=align.position, at=at)
        return _Measured(
            label=task.label,
            clip=task.relative,
            digest=clip.sha256,
            frames=len(clip.motion),
            frame_time=clip.motion.frame_time,
            first=facts.first,
            events=events,
            skeleton=clip.motion.skeleton,
            up=axis_name(facts.up),
            height=facts.anatomy.height,
            rotation=tuple(map(float, alignment.rotation)),
            origin=tuple(map(float, alignment.origin)),
        )


def _events(
    loaded: LoadedSpec[NormalizeSpec],
    task: ClipTask,
    facts: ClipFacts,
    others: Sequence[str],
) -> dict[str, float]:
    known = resolve.explicit_events(loaded, task.relative, others=others)
    place = resolve.Place(loaded, ("events",), task.label)
    frames = event_frames(loaded.model.events, facts, place, known={name: float(f) for name, f in known.items()})
    for name in loaded.model.events:
        if name not in frames:
            raise place.at(name).error(f"no frame for {task.label}; add it to frames, or give detect")
    return frames


def _sound(
    tasks: Sequence[ClipTask], measured: Sequence[_Measured | MotionEditError]
) -> tuple[list[_Measured], dict[str, MotionEditError]]:
    """Return the clips that can be used together, and why the others cannot; the first good clip is the measure."""
    sound: list[_Measured] = []
    failures: dict[str, MotionEditError] = {}
    for task, value in zip(tasks, measured, strict=True):
        if isinstance(value, MotionEditError):
            failures[task.label] = value
            continue
        try:
            _check_against(sound[0] if sound else value, value)
            sound.append(value)
        except ClipError as error:
            failures[task.label] = error
    return sound, failures


def _check_against(first: _Measured, other: _Measured) -> None:
    match_joints(first.skeleton, other.skeleton, height=first.height, label=other.label, against=first.label)
    if other.up != first.up:
        message = f"its up axis is {other.up}, that of {first.label} is {first.up}; turn the file, or set up:"
        raise ClipError(message, file=other.label)


def _timeline(loaded: LoadedSpec[NormalizeSpec], measures: Sequence[_Measured]) -> tuple[Timeline, list[str]]:
    """Return the common timeline, eq. (13) and (14), and warnings about it."""
    spec = loaded.model
    warnings = [f"'{measures[0].label}' is the only clip: there are no means to take"] if len(measures) == 1 else []
    rates = np.array([1.0 / measure.frame_time for measure in measures])
    rate = spec.frame_rate
    if rate is None:
        slow, fast = int(np.argmin(rates)), int(np.argmax(rates))
        if rates[fast] > (1.0 + RATE_TOLERANCE) * rates[slow]:
            message = (
                f"the clips' rates differ: {measures[slow].label} has {rates[slow]:.4g} Hz, {measures[fast].label} "
                f"{rates[fast]:.4g} Hz; set frame_rate: {rates[slow]:.4g}"
            )
            raise loaded.error(("frame_rate",), message)
        rate = float(np.median(rates))
    elif rate > (1.0 + RATE_TOLERANCE) * rates.min():
        slow = int(np.argmin(rates))
        warnings.append(
            f"frame_rate {rate:.4g} is finer than {measures[slow].label} at {rates[slow]:.4g} Hz: "
            "the corners between its frames will show in the components"
        )
    duration = float(np.mean([measure.duration for measure in measures]))
    frames = spec.frames if isinstance(spec.frames, int) else round_half_up(duration * rate) + 1
    if frames < 2:
        message = f"the mean duration {duration:.3g} s at {rate:.4g} Hz makes one frame; set frames or frame_rate"
        raise loaded.error(("frames",), message)
    events = []
    for name, event in spec.events.items():
        shares = np.array([(m.events[name] - m.first) / (m.last - m.first) for m in measures])
        if isinstance(event.target, str):
            at = round_half_up(float(shares.mean()) * (frames - 1))
        else:
            at = _target(loaded, name, event.target, frames, rate)
        events.append((name, at))
        if shares.std() > SPREAD_TOLERANCE:
            warnings.append(
                f"event '{name}' lies at {shares.min():.0%} to {shares.max():.0%} of the clips: was it found rightly? "
                "A badly found event is worse than none"
            )
    return Timeline(frames, rate, tuple(sorted(events, key=lambda pair: pair[1]))), warnings


def _target(loaded: LoadedSpec[NormalizeSpec], name: str, target: Time, frames: int, rate: float) -> int:
    try:
        return target.frame(frames=frames, frame_time=1.0 / rate, events={})
    except ValueError as error:
        raise loaded.error(("events", name, "target"), f"on the timeline of {frames} frames: {error}") from None


def _unordered(measures: Sequence[_Measured], timeline: Timeline) -> dict[str, MotionEditError]:
    failures: dict[str, MotionEditError] = {}
    knots = [0, *(frame for _, frame in timeline.events), timeline.frames - 1]
    if any(b <= a for a, b in itertools.pairwise(knots)):
        named = ", ".join(f"'{name}' at {frame}" for name, frame in timeline.events)
        message = (
            f"events must lie strictly inside the timeline of {timeline.frames} frames, one after the other: {named}"
        )
        return {measure.label: ClipError(message, file=measure.label) for measure in measures}
    for measure in measures:
        try:
            make_warp(timeline, first=measure.first, last=measure.last, events=measure.events, label=measure.label)
        except ClipError as error:
            failures[measure.label] = error
    return failures


@dataclass(frozen=True)
class _Resample:
    """The second phase, on one clip: both stages of [PC] section 5 in one resample, then alignment."""

    loaded: LoadedSpec[NormalizeSpec]
    timeline: Timeline
    measures: dict[str, _Measured]

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        from motionedit.core.timeline.alignment import Alignment

        measure, timeline = self.measures[task.label], self.timeline
        facts = facts_of(clip, up=measure.up, keep_rest_pose=True)
        warp = make_warp(timeline, first=measure.first, last=measure.last, events=measure.events, label=task.label)
        at = warp.to_source(np.arange(timeline.frames, dtype=np.float64))
        resampled = resample(clip.motion, at, frame_time=1.0 / timeline.frame_rate)
        alignment = Alignment(np.array(measure.rotation), np.array(measure.origin))
        motion = aligned(resampled, alignment, travel=facts.travel)
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
    loaded: LoadedSpec[NormalizeSpec], timeline: Timeline, measures: Sequence[_Measured], output: Path
) -> None:
    spec = loaded.model
    rules = {
        "align": {
            "heading": spec.align.heading,
            "position": spec.align.position,
            "at": spec.align_event,
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
            rotation=measure.rotation,
            origin=measure.origin,
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
