"""One function over many items in several processes, each with a pipe of its own.

Not the library's pools: these join a queue that all workers share, and wait for ever where a worker was ended in the
middle of a result. Here a worker's end closes its own pipe, and the parent ends workers without waiting for answers.
The function, with all that is common to the items, goes to each worker once. Workers that stay take another one.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeVar

from motionedit.jobs.batch.no_result import Raised, WorkerDiedError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.context import BaseContext
    from multiprocessing.process import BaseProcess

Item = TypeVar("Item")
Result = TypeVar("Result")

# Items that are begun, for each worker, before the results of those before are taken: results that wait take memory.
AHEAD = 16
# Items that a worker has at once: the one it works on, and the next, so that it need not wait for its parent.
IN_HAND = 2
# Windows answers Ctrl-C only between waits.
SECONDS_WITHOUT_CTRL_C = 0.2
_SECONDS_TO_END = 5.0
_DIED = "its worker process was killed, perhaps for want of memory; try fewer --jobs"


def in_processes(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    workers: int,
    is_last: Callable[[Result | WorkerDiedError], bool],
    crew: Crew | None = None,
) -> Generator[Result | WorkerDiedError]:
    """Yield function(item) for each item, in order; see `results_in_order`. A crew that is given goes on after it."""
    stays = crew is not None
    crew = crew or Crew()
    crew.turn_to(function, workers)
    results: dict[int, Any] = {}
    waiting = deque(range(len(items)))
    taken = 0
    try:
        while taken < len(items):
            crew.begin(items, waiting, before=taken + workers * AHEAD)
            while taken not in results and crew.is_busy:
                crew.collect(results, waiting)
                crew.begin(items, waiting, before=taken + workers * AHEAD)
            if taken not in results:  # it came after the last one that was wanted
                break
            value = results.pop(taken)
            taken += 1
            if isinstance(value, Raised):
                raise value.error
            yield value
            if is_last(value):
                waiting.clear()
    finally:
        # At the end they are idle; after Ctrl-C or an error, or where nobody listens, what they do is not wanted.
        if crew.is_busy or not stays:
            crew.end()


class _Turn(NamedTuple):
    """What a worker is sent that is no item: what it does from now on."""

    function: Callable[[Any], Any]


class _Worker:
    """A process, its pipe, and the places of the items that it has, the one it works on first."""

    def __init__(self, context: BaseContext, function: Callable[[Any], Any] | None) -> None:
        self.pipe, other = context.Pipe()
        self.in_hand: deque[int] = deque()
        self.process: BaseProcess = context.Process(target=_work, args=(function, other), daemon=True)  # type: ignore[attr-defined]
        with _interrupts_held_back():
            self.process.start()
        other.close()

    def end(self) -> None:
        self.pipe.close()
        self.process.kill()


class Crew:
    """The workers of a run, or of several, one after the other; one that dies is replaced where there is more to do."""

    def __init__(self) -> None:
        # Forked workers start in a millisecond with every module loaded; only Linux forks safely.
        self._context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
        self._function: Callable[[Any], Any] | None = None
        self._count = 0
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def turn_to(self, function: Callable[[Any], Any], count: int) -> None:
        """Take a function for so many workers; those that are there get it, a new one is born with it."""
        self._function, self._count = function, count
        for worker in self._workers:
            # As in `begin`.
            with contextlib.suppress(BrokenPipeError, ConnectionError):
                worker.pipe.send(_Turn(function))

    @property
    def is_busy(self) -> bool:
        """Whether a result is still to come."""
        return any(worker.in_hand for worker in self._workers)

    def begin(self, items: Sequence[Any], waiting: deque[int], *, before: int) -> None:
        """Give items to workers that have too few, those before one place alone, in order."""
        while waiting and waiting[0] < before:
            if len(self._workers) < self._count:
                self._workers.append(_Worker(self._context, self._function))
            worker = min(self._workers, key=lambda one: len(one.in_hand))
            if len(worker.in_hand) >= IN_HAND:
                return
            place = waiting.popleft()
            worker.in_hand.append(place)
            # A worker that is gone is seen where its result is awaited.
            with contextlib.suppress(BrokenPipeError, ConnectionError):
                worker.pipe.send(items[place])

    def collect(self, results: dict[int, Any], waiting: deque[int]) -> None:
        """Wait a moment for results; of a worker that died its item is lost, and what it had not begun waits again."""
        ready = wait([worker.pipe for worker in self._workers], timeout=SECONDS_WITHOUT_CTRL_C)
        for worker in [worker for worker in self._workers if worker.pipe in ready]:
            try:
                results[worker.in_hand[0]] = worker.pipe.recv()
                worker.in_hand.popleft()
            except (EOFError, OSError):
                self._workers.remove(worker)
                worker.end()
                if worker.in_hand:
                    results[worker.in_hand.popleft()] = WorkerDiedError(_DIED)
                waiting.extendleft(reversed(worker.in_hand))

    def end(self) -> None:
        """End all workers, whatever they are at."""
        for worker in self._workers:
            worker.end()
        for worker in self._workers:
            worker.process.join(_SECONDS_TO_END)
        self._workers = []


@contextlib.contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Let Ctrl-C wait while a worker is made, which would answer it with a traceback; Windows sends it otherwise."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(function: Callable[[Any], Any], pipe: Connection[Any, Any]) -> None:
    """Answer each item with its result, as a worker does, until there are no more."""
    # Ctrl-C reaches every process of the terminal; the parent alone answers it, and ends its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            item = pipe.recv()
        except (EOFError, OSError):
            return
        if isinstance(item, _Turn):
            function = item.function
            continue
        try:
            result: Any = function(item)
        except Exception as error:  # noqa: BLE001  it is raised where the results are taken
            result = Raised(error)
        pipe.send(result)


def _end_with_parent() -> None:
    """End this worker when its parent is killed: nobody would take its result."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
