"""Load a spec: a file or a mapping, what changes it, and one report of everything that is wrong in it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, SupportsIndex, TypedDict, TypeVar, Unpack, overload

from motionedit.dataclass import dataclass, replace
from motionedit.errors import MotionEditError, SpecError, together
from motionedit.spec import SPEC_COMMANDS, model_of, schema_name
from motionedit.spec.faults import Fault, FaultyValueError, Keys, dotted
from motionedit.spec.mapping_tree import NO_LINE, tree_of
from motionedit.spec.overrides import apply_overrides
from motionedit.spec.text_files import read_text
from motionedit.spec.yaml_tree import Node, read_tree

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.spec.document import Document
    from motionedit.spec.edit_pc import EditPcSpec
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.fit_pca import FitPcaSpec
    from motionedit.spec.normalize import NormalizeSpec

Model_co = TypeVar("Model_co", bound="Document", covariant=True)

_SCHEMA = re.compile(r"motionedit/([a-z-]+)/(v[0-9]+)")


# What messages call a spec that is no file.
_MAPPING = "spec"


@dataclass(frozen=True)
class LoadedSpec(Generic[Model_co]):
    """A spec and where it came from.

    Attributes
    ----------
    model : the command's spec
    path : Path or None
        The file; None where the spec is a mapping.
    label : str
        What messages call it.
    data : dict
        The plain spec with the overrides applied, keys in the file's order: for reports.
    tree : Node
        The lines of all keys.
    listed : frozenset of str
        The events that the spec itself lists.
    """

    model: Model_co
    path: Path | None
    label: str
    data: dict[str, Any]
    tree: Node
    listed: frozenset[str] = frozenset()

    @property
    def known_events(self) -> frozenset[str]:
        """The events that the spec itself lists, or names in a time: those whose frames may be given beside it."""
        from motionedit.spec.event_names import events_named

        return self.listed | frozenset(events_named(self.model))

    @property
    def files(self) -> tuple[Path, ...]:
        """The spec and all files it names: what an output depends on."""
        own = () if self.path is None else (self.path,)
        return (*own, *self.model.event_files)

    def error(self, keys: Sequence[str | int], message: str) -> SpecError:
        """Return an error at a key, with the line of the nearest key above it that the file has."""
        return _located(Fault(message, tuple(keys)), self.tree, self.label)

    def has(self, keys: Sequence[str | int]) -> bool:
        """Return whether the spec gives the key."""
        asked = tuple(keys)
        if asked not in self._given:
            self._given[asked] = len(_way(self.tree, asked)) == len(asked) + 1
        return self._given[asked]

    @cached_property
    def _given(self) -> dict[Keys, bool]:
        """The keys that were asked for, which every clip asks for again, and whether the spec gives them."""
        return {}


class Overrides(TypedDict, total=False):
    """What changes a spec after it was read.

    `overrides` are ``KEY=VALUE`` of each `--set`, applied in their order; `events` are frames of events by name, which
    take the place of the spec's own.
    """

    overrides: Sequence[str]
    events: Mapping[str, SupportsIndex]


Spec = Path | Mapping[str, Any]


@overload
def load_spec(spec: Spec, command: Literal["normalize"], **changes: Unpack[Overrides]) -> LoadedSpec[NormalizeSpec]: ...
@overload
def load_spec(spec: Spec, command: Literal["fit-pca"], **changes: Unpack[Overrides]) -> LoadedSpec[FitPcaSpec]: ...
@overload
def load_spec(spec: Spec, command: Literal["edit-pc"], **changes: Unpack[Overrides]) -> LoadedSpec[EditPcSpec]: ...
@overload
def load_spec(
    spec: Spec, command: Literal["edit-prioritized"], **changes: Unpack[Overrides]
) -> LoadedSpec[EditPrioritizedSpec]: ...
def load_spec(spec: Spec, command: str, **changes: Unpack[Overrides]) -> LoadedSpec[Any]:
    """Return a command's spec out of a file, or of a mapping.

    Parameters
    ----------
    spec : Path or mapping
        Paths in a file are relative to it, those in a mapping to the working folder. A mapping may leave out `schema`;
        it is not changed.
    command : str
        The command that wants it: a spec of another one is refused.

    Raises
    ------
    MotionEditError
        The fault of the spec, or all of them, sorted by line.
    """
    path = spec if isinstance(spec, Path) else None
    label = _MAPPING if path is None else str(path)
    tree, faults = _tree_of_mapping(spec, command) if isinstance(spec, Mapping) else _tree(spec, command)
    # What no spec can say is told once, not again as a value that is missing.
    unsayable = {fault.keys for fault in faults} if path is None else set()
    own = tree.child("events")
    listed = frozenset(own.value) if own is not None and isinstance(own.value, dict) else frozenset()
    tree, found = _with_events(tree, changes.get("events", {}))
    faults += found
    overrides = changes.get("overrides", ())
    tree, found = apply_overrides(tree, overrides, known=model_of(command).key_names() if overrides else ())
    faults += found
    data = tree.plain()
    if other := _other_command(data, command):
        # A spec of another command: its other keys would all be faults, and none of them would help.
        raise _together([Fault(other, ("schema",))], tree, label)
    if "schema" not in data:
        faults.append(Fault(f"is missing; the first line is schema: {schema_name(command)}", ("schema",)))
    model, found = _validated(data, command, Path() if path is None else path.parent)
    faults += [fault for fault in found if fault.keys not in unsayable]
    if faults or model is None:
        raise _together(faults, tree, label)
    return LoadedSpec(model, path, label, data, tree, listed)


def with_reference(loaded: LoadedSpec[EditPrioritizedSpec], reference: str) -> LoadedSpec[EditPrioritizedSpec]:
    """Return a spec with another reference, a path as the command line has it; reports and faults tell it, too."""
    tree, model = loaded.tree, loaded.model.changed({"reference": Path(reference)})
    node = Node(reference, tree.line, source="--reference")
    lines = {**tree.key_lines, "reference": tree.line}
    tree = replace(tree, value={**tree.value, "reference": node}, key_lines=lines)
    return replace(loaded, model=model, data={**loaded.data, "reference": reference}, tree=tree)


def spec_command(path: Path, commands: Collection[str]) -> str:
    """Return the command that a file is a spec of.

    Raises
    ------
    MotionEditError
        The file cannot be read, or its schema is none of the commands'.
    """
    tree, _ = _tree(path, "COMMAND")
    schema = tree.plain().get("schema")
    match = _SCHEMA.fullmatch(schema) if isinstance(schema, str) else None
    if match is None or match[1] not in commands:
        message = f"must be one of {', '.join(schema_name(command) for command in commands)}"
        raise _together([Fault(message, ("schema",))], tree, str(path))
    return match[1]


def _tree_of_mapping(spec: Mapping[str, Any], command: str) -> tuple[Node, list[Fault]]:
    tree, faults = tree_of(spec)
    if "schema" not in tree.value:
        tree.value = {"schema": Node(schema_name(command), NO_LINE), **tree.value}
        tree.key_lines["schema"] = NO_LINE
    return tree, faults


def _with_events(tree: Node, events: Mapping[str, SupportsIndex]) -> tuple[Node, list[Fault]]:
    """Return the tree with frames of events in place of its own, and the faults of those that are none."""
    own = tree.child("events")
    children = dict(own.value) if own is not None and isinstance(own.value, dict) else {}
    faults: list[Fault] = []
    for name, frame in events.items():
        children[name], found = tree_of(frame, source=f"events.{name}")
        faults += [Fault(fault.message, file=f"events.{name}") for fault in found]
    if not events:
        return tree, faults
    line = NO_LINE if own is None else own.line
    lines = dict.fromkeys(children, line) | ({} if own is None else own.key_lines)
    changed = Node(children, line, key_lines=lines)
    return replace(tree, value={**tree.value, "events": changed}, key_lines={"events": line, **tree.key_lines}), faults


def _tree(path: Path, command: str) -> tuple[Node, list[Fault]]:
    """Return the mapping of a file and its duplicate keys; raise where there is no mapping."""
    text, fault = read_text(path)
    faults = [fault] if fault is not None else []
    tree: Node | None = None
    begin = f"a spec begins with schema: {schema_name(command)}"
    if text.lstrip().startswith("HIERARCHY"):
        faults = [Fault(f"is a BVH clip; {begin}")]
    if not faults:
        tree, faults = read_tree(text)
        if not faults and (tree is None or tree.value is None):
            faults = [Fault(f"is empty; {begin}")]
        elif tree is not None and not isinstance(tree.value, dict):
            faults.append(Fault(f"is not a mapping of keys; {begin}", line=tree.line))
            tree = None
    if tree is None or tree.value is None:
        raise _together(faults, Node({}, NO_LINE), str(path))
    return tree, faults


def _other_command(data: dict[str, Any], command: str) -> str | None:
    """Return what to say where the spec is another command's."""
    schema = data.get("schema")
    match = _SCHEMA.fullmatch(schema) if isinstance(schema, str) else None
    if match is None or match[1] == command or match[1] not in SPEC_COMMANDS:
        return None
    return f"this is a spec of {match[1]}; {command} wants {schema_name(command)}"


