"""Goals and constraints: items of a list with names and effectors, where a list of effectors is one item each."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Self, TypeVar

from motionedit.spec import kinds
from motionedit.spec.faults import Fault, Keys, dotted, faulty
from motionedit.spec.model import SpecModel, mappings_in, spec_key
from motionedit.spec.values import EffectorSpec


class Item(SpecModel):
    """A named item of a list, which knows where it stands in the file."""

    name: str = spec_key(
        kinds.NAME,
        default="",
        description="Name in reports and for --set; default: the effector's, numbered where repeated.",
    )
    _keys: Keys = ()

    @property
    def keys(self) -> Keys:
        """Keys of this item in the spec, for `LoadedSpec.error`: ``("goals", 0)``."""
        return self._keys

    def keys_of(self, key: str) -> Keys:
        """Return the keys of one of its keys in the spec."""
        return (*self.keys, key)

    @property
    def default_name(self) -> str:
        """The name of an item that gives none."""
        return ""

    def apart(self) -> Iterator[Self]:
        """Yield the items that this one stands for."""
        yield self

    def _place(self, keys: Keys, name: str) -> Self:
        return self.changed({"name": name, "_keys": keys})


# What is said of an effector's keys that stand beside it.
EFFECTOR_KEYS = {
    "joint": "belongs to effector, as effector: NAME, or effector: {joint: NAME, offset: [x, y, z]}",
    "end_site": "belongs to effector, as effector: {end_site: NAME}",
}


class EffectorItem(Item):
    """An item with an effector."""

    effectors: tuple[EffectorSpec, ...] = spec_key(
        kinds.EFFECTORS,
        name="effector",
        description="The point of the body that is meant; a list stands for one item each.",
    )
    _list_index: int | None = None

    @property
    def effector(self) -> EffectorSpec:
        """The effector; a loaded spec's items have exactly one."""
        return self.effectors[0]

    @property
    def effector_keys(self) -> Keys:
        """Keys of the effector in the spec, for `LoadedSpec.error`: ``("goals", 0, "effector")``."""
        index = () if self._list_index is None else (self._list_index,)
        return (*self.keys, "effector", *index)

    def keys_of(self, key: str) -> Keys:
        """Return the keys of one of its keys in the spec."""
        return self.effector_keys if key == "effector" else super().keys_of(key)

    @property
    def default_name(self) -> str:
        """The effector's joint."""
        return self.effector.joint

    def apart(self) -> Iterator[Self]:
        """Yield one item for each effector."""
        for i, effector in enumerate(self.effectors):
            index = i if len(self.effectors) > 1 else None
            yield self.changed({"effectors": (effector,), "_list_index": index})


# For `between_keys`: the heading's frame beside a joint's.
NOT_TWO_FRAMES = {"not": {"properties": {"frame": {"const": "heading"}}, "required": ["frame", "relative_to"]}}


def without(key: str) -> dict[str, Any]:
    """Return the JSON Schema of what has not this key: another mapping, or no mapping at all."""
    return {"not": {"type": "object", "required": [key]}}


def measure_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Yield what is wrong with what an item is measured in.

    That is two frames, or the frame of the joint that its effector is on: there it never moves.
    """
    if data.get("frame") == "heading" and "relative_to" in data:
        yield Fault("stands beside frame: heading; give one of them", ("relative_to",))
    base, effectors = data.get("relative_to"), data.get("effector")
    for effector in effectors if isinstance(effectors, list) else [effectors]:
        joints = [effector.get(key) for key in ("joint", "end_site")] if isinstance(effector, dict) else [effector]
        if isinstance(base, str) and base in joints:
            yield Fault(
                f"'{base}' is the effector itself, which never moves in its own frame; name another joint, such as one "
                "above it, or leave it out for the world",
                ("relative_to",),
            )
            return


# Ten times what the largest specs in use ask for.
MOST_ITEMS = 100

AnyItem = TypeVar("AnyItem", bound=Item)


def taken_apart(items: Sequence[AnyItem], key: str) -> tuple[AnyItem, ...]:
    """Return the items that a list at `key` stands for, each with its name and place in the file."""
    used = {item.name for item in items if item.name}
    parts = [(i, n, part) for i, item in enumerate(items) for n, part in enumerate(item.apart())]
    if len(parts) > MOST_ITEMS:
        raise faulty(f"are {len(parts)}; one spec has {MOST_ITEMS} at most: their time grows faster than their number")
    found: list[AnyItem] = []
    for i, n, part in parts:
        base = part.name or part.default_name
        # The first item of a given name keeps it; every other name is numbered until it is free.
        name = base if n == 0 and part.name else _free_name(base, used)
        used.add(name)
        found.append(part._place((key, i), name))  # noqa: SLF001 (the module of its class)
    return tuple(found)


def _free_name(base: str, used: set[str]) -> str:
    if base not in used:
        return base
    n = 2
    while f"{base}-{n}" in used:
        n += 1
    return f"{base}-{n}"


def repeated_names(data: Mapping[str, Any], key: str) -> Iterator[Fault]:
    """Yield a fault at each given name of a list's items that an item above has."""
    first: dict[str, int] = {}
    for i, item in mappings_in(data, key):
        name = item.get("name")
        if isinstance(name, str):
            if name in first:
                where = dotted((key, first[name], "name"))
                yield Fault(f"'{name}' is already the name at {where}; give each its own", (key, i, "name"))
            first.setdefault(name, i)
