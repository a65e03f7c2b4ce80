"""The progress bar: only on a terminal, and only where there is something to wait for."""

from __future__ import annotations

import contextlib
import sys
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextlib.contextmanager
def progress_on_terminal(length: int) -> Iterator[Callable[[], None]]:
    """Show a bar on standard error that each call of the value moves by one clip."""
    if length < 2 or not sys.stderr.isatty():
        yield lambda: None
        return
    with click.progressbar(length=length, file=sys.stderr, show_pos=True, label="clips") as bar:
        yield lambda: bar.update(1)
