"""A run over many clips: each is read, worked on, verified and written where its worker is; results come in order."""

from __future__ import annotations

import os
from contextlib import closing, suppress
from dataclasses import field
from typing import TYPE_CHECKING, Any

from motionedit.dataclass import dataclass, replace
from motionedit.errors import (
    EXIT_CLIP_FAILED,
    EXIT_DONE,
    EXIT_OUT_OF_TOLERANCE,
    EXIT_USAGE,
    MISSED,
    MotionEditError,
)
from motionedit.jobs.batch.arrivals import Arrivals
from motionedit.jobs.batch.files import clean_leftovers
from motionedit.jobs.batch.notices import notices_of
from motionedit.jobs.batch.one_clip import Done, Outcome, RunOne, RunOwn
from motionedit.jobs.batch.plan import no_progress
from motionedit.jobs.batch.pool import results_as_they_come
from motionedit.jobs.batch.records import Records
from motionedit.jobs.batch.verdicts import Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from motionedit.jobs.batch.no_result import WorkerDiedError
    from motionedit.jobs.batch.notices import Notice
    from motionedit.jobs.batch.one_clip import Work
    from motionedit.jobs.batch.plan import ClipTask, RunOptions
    from motionedit.jobs.batch.processes import Crew
    from motionedit.jobs.batch.verdicts import Verdicts

    Ended = tuple[ClipTask, Done, dict[str, Any]]

_NANOSECONDS_STALE = 1_000_000_000


@dataclass(frozen=True)
class BatchResult:
    """What a run came to, clip by clip in the order of its tasks, whatever the number of workers.

    Attributes
    ----------
    records : sequence of dict
        Entries of the report's `clips`.
    paths : list of str
        The files written.
    notices : list of Notice
        What it warns of, with the clip's name where there are several; with -v of clips that are current, too.
    failures : list of MotionEditError
        Why clips failed; one clip may have several.
    exit_code : int
        As the command should end.
    seconds : list of float or None
        Wall time of each record's clip; None where an earlier run made it.
    details : list of (str, tuple of str)
        For --dry-run: a line for each clip, and the lines that belong to it.
    contents : list of (bytes or None)
        The clips of the records that have no output: one for standard output, or those that a caller takes.
    current : int
        How many outputs --update left alone.
    more : dict
        What the report has beside the fixed keys.
    """

    records: Sequence[dict[str, Any]]
    paths: list[str]
    notices: list[Notice]
    failures: list[MotionEditError]
    exit_code: int
    seconds: list[float | None] = field(default_factory=list)
    details: list[tuple[str, tuple[str, ...]]] = field(default_factory=list)
    contents: list[bytes | None] = field(default_factory=list)
    current: int = 0
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def warnings(self) -> list[str]:
        """The lines of all notices."""
        return [notice.line for notice in self.notices]

    @property
    def content(self) -> bytes | None:
        """The clip that goes to standard output."""
        return next((content for content in self.contents if content is not None), None)


def run_batch(
    tasks: Sequence[ClipTask], work: Work, options: RunOptions, *, verdicts: Verdicts | None = None
) -> BatchResult:
    """Do the same work on every clip but those that are elsewhere; see `run_each`.

    A KeyboardInterrupt says how far it has come, and, where verdicts are kept, how to go on.
    """
    options = replace(options, report_frames=options.tells_frames(len(tasks)))
    run_one = RunOne(_for_workers(options), work)
    tasks = [task for task in tasks if not task.elsewhere]
    waiting = [task for task in tasks if not task.current]
    try:
        return _run(tasks, run_one, waiting, options, verdicts)
    except KeyboardInterrupt as stop:
        if verdicts is None or not stop.args:
            raise
        raise KeyboardInterrupt(f"{stop.args[0]}: go on with --update") from None


