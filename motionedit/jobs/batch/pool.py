"""One function over many items, in this process, in several, or on a cluster; results always in the items' order."""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any, TypeVar

from motionedit.errors import UsageError
from motionedit.interrupts import clean_up_first
from motionedit.jobs.batch.worker_died import WorkerDiedError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from motionedit.jobs.batch.plan import RunOptions

Item = TypeVar("Item")
Result = TypeVar("Result")

# Windows cannot wait for more processes at once.
_MOST_WORKERS = 60
_SECONDS_TO_CONNECT = 10


def results_in_order(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    options: RunOptions,
    is_last: Callable[[Result | WorkerDiedError], bool] = lambda _: False,
) -> Generator[Result | WorkerDiedError]:
    """Yield function(item) for each item, in order.

    Several processes or a cluster need a `function`, items and results that can be pickled. After a result that
    `is_last` no item is begun; those that others had begun by then still come. An item whose worker dies gives a
    WorkerDiedError as its value; an exception of the function is raised here.
    """
    clean_up_first()
    workers = min(options.jobs or _cores(), len(items), _MOST_WORKERS)
    if options.scheduler is not None:
        return _on_cluster(function, items, options.scheduler, is_last)
    if workers > 1:
        from motionedit.jobs.batch.processes import in_processes

        return in_processes(function, items, workers, is_last)
    return _one_by_one(function, items, is_last)


def threads_within(items: int, options: RunOptions) -> int:
    """Return the threads that the work on one item may use: all that --jobs gives where there is one item alone."""
    return (options.jobs or _cores()) if items == 1 and options.scheduler is None else 1


def _one_by_one(
    function: Callable[[Item], Result], items: Sequence[Item], is_last: Callable[[Result | WorkerDiedError], bool]
) -> Generator[Result | WorkerDiedError]:
    for item in items:
        result = function(item)
        yield result
        if is_last(result):
            return


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _on_cluster(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    address: str,
    is_last: Callable[[Result | WorkerDiedError], bool],
) -> Generator[Result | WorkerDiedError]:
    try:
        # By name: checked with and without the extra, since only one of the two has types.
        dask: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise UsageError("--scheduler needs Dask: pip install 'motionedit[cluster]'") from error
    try:
        client = dask.Client(address, timeout=_SECONDS_TO_CONNECT)
    except (OSError, ValueError) as error:
        raise UsageError(f"--scheduler {address}: no Dask scheduler answers there") from error
    with client:
        for future in client.map(function, items, pure=False):
            try:
                result: Result | WorkerDiedError = future.result()
            except dask.KilledWorker:
                result = WorkerDiedError("its worker process was killed, perhaps for want of memory")
            yield result
            if is_last(result):
                return
