"""Kinds of values that are mappings with a model of their own, or lists of values of one kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.model import Context, Kind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from motionedit.spec.model import SpecModel


def reference_to(model: type[SpecModel]) -> dict[str, str]:
    """Return the JSON Schema that stands for a model's."""
    return {"$ref": f"#/$defs/{model.__name__}"}


def mapping(model: type[SpecModel]) -> Kind:
    """Return the kind of mappings that a model describes."""
    return Kind(model.parse, model.wanted(), reference_to(model), models=(model,))


def list_of(kind: Kind) -> Kind:
    """Return the kind of lists, perhaps empty, of values of another kind."""

    def parse(value: object, context: Context) -> tuple[object, ...]:
        if not isinstance(value, list):
            raise faulty(f"must be a list, not {show(value)}")
        return tuple(_all_of(enumerate(value), kind, context).values())

    return Kind(parse, "a list, [] for an empty one", {"type": "array", "items": kind.json}, models=kind.models)


def by_name(kind: Kind) -> Kind:
    """Return the kind of mappings from any names to values of another kind."""

    def parse(value: object, context: Context) -> dict[Any, object]:
        if not isinstance(value, dict):
            raise faulty(f"must be a mapping, not {show(value)}")
        return _all_of(value.items(), kind, context)

    return Kind(parse, "a mapping", {"type": "object", "additionalProperties": kind.json}, models=kind.models)


def _all_of(items: Iterable[tuple[Any, object]], kind: Kind, context: Context) -> dict[Any, object]:
    """Return the values of items by their keys, or all of their faults."""
    found: dict[Any, object] = {}
    faults: list[Fault] = []
    for name, item in items:
        try:
            found[name] = kind.value_of(item, context)
        except FaultyValueError as error:
            faults += [fault.under(name) for fault in error.faults]
    if faults:
        raise FaultyValueError(faults)
    return found
