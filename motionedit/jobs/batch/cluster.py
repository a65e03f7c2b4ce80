"""One function over many items on a Dask cluster, which may have no workers, lose them, or have unfit ones.

The scheduler need not have motionedit: it is given bytes, and functions of the standard library. The function, with all
that is common to the items, goes to it once, and from there once to each worker.
"""

from __future__ import annotations

import asyncio
import importlib
import io
import logging
import operator
import pickle
import time
import warnings
from collections import deque
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from motionedit.core.compiled import solver_name
from motionedit.dataclass import dataclass
from motionedit.errors import MotionEditError, UsageError
from motionedit.jobs.batch.no_result import ClusterLostError, Raised, WorkerDiedError
from motionedit.jobs.batch.processes import AHEAD, IN_HAND
from motionedit.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence

Item = TypeVar("Item")
Result = TypeVar("Result")

# To answer, and to have a worker, at the beginning or again after the last is gone: together less than half a minute.
SECONDS_TO_CONNECT = 10.0
SECONDS_WITHOUT_WORKERS = 15.0
_SECONDS_BETWEEN_LOOKS = 0.5


def load_dask() -> Any:  # noqa: ANN401  by name: checked with and without the extra, of which only one has types
    """Return Dask's module.

    Raises
    ------
    UsageError
        It is not installed.
    """
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise UsageError("--scheduler needs Dask: pip install 'motionedit[cluster]'") from error


def on_cluster(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    address: str,
    is_last: Callable[[Result | WorkerDiedError], bool],
) -> Generator[list[Result | WorkerDiedError]]:
    """Yield what function(item) is for each item, one by one; see `results_as_they_come`.

    Raises
    ------
    UsageError
        No scheduler answers at the address.
    MotionEditError
        It has no workers, or one that is not fit for the work; nothing was begun.
    """
    with _client(address) as client:
        cluster = _Cluster(client, address, function)
        cluster.refuse_unfit()
        waiting = deque(range(len(items)))
        taken = 0
        while taken < len(items):
            cluster.begin(items, waiting, taken)
            if taken in cluster.results:
                value = cluster.results.pop(taken)
                taken += 1
                if isinstance(value, Raised):
                    raise value.error
                yield [value]
                if is_last(value):
                    waiting.clear()
            elif cluster.is_busy:
                cluster.collect()
            else:  # it came after the last one that was wanted
                return


