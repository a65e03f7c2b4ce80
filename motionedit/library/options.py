"""Numbers, switches and events as the functions of the face take them."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from typing import SupportsIndex

from motionedit.errors import SpecError, UsageError
from motionedit.jobs.batch.plan import RunOptions
from motionedit.spec.faults import did_you_mean, listed, show

# Any whole number: numpy's, too.
Events = Mapping[str, SupportsIndex]


def options_of(*, lenient: bool = False, **workers: SupportsIndex) -> RunOptions:
    """Return how a run goes about its clips: all or none, and what is no user's error is raised as it is.

    Parameters
    ----------
    workers : int
        `jobs` or `threads`, as the function that was called names them.

    Raises
    ------
    UsageError
        One is no such number, or `lenient` is no switch.
    """
    counts = [count_of(number, name) for name, number in workers.items()]
    return RunOptions(
        jobs=counts[0] if counts else 1, lenient=switch(lenient, "lenient"), keep_going=False, verbosity=2
    )


def count_of(number: SupportsIndex, name: str) -> int:
    """Return a number of workers."""
    count = None
    if isinstance(number, SupportsIndex) and not isinstance(number, bool):
        try:
            count = operator.index(number)
        except TypeError:  # an array of several numbers
            count = None
    if count is None or count < 0:
        raise UsageError(f"{name} must be a whole number, 1 or more, or 0 for all cores; not {_shown(number)}")
    return count


def switch(value: bool, name: str) -> bool:  # noqa: FBT001  it is what is asked about
    """Return a switch that is one, numpy's or Python's."""
    if type(value).__name__ not in ("bool", "bool_"):
        raise UsageError(f"{name} must be True or False, not {_shown(value)}")
    return bool(value)


def events_of(events: Events | None) -> Events:
    """Return frames of events as `load_spec` takes them.

    Raises
    ------
    UsageError
        They are no mapping of names.
    """
    if events is None:
        return {}
    if not isinstance(events, Mapping) or not all(isinstance(name, str) for name in events):
        raise UsageError("events must be a mapping of names to frames, such as {'hit': 94}")
    return events


def refuse_unknown_events(events: Events | None, known: frozenset[str], *, where: str) -> None:
    """Raise a SpecError where an event is given that nothing asks for: a slip would change nothing, silently."""
    names = sorted(known)
    for name in events or ():
        if name not in known:
            there = f"there are: {listed(names)}" if names else "there are none"
            message = f"no such event in {where}; {did_you_mean(name, names, otherwise=there)}"
            raise SpecError(message, file=f"events.{show(name)[1:-1]}")


def _shown(value: object) -> str:
    shown = show(value) if isinstance(value, (bool, int, float, str)) or value is None else None
    return repr(value) if isinstance(value, bool) or value is None else shown or f"a {type(value).__name__}"
