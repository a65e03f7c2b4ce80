"""What every command ends with: paths on standard output, the rest on standard error, the report, the exit code."""

from __future__ import annotations

import os
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

import click

from motionedit.cli.boundary import complain, warn
from motionedit.cli.repeated import few_of_each_kind
from motionedit.cli.words import printable, to_stdout
from motionedit.errors import EXIT_DONE, MISSED, MotionEditError, SpecError
from motionedit.jobs.batch.no_result import ClusterLostError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.jobs.batch.run import BatchResult
    from motionedit.report.junit import Problem


def finish_batch(result: BatchResult, options: RunOptions, *, command: str, spec: Mapping[str, Any] | None) -> int:
    """Print and write all that a run came to; return its exit code."""
    from motionedit.report.record import report_pieces

    _say(result, options)
    on_stdout = options.report is not None and str(options.report) == "-"
    if options.dry_run:
        _show_plan(result, err=on_stdout)
    elif result.content is not None:
        write_stdout(result.content)
    elif not on_stdout and result.paths:
        _list(result.paths)
    if options.report is not None:
        report = report_pieces(command, result.records, spec=spec, more=result.more)
        write_report(report, options.report, dry_run=options.dry_run)
    return result.exit_code


def _list(paths: Sequence[str]) -> None:
    """Print the files written, one a line: as bytes for other programs, since a name need not be text."""
    shown = sys.stdout is not None and sys.stdout.isatty()
    to_stdout("\n".join(map(printable, paths)) if shown else b"\n".join(map(os.fsencode, paths)))


def _say(result: BatchResult, options: RunOptions) -> None:
    """Say on standard error what became of the clips: warnings, the table, what failed or was missed, the count."""
    from motionedit.report.table import results_table

    made = any(time is not None for time in result.seconds)
    if options.verbosity >= 0:
        _warn_of(result, options)
        if made and not options.dry_run:
            table = results_table(result.records, result.seconds, verbosity=options.verbosity)
            if table:  # of many clips that are ok it has no row
                click.echo(printable(table), err=True)
        if options.shard is not None and not result.records:
            click.echo(f"no clip belongs to shard {options.shard}: nothing to do", err=True)
        if result.current:
            click.echo(f"{result.current} up to date", err=True)
    statuses = _show_missed(result, options)
    show_failures(result.failures)
    is_news = made or result.exit_code or any(status != "ok" for status in statuses)
    if is_news and not options.dry_run:
        show_count(statuses, exit_code=result.exit_code, verbosity=options.verbosity)


def _warn_of(result: BatchResult, options: RunOptions) -> None:
    """Say what a run warns of; of more clips than have a row in the table, without -v, a few lines of each kind."""
    from motionedit.report.table import MOST_ROWS

    lines = result.warnings
    if options.verbosity == 0 and len(result.records) > MOST_ROWS:
        where = "-v" if options.dry_run else "--update -v"
        kinds = [(notice.kind, notice.line) for notice in result.notices]
        lines = [*few_of_each_kind(kinds, rest=f"of this kind: {where} tells of all")]
    for line in lines:
        warn(line)


def _show_missed(result: BatchResult, options: RunOptions) -> list[str]:
    """Name the clips whose goals were not met, and why, where no warning has: those of an earlier run.

    With -q only where they count, as errors. Returns the status of every clip.
    """
    say, statuses = complain if options.strict else warn, []
    for record, time in zip(result.records, result.seconds, strict=True):
        statuses.append(record["status"])
        warned = options.verbosity >= (0 if time is not None else 1)
        if record["status"] in MISSED and not warned and (options.strict or options.verbosity >= 0):
            say(f"{record['clip']}: {record['status'].replace('_', ' ')}: {record['message']}")
    return statuses


def show_count(statuses: Sequence[str], *, exit_code: int, verbosity: int) -> None:
    """Count several clips by status, on the line that ends what is said; with -q only where something went wrong."""
    from motionedit.report.table import count_line

    if len(statuses) > 1 and (verbosity >= 0 or exit_code != EXIT_DONE):
        click.echo(count_line(statuses), err=True)


def show_failures(failures: Sequence[MotionEditError]) -> None:
    """Say each failure on a line; a fault that many clips share is said once, with their number."""
    places = Counter(_place(error) for error in failures)
    said: set[tuple[object, ...]] = set()
    for error in failures:
        place = _place(error)
        if place is None:
            complain(str(error))
        elif place not in said:
            said.add(place)
            more = places[place] - 1
            others = f" (and in {more} more {'clip' if more == 1 else 'clips'})" if more else ""
            complain(f"{error}{others}")


def write_report(report: bytes | Iterable[bytes], path: Path, *, dry_run: bool = False) -> None:
    """Write a report, whole or in pieces, to its file, or to standard output for ``-``."""
    from motionedit.jobs.batch.files import clean_leftovers
    from motionedit.jobs.batch.one_clip import write_file

    if str(path) == "-":
        for piece in (report,) if isinstance(report, bytes) else report:
            write_stdout(piece)
    elif dry_run:
        click.echo(f"would write the report {path}")
    else:
        clean_leftovers([path.parent])
        write_file(path, report)


def write_tests(
    command: str,
    records: Sequence[dict[str, Any]],
    path: Path,
    *,
    problems: Mapping[str, Problem],
    spec: Mapping[str, Any] | None = None,
) -> None:
    """Write the report of a command that tests clips: JUnit where its name ends in .xml, else JSON.

    `problems` are the kinds of problem by the statuses of clips that do not pass.
    """
    from motionedit.report.junit import Case, junit_bytes
    from motionedit.report.record import report_bytes

    if path.suffix.lower() == ".xml":
        cases = [Case(one["clip"], problems.get(one["status"]), one["message"] or "") for one in records]
        write_report(junit_bytes(f"motionedit {command}", cases), path)
    else:
        write_report(report_bytes(command, records, spec=spec), path)


def write_stdout(data: bytes) -> None:
    """Write bytes, such as a clip, to standard output as they are."""
    to_stdout(data, end=False)


def _show_plan(result: BatchResult, *, err: bool) -> None:
    for heading, lines in result.details:
        click.echo(f"would write {printable(heading)}", err=err)
        for line in lines:
            click.echo(f"  {line}", err=err)


def _place(error: MotionEditError) -> tuple[object, ...] | None:
    """Return what is the same for clips that fail by one fault; None where each has its own."""
    if isinstance(error, ClusterLostError):
        return (error.message,)
    # What has a key is of a spec, or of rules that a model has kept.
    return (error.file, error.line, error.key) if isinstance(error, SpecError) or error.key is not None else None
