"""The options that commands share, each written once."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from motionedit.cli.progress import progress_shown
from motionedit.cli.verbosity import verbosity_of, verbosity_options
from motionedit.errors import UsageError

if TYPE_CHECKING:
    from motionedit.jobs.batch.shards import Shard

Function = Callable[..., Any]
Decorator = Callable[[Function], Function]

_PATH = click.Path(path_type=Path)


def existing_file(ctx: click.Context, parameter: click.Parameter, value: Path | None) -> Path | None:
    """Refuse a file that does not exist (click's own words for it are clumsy)."""
    del ctx, parameter
    if value is not None and not value.exists():
        raise UsageError("no such file", file=str(value))
    if value is not None and value.is_dir():
        raise UsageError("is a folder, not a file", file=str(value))
    return value


def not_negative(ctx: click.Context, parameter: click.Parameter, value: float | None) -> float | None:
    """Refuse a number below zero (click's own ranges clutter the help)."""
    if value is not None and not value >= 0:
        raise click.BadParameter(f"{value} is below 0", ctx=ctx, param=parameter)
    return value


def not_empty(ctx: click.Context, parameter: click.Parameter, value: Any) -> Any:  # noqa: ANN401  one or several
    """Refuse an empty name, which a shell makes of an unset variable, and which would mean the working folder."""
    if "" in (value if isinstance(value, tuple) else (value,)):
        raise click.BadParameter("an empty name", ctx=ctx, param=parameter)
    return tuple(map(Path, value)) if isinstance(value, tuple) else value


def not_junit(ctx: click.Context, parameter: click.Parameter, value: Path | None) -> Path | None:
    """Refuse a report's name that build servers read as JUnit, which this command does not write."""
    if value is not None and value.suffix.lower() == ".xml":
        message = f"{value} would be JSON; check and diff alone write JUnit: name it {value.with_suffix('.json')}"
        raise click.BadParameter(message, ctx=ctx, param=parameter)
    return value


def _report_option(text: str, callback: Callable[..., Any] | None = None) -> Decorator:
    return click.option(
        "--report",
        metavar="FILE",
        type=click.Path(path_type=Path, dir_okay=False, allow_dash=True),
        callback=callback,
        help=text,
    )


def one_shard(ctx: click.Context, parameter: click.Parameter, value: str | None) -> Shard | None:
    """Return the shard that is meant."""
    del ctx, parameter
    if value is None:
        return None
    from motionedit.jobs.batch.shards import shard_of

    return shard_of(value)


clips_argument = click.argument("clips", nargs=-1, required=True, metavar="CLIPS...", callback=not_empty)
set_option = click.option(
    "--set",
    "overrides",
    multiple=True,
    metavar="KEY=VALUE",
    help="Override one key of the spec, such as goals.ball.shift='[-10, 0, 0]'; may be repeated.",
)
lenient_option = click.option(
    "--lenient", is_flag=True, help="Accept a clip whose row count differs from 'Frames:', with a warning."
)
up_option = click.option(
    "--up",
    type=click.Choice(["y", "z", "x", "-y", "-z", "-x", "auto"]),
    default="auto",
    show_default=True,
    help="The axis of the clips that points up.",
)
report_option = _report_option("Write a JSON report; '-' prints it in place of the paths.", callback=not_junit)
test_report_option = _report_option(
    "Write a JSON report, or JUnit where the name ends in .xml; '-' prints it in place of the lines."
)
report_frames_option = click.option(
    "--report-frames/--no-report-frames",
    default=None,
    help="Tell in the report of every frame, or not.  [default: of one clip, yes; of several, no]",
)
jobs_option = click.option(
    "-j",
    "--jobs",
    default=1,
    show_default=True,
    metavar="N",
    type=int,
    callback=not_negative,
    help="Clips in parallel; 0 means all cores. The files are the same for any N.",
)
scheduler_option = click.option(
    "--scheduler",
    metavar="ADDRESS",
    callback=not_empty,
    help="Run on a Dask cluster instead (pip install 'motionedit[cluster]').",
)
shard_option = click.option(
    "--shard",
    metavar="K/N",
    callback=one_shard,
    help="Only the clips of shard K of N, by their names: for several machines.",
)
overwrite_option = click.option(
    "--no-overwrite",
    "overwrite",
    flag_value=False,
    default=True,
    help="Refuse, before any work, if an output or the report exists.",
)
dry_run_option = click.option(
    "--dry-run",
    is_flag=True,
    help="Print what would be done with each clip: events, goals, or layers with points and joints; write nothing.",
)

preview_option = click.option(
    "--preview", is_flag=True, help="Write a page next to each clip: input, edit, goals and constraints (NAME.html)."
)

_BEFORE = (
    jobs_option,
    scheduler_option,
    click.option(
        "--update",
        is_flag=True,
        help="Skip outputs that are newer than all they are made from and would be made the same.",
    ),
    overwrite_option,
)
_AFTER = (
    lenient_option,
    click.option(
        "--strict", is_flag=True, help="Exit with 3 where a goal is not within its tolerance or an edit is rough."
    ),
    dry_run_option,
    click.option(
        "--verify",
        is_flag=True,
        help="Read each file back with bvhio, an independent reader, and keep it only if the joints are in place.",
    ),
    report_option,
    verbosity_options,
)


def spec_option(*, required: bool = True) -> Decorator:
    """Return the option -s."""
    return click.option(
        "-s",
        "--spec",
        "spec_path",
        required=required,
        metavar="SPEC",
        type=_PATH,
        callback=existing_file,
        help="The YAML spec: what is to be done.",
    )


def model_option(text: str = "The model that fit-pca wrote.", *, required: bool = True) -> Decorator:
    """Return the option -m."""
    return click.option(
        "-m",
        "--model",
        required=required,
        metavar="MODEL.npz",
        type=_PATH,
        callback=existing_file,
        help=text,
    )


def reference_option(text: str) -> Decorator:
    """Return the option --reference."""
    return click.option("--reference", metavar="PATH", help=text)


def output_option(metavar: str, text: str) -> Decorator:
    """Return the option -o; its value is the text as typed, since ``-`` is no path."""
    return click.option("-o", "--output", required=True, metavar=metavar, callback=not_empty, help=text)


def run_options(*, keep_going: bool) -> Decorator:
    """Return a decorator that gives a command all options of a run, as one RunOptions named `options`.

    Parameters
    ----------
    keep_going : bool
        What the command does at a clip that fails, where the user does not say.
    """
    keep_going_option = click.option(
        "--keep-going/--fail-fast",
        default=keep_going,
        show_default=True,
        help="Go on past a clip that fails, or stop at it.",
    )
    return _collecting((*_BEFORE, keep_going_option, *_AFTER))


def _collecting(options: Sequence[Decorator]) -> Decorator:
    """Return a decorator that gives a command some options of a run as one RunOptions."""

    def decorate(function: Function) -> Function:
        @functools.wraps(function)
        def collected(**values: Any) -> Any:  # noqa: ANN401  the command's own value
            from motionedit.jobs.batch.plan import RunOptions

            if str(values["report"]) == str(values.get("output")) == "-":
                raise click.UsageError("-o - and --report - cannot both have standard output")
            names = RunOptions.__dataclass_fields__.keys() & values.keys()
            verbosity = verbosity_of(click.get_current_context())
            given = RunOptions(
                **{name: values.pop(name) for name in names},
                verbosity=verbosity,
                progress=functools.partial(progress_shown, verbosity=verbosity),
            )
            return function(options=given, **values)

        command: Function = collected
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


# Of a run that reads clips and writes one file.
fit_options = _collecting((jobs_option, scheduler_option, overwrite_option, report_option, verbosity_options))


def no_shards(reason: str) -> Decorator:
    """Return a decorator that refuses --shard, and says why."""

    def refuse(ctx: click.Context, parameter: click.Parameter, value: str | None) -> None:
        del ctx, parameter
        if value is not None:
            raise click.UsageError(f"--shard: {reason}")

    return click.option("--shard", hidden=True, expose_value=False, callback=refuse)


def not_supported_yet(*names: str) -> Decorator:
    """Return a decorator that refuses options whose work is not done yet, by name."""

    def refuse(ctx: click.Context, parameter: click.Parameter, value: str | None) -> None:
        del ctx
        if value is not None:
            raise click.UsageError(f"{parameter.opts[0]} is not supported yet")

    def decorate(function: Function) -> Function:
        command: Function = function
        for name in names:
            command = click.option(
                name, is_flag=False, flag_value="", hidden=True, expose_value=False, callback=refuse
            )(command)
        return command

    return decorate
