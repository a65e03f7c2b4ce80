"""What is made again and again of the same things: keys that are one thing, results by their keys, or of one call."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

Value = TypeVar("Value")


class Same:
    """A key that is the thing itself, whatever else equals it: things that are large, or hold what has no hash."""

    def __init__(self, thing: object) -> None:
        self.thing = thing

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.thing is self.thing

    def __hash__(self) -> int:
        return id(self.thing)


class LastFew(Generic[Value]):
    """The last few results, by what they were made of: where `lru_cache` would keep more than the key alive."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._known: OrderedDict[Hashable, Value] = OrderedDict()

    def get(self, key: Hashable) -> Value | None:
        """Return what was kept by a key; None where nothing was."""
        return self._known.get(key)

    def keep(self, key: Hashable, value: Value) -> Value:
        """Keep a result, and let the oldest go; return it."""
        while len(self._known) >= self._most:
            self._known.popitem(last=False)
        self._known[key] = value
        return value


def once(make: Callable[[], Value]) -> Callable[[], Value]:
    """Return a function that makes something when it is first asked for it; `functools.cache` takes long to set up."""
    known: list[Value] = []

    def made() -> Value:
        if not known:
            known.append(make())
        return known[0]

    return made
