"""The command `motionedit preview`."""

from __future__ import annotations

import os
from pathlib import Path

import click

from motionedit.cli.options import (
    clips_argument,
    existing_file,
    lenient_option,
    output_option,
    overwrite_option,
    up_option,
)
from motionedit.cli.verbosity import verbosity_options
from motionedit.cli.words import to_stdout


@click.command(
    "preview",
    epilog="""\b
    Example, a clip before and after an edit, and what was asked of it:
      motionedit preview walk.bvh edited/walk.bvh -o walk.html --report walk.json""",
)
@clips_argument
@output_option("FILE", "The page (.html, moves) or the picture (.png or .svg, stands) to write.")
@overwrite_option
@up_option
@lenient_option
@click.option(
    "--report",
    metavar="FILE",
    type=click.Path(path_type=Path),
    callback=existing_file,
    help="The JSON report of an edit: a page shows its goals, intervals, paths and errors.",
)
@verbosity_options
def command(
    clips: tuple[Path, ...],
    output: str,
    overwrite: bool,  # noqa: FBT001  click passes its options by name
    up: str,
    lenient: bool,  # noqa: FBT001  as above
    report: Path | None,
) -> int:
    """Draw clips, overlaid, as a page or a picture.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.jobs.batch.outputs import refuse_existing
    from motionedit.jobs.preview import job as preview

    if not overwrite:
        refuse_existing([Path(output)])
    for path in preview.run(clips, Path(output), report=report, up=up, lenient=lenient):
        to_stdout(os.fsencode(path))  # as bytes: a name need not be text
    return 0
