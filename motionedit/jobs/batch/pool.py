"""One function over many items, in this process, in several, or on a cluster; results always in the items' order."""

from __future__ import annotations

import importlib
import os
import sys
from collections import deque
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from motionedit.errors import MotionEditError, UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from concurrent.futures import Executor, Future

    from motionedit.jobs.batch.plan import RunOptions

Item = TypeVar("Item")
Result = TypeVar("Result")

# Windows cannot wait for more processes at once.
_MOST_WORKERS = 60
_SECONDS_TO_CONNECT = 10
# Windows answers Ctrl-C only between waits.
_SECONDS_WITHOUT_CTRL_C = 0.2
# Items that are given to each worker before their results are taken.
_AHEAD = 16


class WorkerDiedError(MotionEditError):
    """The process that worked on an item ended without an answer: killed, most often for want of memory."""


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
    workers = min(options.jobs or _cores(), len(items), _MOST_WORKERS)
    if options.scheduler is not None:
        return _on_cluster(function, items, options.scheduler, is_last)
    if workers > 1:
        return _in_processes(function, items, workers, is_last)
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


def _in_processes(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    workers: int,
    is_last: Callable[[Result | WorkerDiedError], bool],
) -> Generator[Result | WorkerDiedError]:
    # Imported here, and below: a run without workers starts in less time.
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    # Forked workers start in a millisecond with every module loaded; only Linux forks safely.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    others = set(multiprocessing.active_children())
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_start_worker)
    try:
        # Items are begun in their order, a few ahead of the results that are taken: the others' results would pile up.
        waiting = iter(items)
        futures = deque(_begun(executor, function, item) for item in islice(waiting, workers * _AHEAD))
        while futures:
            future = futures.popleft()
            # Those that never will be begun are the rest.
            if future.cancelled():
                break
            _wait_for(future)
            try:
                result: Result | WorkerDiedError = future.result()
            except BrokenProcessPool:
                result = WorkerDiedError("its worker process was killed, perhaps for want of memory; try fewer --jobs")
            yield result
            if is_last(result):
                waiting = iter(())
                for later in futures:
                    later.cancel()
            futures.extend(_begun(executor, function, item) for item in islice(waiting, 1))
    except BaseException:
        # Ctrl-C, an error, or nobody who listens any more: what is not done is not wanted.
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


def _begun(executor: Executor, function: Callable[[Item], Result], item: Item) -> Future[Result]:
    """Return the future of an item; one that has failed already where the workers are gone."""
    from concurrent.futures import BrokenExecutor, Future

    try:
        return executor.submit(function, item)
    except BrokenExecutor as error:
        future: Future[Result] = Future()
        future.set_exception(error)
        return future


def _wait_for(future: Future[Result]) -> None:
    from concurrent.futures import wait

    while not wait([future], timeout=_SECONDS_WITHOUT_CTRL_C).done:
        pass


def _start_worker() -> None:
    import signal
    import threading

    # Ctrl-C reaches every process of the terminal; the parent alone answers it, and ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this worker when its parent is killed: nobody would take its result."""
    import multiprocessing

    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


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
