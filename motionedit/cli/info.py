"""The command `motionedit info`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from motionedit.cli.options import clips_argument, lenient_option, report_option, up_option
from motionedit.cli.verbosity import verbosity_of, verbosity_options

if TYPE_CHECKING:
    from pathlib import Path


@click.command(
    "info",
    epilog="""\b
    Example, where the right toe is at frame 58, as YAML to paste into a spec:
      motionedit info walk.bvh --at 58 --joint RightToeBase""",
)
@clips_argument
@click.option("--at", multiple=True, metavar="TIME", help="A frame, or a time such as 1.5s or 50%; may be repeated.")
@click.option(
    "--joint",
    "joints",
    multiple=True,
    metavar="EFFECTOR",
    help="A joint whose position and orientation are printed at each --at; may be repeated.",
)
@click.option("--contacts", is_flag=True, help="List when each foot stands still on the ground.")
@up_option
@lenient_option
@report_option
@verbosity_options
def command(
    clips: tuple[Path, ...],
    at: tuple[str, ...],
    joints: tuple[str, ...],
    contacts: bool,  # noqa: FBT001  click passes its options by name
    up: str,
    lenient: bool,  # noqa: FBT001  as above
    report: Path | None,
) -> int:
    """Show what is in a clip.

    Prints the joint tree with exact names and channels, frames, rate and duration, which way is up and which way
    the character faces, its leg length and likely unit, rest-pose frames, defects of the capture, hinges, and the
    joint that carries the travel. The tree of several clips that have the same is printed once.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.cli.finish import show_count, show_failures, write_report
    from motionedit.cli.words import printable, to_stdout
    from motionedit.errors import EXIT_CLIP_FAILED, EXIT_DONE
    from motionedit.jobs.batch.outputs import refuse_clashes
    from motionedit.jobs.batch.plan import find_clips
    from motionedit.jobs.info import job as info
    from motionedit.report.record import report_bytes

    if bool(at) != bool(joints):
        raise click.UsageError("--at and --joint go together: when, and what of the body")
    refuse_clashes([("the report", report)], [task.source for task in find_clips(clips)])
    found = info.run(clips, at=list(at), joints=list(joints), contacts=contacts, up=up, lenient=lenient)
    if str(report) != "-" and found.text:
        to_stdout(printable(found.text.rstrip("\n")))
    show_failures(found.failures)
    exit_code = EXIT_CLIP_FAILED if found.failures else EXIT_DONE
    statuses = [record["status"] for record in found.records]
    show_count(statuses, exit_code=exit_code, verbosity=verbosity_of(click.get_current_context()))
    if report is not None:
        write_report(report_bytes("info", found.records), report)
    return exit_code
