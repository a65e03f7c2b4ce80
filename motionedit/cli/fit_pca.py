"""The command `motionedit fit-pca`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from motionedit.cli.options import fit_options, output_option, set_option, spec_option

if TYPE_CHECKING:
    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.jobs.fit_pca.report import FitReport


@click.command(
    "fit-pca",
    epilog="""\b
    Example:
      motionedit fit-pca normalized/ -o golf.npz""",
)
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@output_option("MODEL.npz", "The model's file.")
@spec_option(required=False)
@set_option
@fit_options
def command(folder: Path, output: str, spec_path: Path | None, overrides: tuple[str, ...], options: RunOptions) -> int:
    """Fit a motion PCA model to normalized clips.

    DIR is the folder that normalize wrote; the clips that its normalization.json lists are read, and no others.
    Prints how much of the variance each component explains.
    """
    if output == "-" or Path(output).is_dir():
        raise click.UsageError(f"-o {output}: fit-pca writes a file; give a name such as model.npz")
    if overrides and spec_path is None:
        raise click.UsageError("--set overrides a key of a spec: give -s too")
    from motionedit.cli.finish import write_report
    from motionedit.jobs.batch.outputs import refuse_existing
    from motionedit.jobs.fit_pca import job
    from motionedit.report.record import report_bytes
    from motionedit.spec.load import load_spec

    if not options.overwrite:
        refuse_existing([Path(output), options.report])
    loaded = None if spec_path is None else load_spec(spec_path, "fit-pca", overrides=overrides)
    fit = job.run(folder, Path(output), loaded, options)
    if options.verbosity >= 0:
        _show(fit)
    if str(options.report) != "-":
        click.echo(output)
    if options.report is not None:
        spec = None if loaded is None else loaded.data
        write_report(report_bytes("fit-pca", [], spec=spec, more=fit.record), options.report)
    return 0


def _show(fit: FitReport) -> None:
    from motionedit.cli.boundary import warn
    from motionedit.report.table import text_table

    for warning in fit.warnings:
        warn(warning)
    click.echo(text_table(*fit.table), err=True)
    for note in fit.notes:
        click.echo(f"motionedit: {note}", err=True)
