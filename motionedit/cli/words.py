"""Names of files and joints as a terminal may have them: what would steer it, or is no text, is shown as its number."""

from __future__ import annotations

import errno
import sys

import click

from motionedit.errors import ClipError

_STDOUT = "standard output"


def printable(text: str) -> str:
    r"""Return a text of any lines with escapes, other control characters and bytes that are no letters as ``\x1b``."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t" else c.encode("unicode_escape").decode() for c in text)


def to_stdout(text: str | bytes, *, end: bool = True) -> None:
    """Write text or bytes to standard output, as they are.

    Raises
    ------
    ClipError
        It is closed, or full. A reader that stops reading is click's to answer.
    """
    if sys.stdout is None:
        raise ClipError("is closed", file=_STDOUT)
    try:
        click.echo(text, nl=end)
    except OSError as error:
        if error.errno in (errno.EPIPE, errno.EINVAL):
            raise
        raise ClipError(f"cannot be written: {error.strerror or error}", file=_STDOUT) from error
