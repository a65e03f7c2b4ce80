"""The options -v and -q, which count before and after the command's name alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from collections.abc import Callable

Function = TypeVar("Function", bound="Callable[..., Any]")

_KEY = "motionedit.verbosity"


def verbosity_options(function: Function) -> Function:
    """Add -v and -q to a command; `verbosity_of` tells their sum."""
    quiet = click.option(
        "-q", "--quiet", count=True, expose_value=False, callback=_less, help="Say only errors on standard error."
    )
    verbose = click.option(
        "-v",
        "--verbose",
        count=True,
        expose_value=False,
        callback=_more,
        help="Say more on standard error; -vv adds tracebacks.",
    )
    return verbose(quiet(function))


def verbosity_of(ctx: click.Context) -> int:
    """Return 0 as usual, 1 and 2 for -v and -vv, below 0 for -q."""
    verbosity: int = ctx.meta.get(_KEY, 0)
    return verbosity


def _more(ctx: click.Context, parameter: click.Parameter, count: int) -> None:
    del parameter
    ctx.meta[_KEY] = verbosity_of(ctx) + count


def _less(ctx: click.Context, parameter: click.Parameter, count: int) -> None:
    del parameter
    ctx.meta[_KEY] = verbosity_of(ctx) - count
