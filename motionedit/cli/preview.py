"""The command `motionedit preview`."""

from __future__ import annotations

from pathlib import Path

import click

from motionedit.cli.options import (
    clips_argument,
    lenient_option,
    not_supported_yet,
    output_option,
    overwrite_option,
)
from motionedit.cli.verbosity import verbosity_options


@click.command(
    "preview",
    epilog="""\b
    Example, a clip before and after an edit:
      motionedit preview walk.bvh edited/walk.bvh -o walk.html""",
)
@clips_argument
@output_option("FILE", "The page (.html, moves) or the picture (.png or .svg, stands) to write.")
@overwrite_option
@lenient_option
@not_supported_yet("--report")
@verbosity_options
def command(
    clips: tuple[Path, ...],
    output: str,
    overwrite: bool,  # noqa: FBT001  click passes its options by name
    lenient: bool,  # noqa: FBT001  as above
) -> int:
    """Draw clips, overlaid, as a page or a picture.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.jobs import preview
    from motionedit.jobs.plan import refuse_existing

    if not overwrite:
        refuse_existing([Path(output)])
    for path in preview.run(clips, Path(output), lenient=lenient):
        click.echo(path)
    return 0
