"""Which events a spec names in its times and rules, whether it lists them or not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass

from motionedit.spec.events import DetectRule
from motionedit.spec.model import SpecModel
from motionedit.spec.times import Time


def events_named(value: object) -> Iterator[str]:
    """Yield the events that the times below a value count from, and those that rules wait for."""
    if isinstance(value, Time) and value.event is not None:
        yield value.event
    if isinstance(value, DetectRule) and value.after is not None:
        yield value.after
    for part in _parts(value):
        yield from events_named(part)


def _parts(value: object) -> Iterable[object]:
    if isinstance(value, Mapping):
        return value.values()
    if isinstance(value, tuple):
        return value
    # Of a spec's model or one of its values; what is neither holds no time.
    return vars(value).values() if isinstance(value, SpecModel) or is_dataclass(value) else ()
