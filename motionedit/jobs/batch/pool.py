"""One function over many items, in this process, in several, or on a cluster; results always in the items' order."""

from __future__ import annotations

import os
from contextlib import closing, nullcontext
from typing import TYPE_CHECKING, Any, TypeVar

from motionedit.interrupts import clean_up_first

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Hashable, Sequence
    from contextlib import AbstractContextManager

    from motionedit.jobs.batch.no_result import WorkerDiedError
    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.jobs.batch.processes import Crew

Item = TypeVar("Item")
Result = TypeVar("Result")

# Windows cannot wait for more processes at once.
_MOST_WORKERS = 60
# Bytes from which an array's memory goes back to the system.
_LARGE = 1 << 25


def results_in_order(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    options: RunOptions,
    is_last: Callable[[Result | WorkerDiedError], bool] = lambda _: False,
    crew: Crew | None = None,
) -> Generator[Result | WorkerDiedError]:
    """Yield function(item) for each item, in order; see `results_as_they_come`."""
    return _each(results_as_they_come(function, items, options=options, is_last=is_last, crew=crew))


def _each(results: Generator[list[Result]]) -> Generator[Result]:
    with closing(results):
        for come in results:
            yield from come


def results_as_they_come(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    options: RunOptions,
    is_last: Callable[[Result | WorkerDiedError], bool] = lambda _: False,
    crew: Crew | None = None,
) -> Generator[list[Result | WorkerDiedError]]:
    """Yield lists of function(item), in the items' order: in each, all that have come since those before.

    Several processes or a cluster need a `function`, items and results that can be pickled. After a result that
    `is_last` no item is begun; those that others had begun by then still come. An item whose worker dies gives a
    WorkerDiedError as its value; an exception of the function is raised here. Where several processes do it, those of
    `crew`, if given, do, and stay for the next run.
    """
    if options.scheduler is not None and items:
        from motionedit.jobs.batch.cluster import load_dask, on_cluster

        load_dask()  # while Ctrl-C may still come at any place
        clean_up_first()
        return on_cluster(function, items, options.scheduler, is_last)
    clean_up_first()
    if len(items) > 1:
        _keep_memory()
    workers = workers_for(len(items), options)
    if workers > 1:
        from motionedit.jobs.batch.processes import in_processes

        return in_processes(function, items, workers, is_last, crew)
    return _one_by_one(function, items, is_last)


def workers_for(items: int, options: RunOptions) -> int:
    """Return how many processes of this machine work on so many items, 1 at the least."""
    return max(min(options.jobs or _cores(), items, _MOST_WORKERS), 1)


def standing_crew(
    options: RunOptions, *, name_of: Callable[[Any], Hashable] | None = None
) -> AbstractContextManager[Crew | None]:
    """Return the workers of several runs, one after the other, as a context; None where this process does the work.

    An item goes to the worker that had one of that name in the run before, where it has time for it.
    """
    if options.jobs == 1 or options.scheduler is not None:
        return nullcontext()
    from motionedit.jobs.batch.processes import Crew

    return Crew(name_of)


def threads_within(items: int, options: RunOptions) -> int:
    """Return the threads that the work on one item may use: all that --jobs gives where there is one item alone."""
    return (options.jobs or _cores()) if items == 1 and options.scheduler is None else 1


def _one_by_one(
    function: Callable[[Item], Result], items: Sequence[Item], is_last: Callable[[Result | WorkerDiedError], bool]
) -> Generator[list[Result | WorkerDiedError]]:
    for item in items:
        result = function(item)
        yield [result]
        if is_last(result):
            return


def _keep_memory() -> None:
    """Let memory serve clip after clip, in this process and in those that it forks."""
    from motionedit.core.compiled import compiled

    kernel = compiled()
    if kernel is not None:
        kernel.keep_memory(_LARGE)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
