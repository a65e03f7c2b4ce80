"""The command `motionedit edit-prioritized`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from motionedit.cli.options import (
    clips_argument,
    not_supported_yet,
    output_option,
    preview_option,
    reference_option,
    report_frames_option,
    run_options,
    set_option,
    shard_option,
    spec_option,
)

if TYPE_CHECKING:
    from pathlib import Path

    from motionedit.jobs.batch.plan import RunOptions


@click.command(
    "edit-prioritized",
    epilog="""\b
    Example, a foot that is to step 22 units higher, in every clip of a folder:
      motionedit edit-prioritized walks/ -s step.yaml -o edited/ -j 0""",
)
@clips_argument
@spec_option()
@output_option("OUT", "A name ending in .bvh for one clip, '-' for standard output, else a folder.")
@set_option
@reference_option(
    "Another version of the clip, or a folder of them, whose plants footplants keep; in place of the spec's."
)
@preview_option
@shard_option
@run_options(keep_going=True)
@report_frames_option
@not_supported_yet("--skeleton")
def command(
    clips: tuple[Path, ...],
    spec_path: Path,
    output: str,
    overrides: tuple[str, ...],
    reference: str | None,
    options: RunOptions,
) -> int:
    """Edit clips by constraints in priority layers.

    Each constraint of the spec asks for a position, an orientation, a pose, balance or a gaze over an interval of
    time. Where they conflict, the higher priority is met first, and a lower one takes only the freedom that is
    left. Frames and joints that no constraint reaches keep their text in the file.

    CLIPS are BVH files, folders of them, or '-' for standard input.
    """
    from motionedit.cli.finish import finish_batch
    from motionedit.jobs.edit_prioritized import job as edit_prioritized
    from motionedit.spec.load import load_spec, with_reference

    loaded = load_spec(spec_path, "edit-prioritized", overrides=overrides)
    if reference is not None:
        loaded = with_reference(loaded, reference)
    result = edit_prioritized.run(loaded, clips, output, options)
    return finish_batch(result, options, command="edit-prioritized", spec=loaded.data)
