"""Frozen dataclasses that are made when they are first used.

The library writes and compiles the methods of every class as it is defined, five of them for a frozen one. For the 150
classes of a short edit that takes a sixth of its time, though most of them are never asked for anything in it. Here a
frozen class gets its fields and its own `__init__` from the library when one of them is first asked for, and shares the
other methods with all. `make bench` measures what that saves.
"""

from __future__ import annotations

import dataclasses
from _thread import RLock
from functools import cache
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from dataclasses import dataclass, replace
else:

    def replace(thing: Any, /, **changes: object) -> Any:  # noqa: ANN401
        """Return a copy with some fields changed, as `dataclasses.replace`: of those made here, which is quicker.

        What was cached of the thing is not taken along. Which names are fields, the type checker sees.
        """
        cls = type(thing)
        new, own = object.__new__(cls), thing.__dict__
        fields = new.__dict__
        for name in _names(cls):
            fields[name] = own[name]
        fields.update(changes)
        return new

    def dataclass(cls: type | None = None, /, *, frozen: bool = False, eq: bool = True, kw_only: bool = False) -> Any:  # noqa: ANN401
        """Return the class as `dataclasses.dataclass` makes it."""

        def made(cls: type) -> type:
            if not frozen:
                return dataclasses.dataclass(cls, eq=eq, kw_only=kw_only)
            # Otherwise the library makes one, of the `__init__` that is not there yet.
            cls.__doc__ = cls.__doc__ or cls.__name__
            cls.__init__ = _Later("__init__", cls, kw_only=kw_only)
            cls.__dataclass_fields__ = _Later("__dataclass_fields__", cls, kw_only=kw_only)
            cls.__setattr__, cls.__delattr__ = _set_once, _refuse
            if "__repr__" not in vars(cls):
                cls.__repr__ = _shown
            if eq:
                cls.__eq__, cls.__hash__ = _equals, _hashed
                cls.__getstate__ = _sent
            return cls

        return made if cls is None else made(cls)


# A class that two threads ask for at once is made once.
_MAKING = RLock()


class _Later:
    """Stands for a class's `__init__` or fields until one of them is asked for: then the class gets both."""

    def __init__(self, name: str, cls: type, *, kw_only: bool) -> None:
        self._name = name
        self._cls = cls
        self._kw_only = kw_only

    def __get__(self, instance: object, owner: type) -> Any:  # noqa: ANN401  a method, or the fields
        cls = self._cls
        with _MAKING:
            if vars(cls)[self._name] is self:
                dataclasses.dataclass(cls, init=False, eq=False, repr=False, kw_only=self._kw_only)
                cls.__init__ = _init_of(cls)  # type: ignore[misc]
        found = vars(cls)[self._name]
        return found.__get__(instance, owner) if self._name == "__init__" else found


def _init_of(cls: type) -> Any:  # noqa: ANN401  a function
    """Return a class's `__init__`, which puts the values where they are kept: to set each takes five times as long.

    Of what dataclasses have, these use defaults, factories of them, and keywords alone.
    """
    given: dict[str, Any] = {"absent": dataclasses.MISSING}
    plain, keywords, body = ["self"], ["*"], ["own = self.__dict__"]
    for each in dataclasses.fields(cls):
        name, value = each.name, each.name
        if each.default is not dataclasses.MISSING:
            given[f"default_{name}"] = each.default
            parameter = f"{name}=default_{name}"
        elif each.default_factory is not dataclasses.MISSING:
            given[f"make_{name}"] = each.default_factory
            parameter, value = f"{name}=absent", f"make_{name}() if {name} is absent else {name}"
        else:
            parameter = name
        (keywords if each.kw_only else plain).append(parameter)
        body.append(f"own[{name!r}] = {value}")
    parameters = ", ".join(plain + (keywords if len(keywords) > 1 else []))
    made: dict[str, Any] = {}
    exec("def __init__(" + parameters + "):\n " + "\n ".join(body), given, made)  # noqa: S102
    init = made["__init__"]
    init.__qualname__ = f"{cls.__qualname__}.__init__"
    init.__annotations__ = {each.name: each.type for each in dataclasses.fields(cls)} | {"return": None}
    return init


def _set_once(self: Any, name: str, value: object) -> None:  # noqa: ANN401  any of the classes
    known = self.__dict__
    if name in known or name not in self.__dataclass_fields__:
        _refuse(self, name)
    known[name] = value


def _refuse(_self: object, name: str) -> NoReturn:
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


def _shown(self: Any) -> str:  # noqa: ANN401
    values = ", ".join(f"{each.name}={getattr(self, each.name)!r}" for each in dataclasses.fields(self))
    return f"{type(self).__qualname__}({values})"


@cache
def _names(cls: type) -> tuple[str, ...]:
    return tuple(each.name for each in dataclasses.fields(cls))


def _compared(self: Any) -> tuple[object, ...]:  # noqa: ANN401
    return tuple(map(self.__dict__.__getitem__, _names_compared(type(self))))  # type: ignore[arg-type]


@cache
def _names_compared(cls: type) -> tuple[str, ...]:
    return tuple(each.name for each in dataclasses.fields(cls) if each.compare)


def _equals(self: object, other: object) -> bool:
    return _compared(self) == _compared(other) if other.__class__ is self.__class__ else NotImplemented


def _hashed(self: object) -> int:
    # What is made of a body is looked up by its anatomy again and again, and to hash that takes as long as to look it
    # up a hundred times.
    known = self.__dict__
    found: int | None = known.get(_HASH)
    if found is None:
        found = known[_HASH] = hash(_compared(self))
    return found


def _sent(self: object) -> dict[str, Any]:
    # In another process texts have other hashes.
    own = self.__dict__
    return {name: value for name, value in own.items() if name != _HASH} if _HASH in own else own


_HASH = " hash"

__all__ = ["dataclass", "replace"]
