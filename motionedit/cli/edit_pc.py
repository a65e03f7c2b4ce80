"""The command `motionedit edit-pc`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from motionedit.cli.options import (
    clips_argument,
    model_option,
    not_supported_yet,
    output_option,
    preview_option,
    run_options,
    set_option,
    shard_option,
    spec_option,
)

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.jobs.batch.plan import RunOptions


@click.command(
    "edit-pc",
    epilog="""\b
    Example, swings that are to meet the ball elsewhere:
      motionedit edit-pc swings/ -m golf.npz -s golf-edit.yaml -o edited/""",
)
@clips_argument
@model_option()
@spec_option()
@output_option("OUT", "A name ending in .bvh for one clip, '-' for standard output, else a folder.")
@set_option
@preview_option
@shard_option
@run_options(keep_going=True)
@not_supported_yet("--skeleton")
def command(
    clips: tuple[Path, ...],
    model: Path,
    spec_path: Path,
    output: str,
    overrides: tuple[str, ...],
    options: RunOptions,
) -> int:
    """Edit clips within the style of a PCA model.

    A goal asks that a point of the body be somewhere at one instant; the whole clip changes with it, in the way
    in which the clips of the model differ from each other.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.cli.finish import finish_batch
    from motionedit.jobs.edit_pc import job as edit_pc
    from motionedit.spec.load import load_spec

    loaded = load_spec(spec_path, "edit-pc", overrides=overrides)
    result = edit_pc.run(loaded, clips, output, model, options)
    return finish_batch(result, options, command="edit-pc", spec=loaded.data)
