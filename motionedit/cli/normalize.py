"""The command `motionedit normalize`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from motionedit.cli.options import clips_argument, no_shards, output_option, run_options, set_option, spec_option

if TYPE_CHECKING:
    from motionedit.jobs.batch.plan import RunOptions


@click.command(
    "normalize",
    epilog="""\b
    Example, swings of different lengths brought to one, the hit at one frame:
      motionedit normalize swings/ -s golf-normalize.yaml -o normalized/""",
)
@clips_argument
@spec_option()
@output_option("DIR", "The folder for the normalized clips and normalization.json.")
@set_option
@run_options(keep_going=False)
@no_shards("normalize takes all clips together, since each one moves the means; give -j N on one machine")
def command(
    clips: tuple[Path, ...], spec_path: Path, output: str, overrides: tuple[str, ...], options: RunOptions
) -> int:
    """Bring clips of one behaviour onto one timeline.

    Every clip gets the same number of frames, its events fall on the same frames, and it starts at the same place
    and heading. One clip that fails stops the run, because each clip shifts the means; --keep-going leaves it out.

    CLIPS are BVH files or folders of them.
    """
    if output == "-" or output.lower().endswith(".bvh"):
        raise click.UsageError(f"-o {output}: normalize writes several files; give a folder")
    from motionedit.cli.boundary import complain
    from motionedit.cli.finish import finish_batch
    from motionedit.errors import EXIT_CLIP_FAILED
    from motionedit.jobs.normalize import job as normalize
    from motionedit.spec.load import load_spec

    loaded = load_spec(spec_path, "normalize", overrides=overrides)
    result = normalize.run(loaded, clips, Path(output), options)
    exit_code = finish_batch(result, options, command="normalize", spec=loaded.data)
    if exit_code == EXIT_CLIP_FAILED and not (options.keep_going or result.paths):
        complain("nothing was written, because each clip shifts the means; --keep-going leaves out those that fail")
    return exit_code