def run_each(
    pairs: Sequence[tuple[ClipTask, Work]],
    options: RunOptions,
    *,
    verdicts: Verdicts | None = None,
    crew: Crew | None = None,
) -> BatchResult:
    """Read, work on, verify and write every clip that is not current, each with its own work.

    A clip fails alone; without `keep_going` the clips after a failed one are not begun. Where every clip fails
    by a fault of the spec, the exit code is that of a spec error. A clip that is current stands in the result with what
    `verdicts` know of it; what becomes of the others they are told.
    """
    options = replace(options, report_frames=options.tells_frames(len(pairs)))
    run_one = RunOwn(_for_workers(options))
    items = [(task, work) for task, work in pairs if not task.current]
    return _run([task for task, _ in pairs], run_one, items, options, verdicts, crew)


def earlier(tasks: Sequence[ClipTask], options: RunOptions) -> BatchResult:
    """Return what earlier runs came to, of tasks that are all current."""
    return _collect(_with_current(tasks, []), Records(), options, total=len(tasks), current=len(tasks))


def _run(
    tasks: Sequence[ClipTask],
    run_one: Callable[[Any], Done],
    items: Sequence[object],
    options: RunOptions,
    verdicts: Verdicts | None,
    crew: Crew | None = None,
) -> BatchResult:
    """Return what a run over tasks came to; `items` are what `run_one` takes of those that are not current."""
    from motionedit.core import bvh as _bvh  # noqa: F401  loaded once here, not in every forked worker

    waiting = [task for task in tasks if not task.current]
    folders = {task.output.parent for task in waiting if task.output is not None}
    done: list[Done] = []
    records = Records()
    arrivals = None if options.scheduler is None else Arrivals()
    try:
        if not options.dry_run:
            clean_leftovers(folders)
        results = results_as_they_come(
            run_one, items, options=options, is_last=lambda one: not options.keep_going and _has_failed(one), crew=crew
        )
        with closing(results), options.progress(len(waiting)) as advance:
            for ended in _ended(results, waiting, arrivals):
                # Before any of them counts as done: what is told of a stopped run is kept.
                if verdicts is not None:
                    _keep(ended, verdicts, frames=bool(options.report_frames))
                for _, one, record in ended:
                    records.append(record)
                    done.append(replace(one, outcome=replace(one.outcome, record={})))
                    advance()
    except KeyboardInterrupt:
        if len(tasks) < 2:
            raise
        come = len(tasks) - len(waiting) + len(done)
        raise KeyboardInterrupt(f"after {come:,} of {len(tasks):,} clips") from None
    finally:
        # Workers that were ended in the middle of a file could not clean up themselves.
        if not options.dry_run:
            clean_leftovers(folders)
    if verdicts is not None:
        verdicts.close()
    pairs = _with_current(tasks, done)
    if options.strict and not options.dry_run:
        _make_stale([task for task, one in pairs if one.outcome.status in MISSED and not one.errors])
    return _collect(pairs, records, options, total=len(tasks), current=len(tasks) - len(waiting))


def _ended(
    results: Iterable[list[Done | WorkerDiedError]], tasks: Sequence[ClipTask], arrivals: Arrivals | None
) -> Iterator[list[Ended]]:
    """Yield lists of clips that came together: the task of each, what became of it, its record."""
    following = iter(tasks)
    for come in results:
        ended = []
        for result, task in zip(come, following, strict=False):
            one = result if isinstance(result, Done) else Done(errors=(result,))
            one = one if arrivals is None else arrivals.checked(task, one)
            ended.append((task, one, _record(task, one)))
        yield ended


def _keep(ended: Sequence[Ended], verdicts: Verdicts, *, frames: bool) -> None:
    """Keep the verdicts on clips that were written just now; `frames` says whether their records tell of all frames."""
    verdicts.add(
        [
            verdicts.line(task.output, one.digest, Verdict(record, one.outcome.warnings, frames), stamp=task.stamp)
            for task, one, record in ended
            if one.digest is not None and task.output is not None
        ]
    )