def _validated(data: dict[str, Any], command: str, folder: Path) -> tuple[Document | None, list[Fault]]:
    # Imported here: the time it takes is not spent on a file that cannot be read.
    from motionedit.spec.model import Context

    model = model_of(command)
    events = data.get("events", {})
    # With a model at hand, edit-pc may mean an event that only the model knows.
    known = frozenset(events) if isinstance(events, dict) and not model.knows_other_events else None
    context = Context(folder, "" if folder == Path() else str(folder), known)
    try:
        return model.parse(data, context), []
    except FaultyValueError as error:
        return None, list(error.faults)


def _together(faults: Sequence[Fault], tree: Node, file: str) -> MotionEditError:
    """Return all faults in one error: those of the command line, of the file by line, of other files by line."""
    placed = [_located(fault, tree, file) for fault in faults]

    def place(error: MotionEditError) -> tuple[bool, bool, str, int]:
        source = error.file or ""
        return not source.startswith("--set"), source != file, source, error.line or 0

    return together(f"{file} cannot be used", sorted(placed, key=place))


def _located(fault: Fault, tree: Node, file: str) -> SpecError:
    if fault.file is not None:
        return SpecError(fault.message, file=fault.file, line=fault.line)
    if fault.line is not None:
        return SpecError(fault.message, file=file, line=fault.line, key=dotted(fault.keys) or None)
    way = _way(tree, fault.keys)
    source = way[-1][0].source
    if source is not None:
        # From the first key that this option gave; what stands above it is named by the option.
        given = next(n for n, (node, _) in enumerate(way) if node.source == source)
        return SpecError(fault.message, file=source, key=dotted(fault.keys[given:]) or None)
    return SpecError(fault.message, file=file, line=way[-1][1] or None, key=dotted(fault.keys) or None)


def _way(tree: Node, keys: Keys) -> list[tuple[Node, int]]:
    """Return the nodes from the root along `keys`, as far as there are any, each with its line."""
    way = [(tree, tree.line)]
    for key in keys:
        node, _ = way[-1]
        child = node.child(key)
        if child is None:
            break
        line = node.key_lines[str(key)] if isinstance(node.value, dict) else child.line
        way.append((child, line))
    return way
