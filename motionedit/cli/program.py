"""The program `motionedit`: its commands, loaded one by one as they are asked for."""

from __future__ import annotations

import atexit
import gc
import importlib
import os
import sys
from typing import Any, NoReturn

import click

from motionedit.cli.boundary import Interrupted, run_guarded, show_unexpected
from motionedit.cli.streams import take_every_letter
from motionedit.cli.verbosity import verbosity_of, verbosity_options
from motionedit.version import __version__

# In the order of work. Help must not load the commands, so their first lines stand here; a test compares them.
COMMANDS = {
    "normalize": "Bring clips of one behaviour onto one timeline.",
    "fit-pca": "Fit a motion PCA model to normalized clips.",
    "edit-pc": "Edit clips within the style of a PCA model.",
    "edit-prioritized": "Edit clips by constraints in priority layers.",
    "info": "Show what is in a clip.",
    "diff": "Tell whether two clips or folders hold the same motion.",
    "preview": "Draw clips, overlaid, as a page or a picture.",
    "check": "Tell whether clips, and a spec for them, are fit for use.",
    "schema": "Print the JSON Schema of a command's spec.",
}

# One thread each, or small solves get many times slower and bytes could depend on the number of cores.
_BLAS_THREADS = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
_OBJECTS_BETWEEN_COLLECTIONS = 1_000_000


class _Program(click.Group):
    """A group that knows its commands by name, and turns every error into one line and an exit code."""

    def main(self, *args: Any, **extra: Any) -> NoReturn:  # noqa: ANN401  as click's own
        """Run one command line and exit with its code."""
        take_every_letter()
        for name in _BLAS_THREADS:
            os.environ[name] = "1"
        # Modules and specs make many objects and no garbage: to look for it every 700 of them takes a tenth of a short
        # edit.
        gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)
        # At the end the memory goes with the process: to search it for cycles once more takes a fifth of a short edit.
        atexit.register(gc.freeze)
        extra.update(standalone_mode=False, prog_name="motionedit")
        sys.exit(run_guarded(lambda: super(_Program, self).main(*args, **extra)))

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401  as click's own
        """Run the command; here its verbosity is known, which says how much of a fault of ours is shown."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:
            raise Interrupted(*error.args) from error
        except Exception as error:
            show_unexpected(error, verbosity=verbosity_of(ctx))
            raise

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of work."""
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command from its own module, loaded now."""
        del ctx
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"motionedit.cli.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that the arguments begin with, or suggest the nearest one."""
        if args[0] not in COMMANDS and not args[0].startswith("-") and not ctx.resilient_parsing:
            import difflib

            begun = [name for name in COMMANDS if name.startswith(args[0])]
            near = begun or difflib.get_close_matches(args[0], COMMANDS, n=1)
            hint = "did you mean " + " or ".join(f"'{name}'" for name in near) + "?"
            hint = hint if near else f"one of: {', '.join(COMMANDS)}"
            raise click.UsageError(f"no command '{args[0]}'; {hint}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands with their first lines, without loading them."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _show_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:  # noqa: FBT001  as click calls it
    if wanted and not ctx.resilient_parsing:
        from motionedit.core.compiled import solver_name

        click.echo(f"motionedit {__version__} ({solver_name()} solver)")
        ctx.exit()


@click.group(
    cls=_Program,
    context_settings={"help_option_names": ["-h", "--help"]},
    invoke_without_command=True,
    epilog="""\b
    Example:
      motionedit edit-prioritized walks/ -s step.yaml -o edited/""",
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_version,
    help="Show the version and exit.",
)
@verbosity_options
@click.pass_context
def main(ctx: click.Context) -> None:
    """Edit BVH motion clips in batches: constraints in YAML in, edited clips out.

    'motionedit COMMAND --help' tells what a command takes.

    Exit codes: 0 done; 1 a clip failed, others were written (by normalize, none); 2 a wrong command line or spec,
    nothing was started; 3 a goal out of tolerance or a rough edit with --strict, or another motion in diff; 130
    interrupted.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help(), err=True)
        ctx.exit(2)
