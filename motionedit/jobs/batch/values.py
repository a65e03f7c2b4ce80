"""One function over many items: its values in order, and in place of a value the error that an item gave."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Any, TypeVar

from motionedit.dataclass import dataclass
from motionedit.errors import ClipError, MotionEditError
from motionedit.jobs.batch.pool import results_in_order

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from motionedit.jobs.batch.plan import RunOptions
    from motionedit.jobs.batch.processes import Crew

Item = TypeVar("Item")
Value = TypeVar("Value")


def map_tasks(
    function: Callable[[Item], Value], items: Sequence[Item], options: RunOptions, *, crew: Crew | None = None
) -> list[Value | MotionEditError]:
    """Return function(item) for each item in order, on the workers that `options` asks for.

    A MotionEditError, of one fault or several, or OSError of an item comes back as its value; every item is tried.
    `function`, items and values are pickled where there are several workers, those of `crew` if it is given.
    """
    return list(values_in_order(function, items, options, crew=crew))


def values_in_order(
    function: Callable[[Item], Value], items: Sequence[Item], options: RunOptions, *, crew: Crew | None = None
) -> Generator[Value | MotionEditError]:
    """Yield what `map_tasks` returns, one by one: of many large values few are held at a time."""
    from motionedit.core import bvh as _bvh  # noqa: F401  loaded once here, not in every forked worker

    results = results_in_order(_Guarded(function), items, options=options, crew=crew)
    with closing(results), options.progress(len(items)) as advance:
        for value in results:
            yield value
            advance()


@dataclass(frozen=True)
class _Guarded:
    """A function whose errors are values, as a worker runs it."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> Any:  # noqa: ANN401  any function of map_tasks
        try:
            return self.function(item)
        except MotionEditError as error:
            return error
        except OSError as error:
            return ClipError(error.strerror or str(error), file=error.filename and str(error.filename))
