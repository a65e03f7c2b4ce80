"""The JSON Schema (draft 2020-12) of a spec, which editors use to complete and check it."""

from __future__ import annotations

import inspect
from itertools import combinations
from typing import TYPE_CHECKING, Any

from motionedit.spec.scalars import AXES
from motionedit.spec.times import Duration
from motionedit.spec.values import Recruit, Unit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.spec.document import Document
    from motionedit.spec.model import SpecKey, SpecModel

DRAFT = "https://json-schema.org/draft/2020-12/schema"

# Editors offer keys in this order.
_FIRST = ("schema", "name", "type", "effector", "joints", "at", "points")


def schema_of_model(model: type[Document], name: str) -> dict[str, Any]:
    """Return the JSON Schema of a spec's model; `name` is the text of its first line."""
    models = {each.__name__: _schema(each) for each in _models_below(model)}
    schema = _schema(model)
    schema["required"] = ["schema", *schema.get("required", [])]
    return {"$schema": DRAFT, "$defs": {each: models[each] for each in sorted(models)}, **schema, "title": name}


def _models_below(model: type[SpecModel]) -> Iterator[type[SpecModel]]:
    """Yield the models that a model's keys refer to, and those that theirs do."""
    for key in _keys_of(model).values():
        for each in key.kind.models:
            yield each
            yield from _models_below(each)


def _keys_of(model: type[SpecModel]) -> dict[str, SpecKey]:
    """Return a model's keys by their names, in the order in which editors offer them."""
    keys = {key.name: key for key in model.model_keys.values() if key.name in model.key_names()}
    return {name: keys[name] for name in (*(n for n in _FIRST if n in keys), *(n for n in keys if n not in _FIRST))}


def _schema(model: type[SpecModel]) -> dict[str, Any]:
    keys = _keys_of(model)
    rules: list[dict[str, Any]] = [dict(rule) for rule in model.between_keys]
    for kind, groups in (("oneOf", model.exactly_one), ("anyOf", model.at_least_one)):
        rules += [{kind: [{"required": [key]} for key in group]} for group in groups]
    for group in model.at_most_one:
        rules += [{"not": {"required": list(pair)}} for pair in combinations(group, 2)]
    schema: dict[str, Any] = {
        "additionalProperties": False,
        "description": inspect.getdoc(model),
        "properties": {name: _property(key) for name, key in keys.items()},
        "title": model.__name__,
        "type": "object",
    }
    if rules:
        schema["allOf"] = rules
    if required := [name for name, key in keys.items() if key.is_required]:
        schema["required"] = required
    found: dict[str, Any] = _in_order(schema)
    return found


def _property(key: SpecKey) -> dict[str, Any]:
    schema = {**key.kind.json, "description": key.description, **key.more}
    default = _default(key)
    return schema if default is None else {**schema, "default": default}


def _default(key: SpecKey) -> object:
    """Return a key's default as one would write it; None where an absent key is told of by its description."""
    default = key.default
    match default:
        case Duration():
            return default.text
        case Unit() | Recruit():
            return default.name if isinstance(default, Unit) else default.kind
        case tuple():
            return [AXES[axis] for axis in default] if key.name == "axes" else list(default)
        case int() | float() | str() | dict():
            return default if default != "" else None
        case _:  # another model, whose keys have defaults of their own
            return None


def _in_order(schema: object, *, names: bool = False) -> Any:  # noqa: ANN401  any part of a JSON document
    """Return a schema with its words in alphabetical order, as readers look for them; `names` of keys stay."""
    if isinstance(schema, dict):
        words = schema if names else sorted(schema)
        return {word: _in_order(schema[word], names=word == "properties" and not names) for word in words}
    return [_in_order(each) for each in schema] if isinstance(schema, (list, tuple)) else schema
