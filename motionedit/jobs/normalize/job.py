"""The job behind `motionedit normalize`: clips of one behaviour onto one timeline ([PC] section 5).

Two phases: every clip is measured, the means are taken, then every clip is resampled and written.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from motionedit.core.timeline.alignment import align_each
from motionedit.dataclass import dataclass, replace
from motionedit.errors import EXIT_CLIP_FAILED, EXIT_USAGE, MotionEditError, UsageError
from motionedit.jobs.batch.held import let_go
from motionedit.jobs.batch.notices import Notice
from motionedit.jobs.batch.one_clip import write_file
from motionedit.jobs.batch.plan import find_clips, plan
from motionedit.jobs.batch.pool import standing_crew, workers_for
from motionedit.jobs.batch.run import BatchResult, earlier, failed_record, run_each
from motionedit.jobs.batch.values import map_tasks
from motionedit.jobs.batch.verdicts import run_key, verdicts_in
from motionedit.jobs.normalize.common_timeline import common_timeline, events_out_of_order
from motionedit.jobs.normalize.measures import ClipMeasure, MeasureClip, sound_measures
from motionedit.jobs.normalize.normalization_file import NAME, Normalization, NormalizedClip, normalization_bytes
from motionedit.jobs.normalize.resampling import ResampleClip

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from motionedit.core.timeline.alignment import Alignment
    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.processes import Crew
    from motionedit.jobs.batch.verdicts import Verdicts
    from motionedit.jobs.clip.facts import Line
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.normalize import NormalizeSpec


# Bytes of motions that are held from the first phase to the second, by all workers together.
_MOST_HELD = 1 << 26


@dataclass(frozen=True)
class Normalized:
    """What clips came to: the `result` of the run, and its `normalization`, None where nothing may be built on it."""

    result: BatchResult
    normalization: Normalization | None = None


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
    writes = [(NAME, output / NAME)]
    # One clip more or less moves the means.
    found = find_clips(clips, leave_out=output)
    if any(task.source is None for task in found):
        raise UsageError("'-' is not for normalize, which reads each clip twice; give files")
    listed = [(task.relative, task.label) for task in found]
    key = run_key("normalize", loaded.data, files=loaded.model.event_files, more=[listed, options.lenient])
    verdicts = verdicts_in(str(output), key, update=options.update, dry_run=options.dry_run)
    tasks = plan(
        clips, str(output), options=options, depends=loaded.files, writes=writes, verdicts=verdicts, found=found
    )
    if all(task.current for task in tasks) and (output / NAME).exists():
        return replace(earlier(tasks, options), more={"warnings": []})
    # One clip that changed moves the means: all are made anew.
    anew = [replace(task, current=False) if task.current else task for task in tasks]
    first = partial(_remove_list, output / NAME)
    normalized = normalize(loaded, anew, options=options, before_writing=first, verdicts=verdicts)
    if normalized.normalization is not None and not options.dry_run:
        write_file(output / NAME, normalization_bytes(normalized.normalization))
    return normalized.result


def _remove_list(path: Path) -> None:
    """Remove the list of an earlier run before the first of its clips is replaced.

    Until the new one is written, last, the folder may hold clips of both, and nothing may be built on it.
    """
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise UsageError(f"cannot be replaced: {error.strerror or error}", file=str(path)) from error


def normalize(
    loaded: LoadedSpec[NormalizeSpec],
    tasks: Sequence[ClipTask],
    *,
    options: RunOptions,
    before_writing: Callable[[], None] = lambda: None,
    verdicts: Verdicts | None = None,
) -> Normalized:
    """Normalize the clips of tasks, and write those that have an output; `before_writing` is called before the first.

    Raises
    ------
    SpecError
        As `run`.
    """
    try:
        with standing_crew(options, name_of=_name_of) as crew:
            return _both_phases(loaded, tasks, options, crew, before_writing, verdicts)
    finally:
        let_go()


def _name_of(item: ClipTask | tuple[ClipTask, ResampleClip]) -> str:
    """Return what the clip of an item of either phase is called."""
    return (item[0] if isinstance(item, tuple) else item).label


def _both_phases(
    loaded: LoadedSpec[NormalizeSpec],
    tasks: Sequence[ClipTask],
    options: RunOptions,
    crew: Crew | None,
    before_writing: Callable[[], None],
    verdicts: Verdicts | None,
) -> Normalized:
    held = _MOST_HELD // workers_for(len(tasks), options) if options.scheduler is None else 0
    measure = MeasureClip(loaded, options.lenient, tuple(task.relative for task in tasks), held)
    measured = map_tasks(measure, tasks, options, crew=crew)
    measures, failures = sound_measures(tasks, measured)
    if failures and (not options.keep_going or not measures):
        return Normalized(_failed(tasks, failures))
    timeline, warnings = common_timeline(loaded, measures)
    bad_order = events_out_of_order(loaded, measures, timeline)
    if bad_order and not options.keep_going:
        return Normalized(_failed(tasks, bad_order))
    failures |= bad_order
    good = [task for task in tasks if task.label not in failures]
    if not good:
        return Normalized(_failed(tasks, failures))
    line: Line = "feet" if all(measure.stands for measure in measures) else "hips"
    by_label = {measure.label: measure for measure in measures}
    used = [by_label[task.label] for task in good]
    align = loaded.model.align
    lines = [measure.lines[line] for measure in used]
    alignments = align_each(lines, heading=align.heading, position=align.position)
    works = [
        # Its lines have done their work, and to send them takes as long as to send the rest.
        ResampleClip(replace(measure, lines={}), timeline, alignment, loaded.model.unit, options.verify)
        for measure, alignment in zip(used, alignments, strict=True)
    ]
    if not options.dry_run:
        before_writing()
    result = run_each(list(zip(good, works, strict=True)), options, verdicts=verdicts, crew=crew)
    written = [record.get("clip_sha256", "") for record in result.records]
    normalization = None
    if not result.failures:
        clips = tuple(_normalized_clip(*each) for each in zip(used, alignments, written, strict=True))
        normalization = Normalization(timeline, used[0].up, _rules(loaded, line), clips)
    return Normalized(_with_failures(result, tasks, failures, warnings), normalization)


def _rules(loaded: LoadedSpec[NormalizeSpec], line: Line) -> dict[str, Any]:
    """Return what was done to the clips, as clips that come later are to be treated."""
    spec = loaded.model
    rules: dict[str, Any] = {
        "align": {
            "heading": spec.align.heading,
            "position": spec.align.position,
            "at": spec.align_event,
            "by": line,
        },
        "rest_pose": spec.rest_pose,
        "events": {name: _rule(loaded, name) for name in spec.events},
    }
    if spec.crop:
        rules["crop"] = spec.crop
    if spec.body.plain:
        rules["body"] = spec.body.plain
    return rules


def _normalized_clip(measure: ClipMeasure, alignment: Alignment, written: str) -> NormalizedClip:
    return NormalizedClip(
        clip=measure.clip,
        source=measure.label,
        digest=measure.digest,
        frames=measure.frames,
        duration=measure.duration,
        first=measure.first,
        events=measure.events,
        rotation=tuple(alignment.rotation.tolist()),
        origin=tuple(alignment.origin.tolist()),
        written=written,
    )


def _rule(loaded: LoadedSpec[NormalizeSpec], name: str) -> dict[str, Any] | None:
    """Return an event's detect rule as the spec has it, for clips that come later; None where it has none."""
    event = loaded.data["events"][name]
    return event.get("detect") if isinstance(event, dict) else None


