"""The JSON Schema (draft 2020-12) of a spec, which editors use to complete and check it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from motionedit.spec.scalars import AXES
from motionedit.spec.times import Duration
from motionedit.spec.values import Recruit, Unit

if TYPE_CHECKING:
    from motionedit.spec.document import Document

DRAFT = "https://json-schema.org/draft/2020-12/schema"

# Editors offer keys in this order.
_FIRST = ("schema", "name", "type", "effector", "joints", "at", "points")


class _SpecJsonSchema(GenerateJsonSchema):
    """Defaults that are values of our own are shown as one would write them."""

    def encode_default(self, dft: Any) -> Any:  # noqa: ANN401 (pydantic's signature)
        match dft:
            case Duration():
                return dft.text
            case BaseModel():
                # Its keys show their own defaults.
                return None
            case Unit() | Recruit():
                return dft.name if isinstance(dft, Unit) else dft.kind
            case _:
                return super().encode_default(dft)


def schema_of_model(model: type[Document], name: str) -> dict[str, Any]:
    """Return the JSON Schema of a spec's model; `name` is the text of its first line."""
    schema = model.model_json_schema(schema_generator=_SpecJsonSchema)
    _tidied(schema)
    schema["required"] = ["schema", *schema.get("required", [])]
    return {"$schema": DRAFT, **schema, "title": name}


def _tidied(schema: Any) -> None:  # noqa: ANN401 (any part of a JSON document)
    """Remove what pydantic adds and no editor needs, and show axes as one writes them."""
    if isinstance(schema, list):
        for item in schema:
            _tidied(item)
    if not isinstance(schema, dict):
        return
    # A word of OpenAPI, not of JSON Schema.
    schema.pop("discriminator", None)
    for key, value in schema.items():
        if key == "properties":
            for key_name, item in value.items():
                item.pop("title", None)
                # Such a default stands for an absent key, which the description explains.
                if item.get("default", ...) in (None, ""):
                    del item["default"]
                if key_name == "axes" and "default" in item:
                    item["default"] = [AXES[axis] for axis in item["default"]]
                if {"type": "null"} in item.get("anyOf", []):
                    item["anyOf"].remove({"type": "null"})
            first = [name for name in _FIRST if name in value]
            schema[key] = {name: value[name] for name in (*first, *(n for n in value if n not in first))}
        _tidied(value)
