"""Load a spec: its file, the command line's overrides, and one report of everything that is wrong in it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, overload

from motionedit.dataclass import dataclass
from motionedit.errors import MotionEditError, MotionEditErrors, SpecError
from motionedit.spec import SPEC_COMMANDS, model_of, schema_name
from motionedit.spec.faults import Fault, Keys, dotted
from motionedit.spec.overrides import apply_overrides
from motionedit.spec.text_files import read_text
from motionedit.spec.yaml_tree import Node, read_tree

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.spec.document import Document
    from motionedit.spec.edit_pc import EditPcSpec
    from motionedit.spec.edit_prioritized import EditPrioritizedSpec
    from motionedit.spec.fit_pca import FitPcaSpec
    from motionedit.spec.normalize import NormalizeSpec

Model_co = TypeVar("Model_co", bound="Document", covariant=True)

_SCHEMA = re.compile(r"motionedit/([a-z-]+)/(v[0-9]+)")


@dataclass(frozen=True)
class LoadedSpec(Generic[Model_co]):
    """A spec and where it came from.

    Attributes
    ----------
    model : the command's spec
    path, folder : Path
        The file, and what paths inside it are relative to.
    data : dict
        The plain spec with the overrides applied, keys in the file's order: for reports.
    tree : Node
        The lines of all keys.
    """

    model: Model_co
    path: Path
    folder: Path
    data: dict[str, Any]
    tree: Node

    @property
    def files(self) -> tuple[Path, ...]:
        """The spec and all files it names: what an output depends on."""
        return (self.path, *self.model.event_files)

    def error(self, keys: Sequence[str | int], message: str) -> SpecError:
        """Return an error at a key, with the line of the nearest key above it that the file has."""
        return _located(Fault(message, tuple(keys)), self.tree, str(self.path))

    def has(self, keys: Sequence[str | int]) -> bool:
        """Return whether the spec gives the key."""
        return len(_way(self.tree, tuple(keys))) == len(keys) + 1


@overload
def load_spec(
    path: Path, command: Literal["normalize"], *, overrides: Sequence[str] = ()
) -> LoadedSpec[NormalizeSpec]: ...
@overload
def load_spec(path: Path, command: Literal["fit-pca"], *, overrides: Sequence[str] = ()) -> LoadedSpec[FitPcaSpec]: ...
@overload
def load_spec(path: Path, command: Literal["edit-pc"], *, overrides: Sequence[str] = ()) -> LoadedSpec[EditPcSpec]: ...
@overload
def load_spec(
    path: Path, command: Literal["edit-prioritized"], *, overrides: Sequence[str] = ()
) -> LoadedSpec[EditPrioritizedSpec]: ...
def load_spec(path: Path, command: str, *, overrides: Sequence[str] = ()) -> LoadedSpec[Any]:
    """Return a command's spec out of a file.

    Parameters
    ----------
    command : str
        The command that wants it: a spec of another one is refused.
    overrides : sequence of str
        ``KEY=VALUE`` of each `--set`, applied in their order.

    Raises
    ------
    MotionEditErrors
        All faults of the spec, sorted by line.
    """
    file = str(path)
    tree, faults = _tree(path, command)
    tree, found = apply_overrides(tree, overrides)
    faults += found
    data = tree.plain()
    if other := _other_command(data, command):
        # A spec of another command: its other keys would all be faults, and none of them would help.
        raise _together([Fault(other, ("schema",))], tree, file)
    if "schema" not in data:
        faults.append(Fault(f"is missing; the first line is schema: {schema_name(command)}", ("schema",)))
    model, found = _validated(data, command, path)
    faults += found
    if faults or model is None:
        raise _together(faults, tree, file)
    return LoadedSpec(model, path, path.parent, data, tree)


def _tree(path: Path, command: str) -> tuple[Node, list[Fault]]:
    """Return the mapping of a file and its duplicate keys; raise where there is no mapping."""
    text, fault = read_text(path)
    faults = [fault] if fault is not None else []
    tree: Node | None = None
    if not faults:
        tree, faults = read_tree(text)
        begin = f"a spec begins with schema: {schema_name(command)}"
        if not faults and (tree is None or tree.value is None):
            faults = [Fault(f"is empty; {begin}")]
        elif tree is not None and not isinstance(tree.value, dict):
            faults.append(Fault(f"is not a mapping of keys; {begin}", line=tree.line))
            tree = None
    if tree is None or tree.value is None:
        raise _together(faults, Node({}, 0), str(path))
    return tree, faults


def _other_command(data: dict[str, Any], command: str) -> str | None:
    """Return what to say where the spec is another command's."""
    schema = data.get("schema")
    match = _SCHEMA.fullmatch(schema) if isinstance(schema, str) else None
    if match is None or match[1] == command or match[1] not in SPEC_COMMANDS:
        return None
    return f"this is a spec of {match[1]}; {command} wants {schema_name(command)}"


def _validated(data: dict[str, Any], command: str, path: Path) -> tuple[Document | None, list[Fault]]:
    # Imported here: the time it takes is not spent on a file that cannot be read.
    from pydantic import ValidationError

    from motionedit.spec.model import Context, faults_of

    model = model_of(command)
    events = data.get("events", {})
    # With a model at hand, edit-pc may mean an event that only the model knows.
    known = frozenset(events) if isinstance(events, dict) and not model.knows_other_events else None
    context = Context(path.parent, "" if path.parent == Path() else str(path.parent), known)
    try:
        return model.model_validate(data, context=context), []
    except ValidationError as error:
        return None, faults_of(error, data)


def _together(faults: Sequence[Fault], tree: Node, file: str) -> MotionEditErrors:
    """Return all faults in one error: those of the command line, of the file by line, of other files by line."""
    placed = [_located(fault, tree, file) for fault in faults]

    def place(error: MotionEditError) -> tuple[bool, bool, str, int]:
        source = error.file or ""
        return not source.startswith("--set"), source != file, source, error.line or 0

    return MotionEditErrors(f"{file} cannot be used", sorted(placed, key=place))


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