def _with_current(tasks: Sequence[ClipTask], done: Sequence[Done]) -> list[tuple[ClipTask, Done]]:
    """Return each task with what became of it, in order: of those that are current, in the run that made them."""
    results = iter(done)
    pairs: list[tuple[ClipTask, Done]] = []
    for task in tasks:
        if not task.current:
            one = next(results, None)
            if one is not None:  # None: not begun, after --fail-fast
                pairs.append((task, one))
        elif task.verdict is not None:
            outcome = Outcome(None, task.verdict.record, str(task.verdict.record["status"]), task.verdict.warnings)
            pairs.append((task, Done(outcome, current=True)))
    return pairs


def _make_stale(tasks: Sequence[ClipTask]) -> None:
    """Make outputs older than what they are made from: `make` takes none for done that `--strict` does not take."""
    for task in tasks:
        if task.output is not None and task.source is not None and task.output.is_file():
            # Where the file is not ours to date, the exit code still tells.
            with suppress(OSError):
                before = task.source.stat().st_mtime_ns - _NANOSECONDS_STALE
                os.utime(task.output, ns=(before, before))


def _has_failed(result: Done | MotionEditError) -> bool:
    return not isinstance(result, Done) or bool(result.errors)


def _for_workers(options: RunOptions) -> RunOptions:
    """Return the options as workers get them: nothing that cannot be pickled, and nothing left to be told by."""
    return replace(options, progress=no_progress)


def _collect(
    pairs: Sequence[tuple[ClipTask, Done]], records: Records, options: RunOptions, *, total: int, current: int
) -> BatchResult:
    made, entries = [(task, one) for task, one in pairs if not one.current], _in_order(pairs, records)
    failures = [_named(error, task) for task, one in pairs for error in one.errors]
    return BatchResult(
        records=entries,
        paths=[str(path) for task, one in made if one.written for path in task.outputs],
        notices=notices_of(pairs, entries, alone=total == 1, every=options.verbosity > 0),
        failures=failures,
        exit_code=_exit_code([one for _, one in pairs], total, strict=options.strict),
        seconds=[None if one.current else one.seconds for _, one in pairs],
        details=[(_heading(task), one.outcome.details) for task, one in made if options.dry_run and not one.errors],
        contents=[one.outcome.content if isinstance(one.outcome.content, bytes) else None for _, one in made],
        current=current,
    )


def _in_order(pairs: Sequence[tuple[ClipTask, Done]], made: Records) -> Records:
    """Return the entries of all clips: those that this run made, and those of clips that are current among them."""
    if not any(one.current for _, one in pairs):
        return made
    following = iter(made)
    return Records(_record(task, one) if one.current else next(following) for task, one in pairs)


def _record(task: ClipTask, done: Done) -> dict[str, Any]:
    if done.errors:
        message = "; ".join(str(_named(error, task)) for error in done.errors)
        return failed_record(task, message)
    output = None if task.output is None else str(task.output)
    outcome = done.outcome
    about = {"clip": task.label, "output": output, "status": outcome.status, "message": None}
    return {**about, **outcome.record, "warnings": list(outcome.warnings)}


def failed_record(task: ClipTask, message: str) -> dict[str, Any]:
    """Return the entry of a clip that failed."""
    return {"clip": task.label, "output": None, "status": "failed", "message": message}


def _named(error: MotionEditError, task: ClipTask) -> MotionEditError:
    if error.file is not None:
        return error
    return type(error)(error.message, file=task.label, key=error.key)


def _heading(task: ClipTask) -> str:
    return f"{task.label} -> {', '.join(map(str, task.outputs)) or 'standard output'}"


def _exit_code(done: Sequence[Done], total: int, *, strict: bool) -> int:
    failed = [one for one in done if one.errors]
    if failed:
        fault_of_the_spec = len(failed) == total and all(
            error.exit_code == EXIT_USAGE for one in failed for error in one.errors
        )
        return EXIT_USAGE if fault_of_the_spec else EXIT_CLIP_FAILED
    missed = any(one.outcome.status in MISSED for one in done)
    return EXIT_OUT_OF_TOLERANCE if strict and missed else EXIT_DONE