class _Cluster:
    """A cluster, the items that it works on, and the `results` that have come, by the items' places."""

    def __init__(self, client: Any, address: str, function: Callable[[Any], Any]) -> None:  # noqa: ANN401  as above
        self._client = client
        self._address = address
        self._name = f"--scheduler {address}"
        self._threads = 0
        self._seen = self._looked = time.monotonic()
        self._lost = False
        self._seconds_for_a_result = SECONDS_WITHOUT_WORKERS
        self._in_hand: dict[Any, int] = {}
        self.results: dict[int, Any] = {}
        # Not sent to all from here: what was, is lost with the workers that have it; this is made again.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that it is large
            self._work = client.submit(pickle.loads, packed(_Work(function)), pure=False)

    @property
    def is_busy(self) -> bool:
        """Whether a result is still to come."""
        return bool(self._in_hand)

    def refuse_unfit(self) -> None:
        """Raise a MotionEditError where there are no workers, or one would work otherwise than this process, or not."""
        self._look()
        while not self._threads:
            if self._lost:
                raise MotionEditError(f"{self._name}: there are no workers; start some: dask worker {self._address}")
            time.sleep(_SECONDS_BETWEEN_LOOKS)
            self._look()
        mine = whoami()
        for worker, its in sorted(self._client.run(whoami, on_error="return").items()):
            what = f"cannot load motionedit: {its}" if isinstance(its, Exception) else f"has {its}"
            if its != mine:
                raise MotionEditError(f"{self._name}: worker {worker} {what}; here is {mine}: install the same there")

    def begin(self, items: Sequence[Any], waiting: deque[int], taken: int) -> None:
        """Give the cluster as many items as it can work on; where it is lost, they are lost, one by one."""
        if self._lost and not self._in_hand and waiting:
            self.results[waiting.popleft()] = self._loss()
        while waiting and waiting[0] < taken + AHEAD * self._threads and len(self._in_hand) < IN_HAND * self._threads:
            place = waiting.popleft()
            # What is waited for first is done first: otherwise workers take them in any order.
            future = self._client.submit(operator.call, self._work, packed(items[place]), pure=False, priority=-place)
            self._in_hand[future] = place

    def collect(self) -> None:
        """Wait a moment for results."""
        dask = load_dask()
        with suppress(TimeoutError, dask.CancelledError):
            dask.wait(list(self._in_hand), timeout=_SECONDS_BETWEEN_LOOKS, return_when="FIRST_COMPLETED")
        for future in [future for future in self._in_hand if future.done()]:
            # Where its worker died since, it is made again.
            with suppress(TimeoutError):
                self.results[self._in_hand[future]] = self._value(future)
                del self._in_hand[future]
        if time.monotonic() > self._looked + _SECONDS_BETWEEN_LOOKS:
            self._look()
            if self._lost:
                self.results |= dict.fromkeys(self._in_hand.values(), self._loss())
                self._in_hand.clear()

    def _value(self, future: Any) -> Any:  # noqa: ANN401  what the function returned
        dask = load_dask()
        try:
            return future.result(timeout=self._seconds_for_a_result)
        except TimeoutError:
            self._seconds_for_a_result *= 2.0  # a large one takes its time, and would begin anew each time
            raise
        except dask.CancelledError:
            return self._loss()
        except dask.KilledWorker:
            return WorkerDiedError("its worker process was killed, perhaps for want of memory")
        except Exception as error:  # noqa: BLE001  none of the function's own, which come as values
            return WorkerDiedError(f"its worker could not work on it: {type(error).__name__}: {error}")

    def _loss(self) -> ClusterLostError:
        return ClusterLostError(f"{self._name}: no worker is left; start some, and go on with --update")

    def _look(self) -> None:
        """See how many threads the cluster has; after a time without any it is lost."""
        try:
            self._threads = sum(self._client.nthreads().values())
        except OSError:
            self._threads = 0
        self._looked = time.monotonic()
        if self._threads:
            self._seen = self._looked
        elif self._looked > self._seen + SECONDS_WITHOUT_WORKERS:
            self._lost = True


@dataclass(frozen=True)
class _Work:
    """The function as a worker has it, which takes packed items."""

    function: Callable[[Any], Any]

    def __call__(self, item: bytes) -> Any:  # noqa: ANN401  what the function returns
        try:
            return self.function(pickle.loads(item))  # noqa: S301  packed by our own process
        except Exception as error:  # noqa: BLE001  it is raised where the results are taken
            return Raised(error)


class _Packing(pickle.Pickler):
    """Makes paths whole, since a worker has a working folder of its own."""

    def reducer_override(self, obj: object) -> Any:  # noqa: ANN401  as pickle's own
        if isinstance(obj, Path) and not obj.is_absolute():
            return type(obj), (str(obj.absolute()),)
        return NotImplemented


def packed(value: object) -> bytes:
    """Return what a worker anywhere unpickles."""
    stream = io.BytesIO()
    _Packing(stream, protocol=pickle.HIGHEST_PROTOCOL).dump(value)
    return stream.getvalue()


def whoami() -> str:
    """Return what this process works with, as far as results depend on it."""
    return f"motionedit {__version__} ({solver_name()} solver)"


@contextmanager
def _client(address: str) -> Iterator[Any]:
    """Connect to a scheduler; what Dask logs is not shown: what a user has to know is said."""
    dask = load_dask()
    before = logging.root.manager.disable
    logging.disable()
    try:
        try:
            # Asked first: a client that gets no answer, or a strange one, complains once more as it goes.
            asyncio.run(asyncio.wait_for(_refuse_others(dask, address), SECONDS_TO_CONNECT))
            client = dask.Client(address, timeout=SECONDS_TO_CONNECT)
        except Exception as error:
            raise UsageError(f"--scheduler {address}: no Dask scheduler answers there") from error
        with client:
            yield client
    finally:
        logging.disable(before)


async def _refuse_others(dask: Any, address: str) -> None:  # noqa: ANN401  as above
    """Raise an exception where something else than a scheduler answers."""
    secrets = dask.Security().get_connection_args("client")
    async with dask.rpc(address, timeout=SECONDS_TO_CONNECT, connection_args=secrets) as server:
        kind = (await server.identity())["type"]
    if kind != "Scheduler":
        raise ValueError(kind)
