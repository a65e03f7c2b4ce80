"""One function over many items in several processes, each with a pipe of its own.

Not the library's pools: these join a queue that all workers share, and wait for ever where a worker was ended in the
middle of a result. Here a worker's end closes its own pipe, and the parent ends workers without waiting for answers.
The function, with all that is common to the items, goes to each worker once. Workers that stay take another one.
Items go in messages: short ones several at a time, since to wake a process costs as much as a short clip's tenth.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections import deque
from itertools import islice, takewhile
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeVar

from motionedit.jobs.batch.no_result import Raised, WorkerDiedError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Hashable, Iterator, Sequence
    from multiprocessing.connection import Connection
    from multiprocessing.context import BaseContext
    from multiprocessing.process import BaseProcess

Item = TypeVar("Item")
Result = TypeVar("Result")

# Items that are begun, for each worker, before the results of those before are taken: results that wait take memory.
AHEAD = 64
# Messages that a worker has at once: the one it works on, and the next, so that it need not wait for its parent.
IN_HAND = 2
# Items of one message, at most. What workers have in hand is half of what may be begun: where one is late with its
# items, the others still get whole messages.
_AT_ONCE = AHEAD // (2 * IN_HAND)
# Of one message, at most: that both sides of a pipe write at once, and neither reads, must not be. And its items take
# about so long.
_MOST_BYTES = 1 << 15
_SECONDS_A_MESSAGE = 0.04
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
) -> Generator[list[Result | WorkerDiedError]]:
    """Yield what function(item) is for each item; see `results_as_they_come`. A crew that is given goes on after it."""
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
            come: list[Result | WorkerDiedError] = []
            while taken in results and not isinstance(results[taken], Raised):
                come.append(results.pop(taken))
                taken += 1
            if not come:
                raise results[taken].error
            yield come
            if any(map(is_last, come)):
                waiting.clear()
    finally:
        # At the end they are idle; after Ctrl-C or an error, or where nobody listens, what they do is not wanted.
        if crew.is_busy or not stays:
            crew.end()


class _Turn(NamedTuple):
    """What a worker is sent that is no item: what it does from now on."""

    function: Callable[[Any], Any]


class _Answer(NamedTuple):
    """The results of one message, and how long they took."""

    results: list[Any]
    seconds: float


class _Worker:
    """A process, its pipe, and the places of the items of each message that it has, the one it works on first."""

    def __init__(self, context: BaseContext, function: Callable[[Any], Any] | None) -> None:
        self.pipe, other = context.Pipe()
        self.in_hand: deque[list[int]] = deque()
        self.process: BaseProcess = context.Process(target=_work, args=(function, other), daemon=True)  # type: ignore[attr-defined]
        with _interrupts_held_back():
            self.process.start()
        other.close()

    def end(self) -> None:
        self.pipe.close()
        self.process.kill()


class Crew:
    """The workers of a run, or of several, one after the other; one that dies is replaced where there is more to do.

    A worker that had an item of some name in an earlier run gets that of the same name, if it has time for it.
    """

    def __init__(self, name_of: Callable[[Any], Hashable] | None = None) -> None:
        # Forked workers start in a millisecond with every module loaded; only Linux forks safely.
        self._context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
        self._function: Callable[[Any], Any] | None = None
        self._count = 0
        self._workers: list[_Worker] = []
        self._name_of = name_of
        self._homes: dict[Hashable, _Worker] = {}
        # Items of a message: as many as are worked on in its time, as fit into it, and whether it is one in any case.
        self._at_once, self._fit = 1, 1
        self._one_by_one = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def turn_to(self, function: Callable[[Any], Any], count: int) -> None:
        """Take a function for so many workers; those that are there get it, a new one is born with it."""
        self._function, self._count, self._at_once, self._one_by_one = function, count, 1, False
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
            # Fewer towards the end, so that all end together.
            most = max(1, min(self._at_once, self._fit, len(waiting) // (IN_HAND * self._count)))
            places = self._take(worker, items, waiting, most=most, before=before)
            worker.in_hand.append(places)
            message = _packed([items[place] for place in places])
            self._fit = _MOST_BYTES * len(places) // len(message)
            # A worker that is gone is seen where its results are awaited.
            with contextlib.suppress(BrokenPipeError, ConnectionError):
                worker.pipe.send_bytes(message)

    def _take(self, worker: _Worker, items: Sequence[Any], waiting: deque[int], *, most: int, before: int) -> list[int]:
        """Take from the places that wait those of a worker's next items: of such as it had before, else the first."""
        places = list(takewhile(before.__gt__, waiting))
        name_of, homes = self._name_of, self._homes
        if name_of is not None:
            own = (place for place in places if homes.get(name_of(items[place])) is worker)
            places = [*islice(own, most)] or places[:most]
            homes.update((name_of(items[place]), worker) for place in places)
        places = places[:most]
        for place in places:
            waiting.remove(place)
        return places

    def collect(self, results: dict[int, Any], waiting: deque[int]) -> None:
        """Wait a moment for results; of a worker that died its item is lost, and what it had not begun waits again."""
        ready = wait([worker.pipe for worker in self._workers], timeout=SECONDS_WITHOUT_CTRL_C)
        for worker in [worker for worker in self._workers if worker.pipe in ready]:
            try:
                answer: _Answer = worker.pipe.recv()
            except (EOFError, OSError):
                self._workers.remove(worker)
                worker.end()
                self._take_back(worker.in_hand, results, waiting)
            else:
                places = worker.in_hand.popleft()
                results.update(zip(places, answer.results, strict=True))
                each = answer.seconds / len(places)
                self._at_once = 1 if self._one_by_one else int(min(_AT_ONCE, max(1.0, _SECONDS_A_MESSAGE / each)))

    def _take_back(self, in_hand: deque[list[int]], results: dict[int, Any], waiting: deque[int]) -> None:
        """Let the items of a worker that died wait again, but the one that it died of.

        Which of several that is nobody knows: from then on they go one by one.
        """
        if in_hand and len(in_hand[0]) == 1:
            results[in_hand.popleft()[0]] = WorkerDiedError(_DIED)
        elif in_hand:
            self._at_once, self._one_by_one = 1, True
        again = sorted([*waiting, *(place for places in in_hand for place in places)])
        waiting.clear()
        waiting.extend(again)

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
            message = pipe.recv()
        except (EOFError, OSError):
            return
        if isinstance(message, _Turn):
            function = message.function
            continue
        start = time.perf_counter()
        results = [_result_of(function, one) for one in message]
        pipe.send_bytes(_packed(_Answer(results, time.perf_counter() - start)))


def _packed(message: object) -> bytes:
    """Return a message for `recv`: a pipe's own `send` takes longer, since it takes open files and sockets, too."""
    return pickle.dumps(message, pickle.HIGHEST_PROTOCOL)


def _result_of(function: Callable[[Any], Any], item: Any) -> Any:  # noqa: ANN401  any function of in_processes
    try:
        return function(item)
    except Exception as error:  # noqa: BLE001  it is raised where the results are taken
        return Raised(error)


def _end_with_parent() -> None:
    """End this worker when its parent is killed: nobody would take its result."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