def _nothing(exit_code: int) -> BatchResult:
    return BatchResult(records=[], paths=[], notices=[], failures=[], exit_code=exit_code)


def _failed(tasks: Sequence[ClipTask], failures: dict[str, MotionEditError]) -> BatchResult:
    """Return the result of a run that wrote nothing."""
    spec_alone = len(failures) == len(tasks) and all(e.exit_code == EXIT_USAGE for e in failures.values())
    records = [_failed_record(task, failures[task.label]) for task in tasks if task.label in failures]
    return replace(
        _nothing(EXIT_USAGE if spec_alone else EXIT_CLIP_FAILED),
        records=records,
        failures=_one_by_one(failures),
        seconds=[0.0] * len(records),
        more={"warnings": []},
    )


def _failed_record(task: ClipTask, error: MotionEditError) -> dict[str, Any]:
    return failed_record(task, "; ".join(map(str, error.errors)))


def _one_by_one(failures: dict[str, MotionEditError]) -> list[MotionEditError]:
    """Return the faults of clips, of which one may have several."""
    return [fault for error in failures.values() for fault in error.errors]


def _with_failures(
    result: BatchResult, tasks: Sequence[ClipTask], failures: dict[str, MotionEditError], warnings: list[str]
) -> BatchResult:
    """Return the result with the clips that the first phase left out, in the order of the tasks."""
    told = replace(result, notices=[*map(Notice, warnings), *result.notices], more={"warnings": warnings})
    if not failures:
        return told
    entries = {
        record["clip"]: (record, seconds) for record, seconds in zip(result.records, result.seconds, strict=True)
    }
    for task in tasks:
        if task.label in failures:
            entries[task.label] = (_failed_record(task, failures[task.label]), 0.0)
    ordered = [entries[task.label] for task in tasks if task.label in entries]
    return replace(
        told,
        records=[record for record, _ in ordered],
        seconds=[seconds for _, seconds in ordered],
        failures=[*_one_by_one(failures), *result.failures],
        exit_code=EXIT_CLIP_FAILED,
    )
