"""How far a run has come: a bar on a terminal, a line for each tenth of many clips in a log, with -q nothing."""

from __future__ import annotations

import contextlib
import sys
from itertools import count
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

# Fewer clips are done before anybody looks into a log.
_MANY = 100
_LINES = 10


@contextlib.contextmanager
def progress_shown(length: int, *, verbosity: int = 0) -> Iterator[Callable[[], None]]:
    """Show on standard error how far a run of `length` clips has come, which each call of the value moves by one."""
    if length < 2 or verbosity < 0:
        yield lambda: None
    elif sys.stderr.isatty():
        with click.progressbar(length=length, file=sys.stderr, show_pos=True, label="clips") as bar:
            yield lambda: bar.update(1)
    elif length >= _MANY:
        done = count(1)
        yield lambda: _say_tenth(next(done), length)
    else:
        yield lambda: None


def _say_tenth(done: int, length: int) -> None:
    """Say how many clips are done where another tenth of them is: by their number, so that every log is the same."""
    if _LINES * done // length > _LINES * (done - 1) // length:
        click.echo(f"{done:,} of {length:,} clips", err=True)
