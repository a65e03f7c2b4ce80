"""The command `motionedit diff`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from motionedit.cli.options import lenient_option, not_negative, test_report_option
from motionedit.cli.repeated import few_of_each_kind
from motionedit.cli.verbosity import verbosity_of, verbosity_options
from motionedit.cli.words import printable, to_stdout

if TYPE_CHECKING:
    from motionedit.jobs.diff import Comparison
    from motionedit.report.junit import Problem

_PATH = click.Path(path_type=Path, allow_dash=True)


@click.command(
    "diff",
    epilog="""\b
    Example, a check that a new version still writes the same motions:
      motionedit diff expected/ written/ --report diff.xml""",
)
@click.argument("a", metavar="A", type=_PATH)
@click.argument("b", metavar="B", type=_PATH)
@click.option(
    "--tolerance-position",
    metavar="X",
    type=float,
    callback=not_negative,
    help="Largest distance of a joint that counts as the same, in the clip's unit.  "
    "[default: 1e-5 of the skeleton's height]",
)
@click.option(
    "--tolerance-angle",
    metavar="DEGREES",
    type=float,
    callback=not_negative,
    default=0.01,
    show_default=True,
    help="Largest turn of a joint that counts as the same.",
)
@lenient_option
@test_report_option
@verbosity_options
@click.pass_context
def command(
    ctx: click.Context,
    a: Path,
    b: Path,
    tolerance_position: float | None,
    tolerance_angle: float,
    lenient: bool,  # noqa: FBT001  click passes its options by name
    report: Path | None,
) -> int:
    """Tell whether two clips or folders hold the same motion.

    A and B are two clips, or two folders whose clips are paired by their path below them. Joints are matched by
    name and compared by their positions in the world and their angles, so another text of the same motion is no
    difference. Of many clips that are missing on one side a few are named; -v names all.

    Exits with 0 for the same motion, 3 for another one or a clip that is missing on one side, and 2 where a pair
    cannot be compared: unreadable, another skeleton, frame count or frame rate.
    """
    from motionedit.cli.boundary import complain
    from motionedit.cli.finish import write_tests
    from motionedit.jobs import diff

    comparisons = diff.run(
        a,
        b,
        tolerance_position=tolerance_position,
        tolerance_angle=tolerance_angle,
        lenient=lenient,
        report=report,
    )
    for one in comparisons:
        if one.status == "not_comparable":
            complain(one.message)
    if str(report) != "-":
        if diff.share_no_name(comparisons) and verbosity_of(ctx) <= 0:
            message = "clips are paired by their path below the two folders; give folders with the same names"
            to_stdout(printable(f"no clip of {a} has the name of one of {b}: {message}"))
        else:
            _print(comparisons, verbosity=verbosity_of(ctx))
        _count(comparisons)
    if report is not None:
        problems: dict[str, Problem] = {"different": "failure", "missing": "failure", "not_comparable": "error"}
        write_tests("diff", [one.record() for one in comparisons], report, problems=problems)
    return diff.exit_code(comparisons)


def _print(comparisons: list[Comparison], *, verbosity: int) -> None:
    """Print what differs, and pairs that are the same only where they are few or asked for, as are many on one side."""
    from motionedit.report.table import MOST_ROWS

    lines: list[tuple[str | None, str]] = []
    for one in comparisons:
        if one.status in ("different", "missing"):
            lines.append((one.message if one.status == "missing" else None, f"{one.name}: {one.status}: {one.message}"))
        elif one.status == "same" and (len(comparisons) == 1 or verbosity > 0):
            lines.append((None, f"{one.name}: same"))
    every = verbosity > 0 or len(comparisons) <= MOST_ROWS
    for line in [line for _, line in lines] if every else few_of_each_kind(lines, rest="{kind}; -v names all"):
        to_stdout(printable(line))


def _count(comparisons: list[Comparison]) -> None:
    """Count several pairs by what came of them."""
    if len(comparisons) > 1:
        counts = Counter(one.status.replace("_", " ") for one in comparisons)
        to_stdout(f"{len(comparisons)} clips: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
