"""What all spec models share: keys with kinds of values, and all faults of a mapping reported at once."""

from collections.abc import Callable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any, ClassVar, NoReturn, Self

from motionedit.dataclass import dataclass
from motionedit.spec.faults import Fault, FaultyValueError, faulty, nearest, show
from motionedit.spec.values import unknown_key

# Named in the contract for later work, so that nobody takes the names for something else.
LATER_KEYS = frozenset({"above", "feet", "joint_map", "limits", "outside", "scale"})
# The default of a key that must be given.
REQUIRED: Any = object()


@dataclass(frozen=True)
class Context:
    """What a value may need beside itself.

    `folder` is what paths are relative to and `label` the folder as messages name it. `events` are the names that
    times may use, None where any name may be meant.
    """

    folder: Path | None = None
    label: str = ""
    events: frozenset[str] | None = None

    def label_of(self, file: str) -> str:
        """Return what messages call a file that the spec names."""
        return file if self.label in ("", ".") or Path(file).is_absolute() else f"{self.label}/{file}"


NO_CONTEXT = Context()


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of value: `parse` makes it from a plain value, `wanted` names it, `json` is its JSON Schema.

    An empty value is refused unless `null`, which gives None; `parse` never sees one. `models` are those that `json`
    refers to.
    """

    parse: Callable[[Any, Context], object]
    wanted: str
    json: Mapping[str, Any]
    null: bool = False
    models: "tuple[type[SpecModel], ...]" = ()

    def value_of(self, value: object, context: Context) -> object:
        """Return the value that a plain one means.

        Raises
        ------
        FaultyValueError
            It is none of this kind.
        """
        if value is None:
            if self.null:
                return None
            raise faulty(f"needs a value: {self.wanted}")
        return self.parse(value, context)


@dataclass(frozen=True, eq=False)
class SpecKey:
    """A key of a mapping, as `spec_key` makes it: `name` is its name in YAML."""

    name: str
    kind: Kind
    default: Any
    description: str
    after: Callable[[Any, Mapping[str, Any]], object] | None
    more: Mapping[str, Any]

    @property
    def is_required(self) -> bool:
        """Whether it must be given."""
        return self.default is REQUIRED


def spec_key(
    kind: Kind,
    *,
    description: str,
    default: Any = REQUIRED,  # noqa: ANN401  of the attribute's type
    name: str = "",
    after: Callable[[Any, Mapping[str, Any]], object] | None = None,
    more: Mapping[str, Any] | None = None,
) -> Any:  # noqa: ANN401  it stands for the attribute's value
    """Return what makes an attribute of a `SpecModel` a key of its mapping.

    Parameters
    ----------
    kind : Kind
        Of its values.
    description : str
        For the JSON Schema, and the documentation.
    default
        The attribute's value where the key is not given; without it, it must be.
    name : str
        The key; the attribute's name if not given.
    after : callable
        Makes the attribute of the parsed value and of those of the keys before it, by their attributes' names; of keys
        that are at fault it has none.
    more : mapping
        What else its JSON Schema has.
    """
    return SpecKey(name, kind, default, description, after, {} if more is None else more)


class SpecModel:
    """A mapping of a spec: frozen, without unknown keys, and with all of its faults in one error.

    Two are equal where all their keys are. A new one has the defaults of all its keys.
    """

    # By the names of attributes; those of the most general class come first.
    model_keys: ClassVar[Mapping[str, SpecKey]] = {}
    # Groups of keys of which exactly, at most or at least one is given.
    exactly_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_most_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    at_least_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    # What `faults_between_keys` refuses, as far as JSON Schema can say it, for editors.
    between_keys: ClassVar[tuple[Mapping[str, Any], ...]] = ()
    # What stands at a key that is unknown here but not elsewhere: "belongs to ...".
    foreign_keys: ClassVar[Mapping[str, str]] = {}

    # The attributes whose keys were given.
    given: frozenset[str]

    def __init_subclass__(cls) -> None:
        own = chain.from_iterable(vars(base).items() for base in reversed(cls.__mro__))
        keys = {attribute: found for attribute, found in own if isinstance(found, SpecKey)}
        cls.model_keys = {
            attribute: found if found.name else _named(found, attribute) for attribute, found in keys.items()
        }

    def __init__(self) -> None:
        vars(self).update({attribute: found.default for attribute, found in self.model_keys.items()})
        vars(self)["given"] = frozenset()

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"{type(self).__name__} is frozen: '{name}' stays")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(getattr(self, attribute) == getattr(other, attribute) for attribute in self.model_keys)

    def __hash__(self) -> int:
        return hash((type(self), *(getattr(self, attribute) for attribute in self.model_keys)))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.attributes())})"

    def attributes(self) -> Iterator[tuple[str, Any]]:
        """Yield the name and the value of each attribute that is a key."""
        for attribute in self.model_keys:
            yield attribute, getattr(self, attribute)

    def changed(self, values: Mapping[str, object]) -> Self:
        """Return a copy with other values of some attributes, whatever they are."""
        copy = object.__new__(type(self))
        vars(copy).update(vars(self) | dict(values))
        return copy

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys of plain `data`, whose values may be anything."""
        del data
        yield from ()

    @classmethod
    def key_names(cls) -> tuple[str, ...]:
        """Return the keys of the mapping, as YAML has them."""
        return tuple(found.name for found in cls.model_keys.values())

    @classmethod
    def wanted(cls) -> str:
        """Return what a mapping of this model is, in words."""
        return f"a mapping with the keys {', '.join(cls.key_names())}"

    @classmethod
    def parse(cls, data: object, context: Context = NO_CONTEXT) -> Self:
        """Return the model of plain data.

        Raises
        ------
        FaultyValueError
            With all faults: those of its keys as such, then of their values in the model's order.
        """
        if not isinstance(data, dict):
            raise faulty(f"must be {cls.wanted()}; not {show(data)}")
        faults = list(cls._unknown_keys(data))
        meant = cls._as_meant(data) if faults else data
        faults += [*cls._missing_keys(meant), *cls._faults_in_groups(meant), *cls.faults_between_keys(meant)]
        values: dict[str, Any] = {}
        for attribute, found in cls.model_keys.items():
            if found.name not in data:
                values[attribute] = found.default
                continue
            try:
                value = found.kind.value_of(data[found.name], context)
                values[attribute] = value if found.after is None else found.after(value, values)
            except FaultyValueError as error:
                faults += [fault.under(found.name) for fault in error.faults]
        if faults:
            raise FaultyValueError(faults)
        values["given"] = frozenset(attribute for attribute, found in cls.model_keys.items() if found.name in data)
        return cls().changed(values)

    @classmethod
    def _unknown_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        names = cls.key_names()
        for name in data:
            if name in names:
                continue
            if name in cls.foreign_keys:
                yield Fault(cls.foreign_keys[name], (name,))
            elif name in LATER_KEYS:
                yield Fault("not supported yet", (name,))
            else:
                yield Fault(unknown_key(name, names), (name,))

    @classmethod
    def _as_meant(cls, data: Mapping[str, Any]) -> dict[str, Any]:
        """Return the data with misspelt keys put right, so that one slip is not reported as a missing key too."""
        names = cls.key_names()
        return {(name if name in names else nearest(name, names) or name): value for name, value in data.items()}

    @classmethod
    def _faults_in_groups(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        for group in (*cls.exactly_one, *cls.at_least_one):
            if not any(name in data for name in group):
                yield Fault(f"needs one of {', '.join(group)}")
        for group in (*cls.exactly_one, *cls.at_most_one):
            given = [name for name in data if name in group]
            for name in given[1:]:
                yield Fault(f"stands beside {given[0]}; give one of {', '.join(group)}", (name,))

    @classmethod
    def _missing_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        for found in cls.model_keys.values():
            if found.is_required and found.name not in data:
                yield Fault(
                    f"is missing; it is {found.kind.wanted}" if found.kind.wanted else "is missing", (found.name,)
                )


def _named(found: SpecKey, attribute: str) -> SpecKey:
    return SpecKey(attribute, found.kind, found.default, found.description, found.after, found.more)


def mappings_in(data: Mapping[str, Any], name: str) -> Iterator[tuple[int, dict[str, Any]]]:
    """Yield the mappings of a list with their indices, whatever else may stand there."""
    value = data.get(name)
    if isinstance(value, list):
        for i, item in enumerate(value):
            if isinstance(item, dict):
                yield i, item
