"""The command `motionedit check`."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from motionedit.cli.options import (
    clips_argument,
    jobs_option,
    lenient_option,
    model_option,
    reference_option,
    spec_option,
    test_report_option,
    up_option,
)
from motionedit.cli.verbosity import verbosity_of, verbosity_options

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.jobs.check.job import Checked
    from motionedit.report.junit import Problem


class Limits(NamedTuple):
    """What --limit gives, and the file of --limits."""

    pairs: tuple[str, ...]
    file: Path | None


def _limit_options(function: Callable[..., int]) -> Callable[..., int]:
    """Return a command with the options that set limits, which it is given as one argument."""

    @click.option(
        "--limit",
        "limits",
        multiple=True,
        metavar="MEASURE=NUMBER",
        help="What a measure may be at most, such as foot_skate_ratio=0.1; may be repeated.",
    )
    @click.option(
        "--limits",
        "limits_file",
        metavar="FILE",
        type=click.Path(path_type=Path, dir_okay=False),
        help="Limits, one 'measure: number' a line; --limit goes before it.",
    )
    @functools.wraps(function)
    def collected(limits: tuple[str, ...], limits_file: Path | None, **values: Any) -> int:  # noqa: ANN401  of any option
        return function(limits=Limits(limits, limits_file), **values)

    return collected


class Against(NamedTuple):
    """The spec that clips are held against, and what its command is given beside it."""

    spec: Path | None
    model: Path | None
    reference: str | None


def _spec_options(function: Callable[..., int]) -> Callable[..., int]:
    """Return a command with the options of a spec, which it is given as one argument."""

    @spec_option(required=False)
    @model_option("The model that edit-pc is to use: what its spec asks of it is checked, too.", required=False)
    @reference_option("What edit-prioritized is to have as its reference, in place of the spec's.")
    @functools.wraps(function)
    def collected(spec_path: Path | None, model: Path | None, reference: str | None, **values: Any) -> int:  # noqa: ANN401  as above
        beside = {"-m": model, "--reference": reference}
        for name, value in beside.items():
            if value is not None and spec_path is None:
                raise click.UsageError(f"{name} stands beside a spec: give -s too")
        return function(against=Against(spec_path, model, reference), **values)

    return collected


@click.command(
    "check",
    epilog="""\b
    Example, a folder in which no toe may skate in a tenth of the frames:
      motionedit check takes/ --limit foot_skate_ratio=0.1""",
)
@clips_argument
@_spec_options
@_limit_options
@jobs_option
@up_option
@lenient_option
@test_report_option
@verbosity_options
def command(
    clips: tuple[Path, ...],
    against: Against,
    limits: Limits,
    jobs: int,
    up: str,
    lenient: bool,  # noqa: FBT001  click passes its options by name
    report: Path | None,
) -> int:
    """Tell whether clips, and a spec for them, are fit for use.

    Prints a line for each clip: rate, frames, unit, up, what of a body was found, skating and sliding feet, feet
    below the floor or above it, jumps, flips and rest-pose frames; with a spec also all that its own command would
    refuse; of edit-pc what asks nothing of the model, and with -m that, too. What clips share is told whole in the
    first one's line. A spec's body: and up: count for the measures. Several clips are counted at the end.

    Exits with 0; 3 where a clip passes a limit or the spec does not fit it; 1 where one cannot be read.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.cli.finish import show_count, show_failures, write_tests
    from motionedit.cli.words import printable, to_stdout
    from motionedit.jobs.batch.outputs import refuse_clashes
    from motionedit.jobs.batch.plan import find_clips
    from motionedit.jobs.check import job as check
    from motionedit.jobs.check.specs import spec_check

    given = [task.source for task in find_clips(clips)]
    reference = None if against.reference is None else Path(against.reference)
    refuse_clashes([("the report", report)], [*given, against.spec, against.model, reference, limits.file])
    held = check.limits_of(limits.pairs, limits.file)
    found: list[Checked] = []
    spec = None if against.spec is None else spec_check(against.spec, against.model, against.reference)
    for one in check.run(clips, limits=held, check=spec, up=up, lenient=lenient, jobs=jobs):
        found.append(one)
        if one.line and str(report) != "-":
            to_stdout(printable(one.line))
    show_failures([one.failure for one in found if one.failure is not None])
    exit_code = check.exit_code(found)
    statuses = [one.record["status"] for one in found]
    show_count(statuses, exit_code=exit_code, verbosity=verbosity_of(click.get_current_context()))
    if report is not None:
        problems: dict[str, Problem] = {"unfit": "failure", "failed": "error"}
        data = None if spec is None else spec.loaded.data
        write_tests("check", [one.record for one in found], report, problems=problems, spec=data)
    return exit_code
