"""What all spec models share: kinds of values with their JSON Schema, and all faults of a mapping reported at once."""

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from motionedit.dataclass import dataclass
from motionedit.spec.faults import Fault, FaultyValueError, Keys, faulty, nearest, show
from motionedit.spec.values import unknown_key

# Named in the contract for later work, so that nobody takes the names for something else.
LATER_KEYS = frozenset({"above", "feet", "joint_map", "limits", "outside", "scale"})


@dataclass(frozen=True)
class Context:
    """What a value may need beside itself.

    `folder` is what paths are relative to and `label` the folder as messages name it. `events` are the names that
    times may use, None where any name may be meant.
    """

    folder: Path | None = None
    label: str = ""
    events: frozenset[str] | None = None


NO_CONTEXT = Context()


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of value: `parse` makes it from a plain value, `wanted` names it, `json` is its JSON Schema.

    It stands in ``Annotated[type, kind]``. An empty value is refused unless `null`.
    """

    parse: Callable[[Any, Context], object]
    wanted: str
    json: Mapping[str, Any]
    null: bool = False

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validated)

    def __get_pydantic_json_schema__(self, _schema: CoreSchema, _handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return dict(self.json)

    def _validated(self, value: object, info: ValidationInfo) -> object:
        if value is None:
            if self.null:
                return None
            raise faulty(f"needs a value: {self.wanted}")
        return self.parse(value, info.context or NO_CONTEXT)


class SpecModel(BaseModel):
    """A mapping of a spec: frozen, without unknown keys, and with all of its faults in one error."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    # Groups of keys of which exactly, at most or at least one is given.
    exactly_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_most_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_least_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    # What `faults_between_keys` refuses, as far as JSON Schema can say it, for editors.
    between_keys: ClassVar[tuple[Mapping[str, Any], ...]] = ()
    # What stands at a key that is unknown here but not elsewhere: "belongs to ...".
    foreign_keys: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys of plain `data`, whose values may be anything."""
        del data
        yield from ()

    @classmethod
    def key_names(cls) -> tuple[str, ...]:
        """Return the keys of the mapping, as YAML has them."""
        return tuple(info.alias or name for name, info in cls.model_fields.items())

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        json = handler.resolve_ref_schema(handler(schema))
        json["properties"] = {key: value for key, value in json["properties"].items() if key in cls.key_names()}
        rules: list[dict[str, Any]] = [dict(rule) for rule in cls.between_keys]
        for kind, groups in (("oneOf", cls.exactly_one), ("anyOf", cls.at_least_one)):
            rules += [{kind: [{"required": [key]} for key in group]} for group in groups]
        for group in cls.at_most_one:
            rules += [{"not": {"required": list(pair)}} for pair in combinations(group, 2)]
        if rules:
            json["allOf"] = rules
        return json

    @model_validator(mode="wrap")
    @classmethod
    def _with_all_faults(cls, data: object, handler: ModelWrapValidatorHandler[Self], _info: ValidationInfo) -> Self:
        if not isinstance(data, dict):
            if isinstance(data, cls):
                return data
            wanted = f"a mapping with the keys {', '.join(cls.key_names())}"
            raise faulty(f"needs a value: {wanted}" if data is None else f"must be {wanted}; not {show(data)}")
        faults = list(cls._unknown_keys(data))
        meant = cls._as_meant(data) if faults else data
        faults += [*cls._missing_keys(meant), *cls._faults_in_groups(meant), *cls.faults_between_keys(meant)]
        try:
            model = handler(data)
        except ValidationError as error:
            faults += faults_of(error, data)
        if faults:
            raise FaultyValueError(faults)
        return model

    @classmethod
    def _unknown_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        names = cls.key_names()
        for key in data:
            if key in names:
                continue
            if key in cls.foreign_keys:
                yield Fault(cls.foreign_keys[key], (key,))
            elif key in LATER_KEYS:
                yield Fault("not supported yet", (key,))
            else:
                yield Fault(unknown_key(key, names), (key,))

    @classmethod
    def _as_meant(cls, data: Mapping[str, Any]) -> dict[str, Any]:
        """Return the data with misspelt keys put right, so that one slip is not reported as a missing key too."""
        names = cls.key_names()
        return {(key if key in names else nearest(key, names) or key): value for key, value in data.items()}

    @classmethod
    def _faults_in_groups(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        for group in (*cls.exactly_one, *cls.at_least_one):
            if not any(key in data for key in group):
                yield Fault(f"needs one of {', '.join(group)}")
        for group in (*cls.exactly_one, *cls.at_most_one):
            given = [key for key in data if key in group]
            for key in given[1:]:
                yield Fault(f"stands beside {given[0]}; give one of {', '.join(group)}", (key,))

    @classmethod
    def _missing_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        for name, info in cls.model_fields.items():
            key = info.alias or name
            if info.is_required() and key not in data:
                kinds = [kind for kind in info.metadata if isinstance(kind, Kind)]
                yield Fault(f"is missing; it is {kinds[0].wanted}" if kinds else "is missing", (key,))


def faults_of(error: ValidationError, data: object) -> list[Fault]:
    """Return pydantic's errors as faults in plain words; what `SpecModel` reports itself is left out."""
    faults: list[Fault] = []
    for item in error.errors(include_url=False):
        keys = _keys_in(data, item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, FaultyValueError):
            faults += [fault.under(*keys) for fault in cause.faults]
        elif item["type"] in ("missing", "extra_forbidden"):
            continue
        else:
            faults.append(Fault(_shape_words(item["type"], item["input"]), keys))
    return faults


def _keys_in(data: object, loc: tuple[str | int, ...]) -> Keys:
    """Return the keys of a pydantic location; a union's tag is no key of the file."""
    keys: list[str | int] = []
    here: Any = data
    for part in loc:
        if isinstance(here, dict) and part not in here and part in (here.get("type"), here.get("method")):
            continue
        keys.append(part)
        if isinstance(here, dict):
            here = here.get(part)
        elif isinstance(here, list) and isinstance(part, int):
            here = here[part]
    return tuple(keys)


def _shape_words(kind: str, value: object) -> str:
    wanted = {
        "tuple_type": "a list",
        "list_type": "a list",
        "dict_type": "a mapping",
        "model_type": "a mapping",
        "model_attributes_type": "a mapping",
    }.get(kind, "something else")
    if value is None:
        return f"needs a value: {wanted}" + (", [] for an empty one" if wanted == "a list" else "")
    return f"must be {wanted}, not {show(value)}"


def mappings_in(data: Mapping[str, Any], key: str) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the mappings of a list with their indices, whatever else may stand there."""
    value = data.get(key)
    if isinstance(value, list):
        for i, item in enumerate(value):
            if isinstance(item, dict):
                yield i, item
