"""The one place where errors become lines on standard error and an exit code."""

from __future__ import annotations

import errno
import sys
from typing import TYPE_CHECKING

import click

from motionedit.cli.words import printable
from motionedit.errors import EXIT_CLIP_FAILED, EXIT_DONE, EXIT_INTERRUPTED, EXIT_USAGE, MotionEditError

if TYPE_CHECKING:
    from collections.abc import Callable


class Interrupted(Exception):  # noqa: N818  no error: the user asked for it
    """Ctrl-C, in a form that click does not turn into its own; a run says in it how far it has come."""


def run_guarded(call: Callable[[], int | None]) -> int:
    """Return the exit code of a call; what it raises is said in one line each, with no traceback.

    A reader that stops reading, such as `head`, is click's to answer: silently, with exit code 1. On Windows
    it is ours.
    """
    try:
        return call() or EXIT_DONE
    except (Interrupted, KeyboardInterrupt, click.Abort) as stop:
        complain(" ".join(["interrupted", *map(str, stop.args)]))
        return EXIT_INTERRUPTED
    except Exception as error:  # noqa: BLE001  the last stop: whatever it is becomes one line
        if _is_reader_gone(error):
            sys.stdout = None  # or it would be tried once more at the end
            return EXIT_CLIP_FAILED
        lines, exit_code = _explained(error)
        for line in lines:
            complain(line)
        return exit_code


def complain(message: str) -> None:
    """Say one error on standard error."""
    click.echo(f"motionedit: error: {printable(' '.join(message.split()))}", err=True)


def warn(message: str) -> None:
    """Say one warning on standard error."""
    click.echo(f"motionedit: warning: {printable(' '.join(message.split()))}", err=True)


def show_unexpected(error: Exception, *, verbosity: int) -> None:
    """Print the traceback of an error that is no user's, where -vv asks for it."""
    known = (MotionEditError, OSError, MemoryError, click.ClickException, click.exceptions.Exit)
    if verbosity > 1 and not isinstance(error, (*known, click.Abort)):
        import traceback

        traceback.print_exception(error)


def _is_reader_gone(error: Exception) -> bool:
    """Tell whether this is how Windows says that a pipe has no reader: an invalid argument, of no file."""
    if sys.platform != "win32" or not isinstance(error, OSError):
        return False
    return error.errno == errno.EINVAL and error.filename is None


def _explained(error: Exception) -> tuple[list[str], int]:
    """Return the lines that say what went wrong, and the exit code."""
    if isinstance(error, MotionEditError):
        return [str(one) for one in error.errors], error.exit_code
    if isinstance(error, click.ClickException):
        return [_usage(error)], EXIT_USAGE
    if isinstance(error, OSError) and error.strerror:
        place = "" if error.filename is None else f"{error.filename}: "
        return [f"{place}{error.strerror}"], EXIT_CLIP_FAILED
    if isinstance(error, MemoryError):
        return ["out of memory"], EXIT_CLIP_FAILED
    return [f"unexpected {type(error).__name__}: {error}; please report it (-vv shows where)"], EXIT_CLIP_FAILED


def _usage(error: click.ClickException) -> str:
    """Return click's message in the form of ours: a small letter first, no full stop, and where to read on."""
    message = error.format_message().strip().rstrip(".").replace(". Did you", "; did you")
    message = message[:1].lower() + message[1:]
    context = getattr(error, "ctx", None)
    return f"{message}; see '{context.command_path} --help'" if context is not None else message
