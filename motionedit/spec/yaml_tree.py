"""YAML text as a tree of nodes that know their lines, read by our own rules for numbers, booleans and keys.

The tree is built from the parser's events in one loop, not by recursion, so that the depth and the number of nodes,
aliases counted as often as they are used, are checked while they grow: no text can make it slow or deep.
"""

from __future__ import annotations

import re
from dataclasses import field
from typing import TYPE_CHECKING, Any

import yaml

from motionedit.dataclass import dataclass
from motionedit.spec import grammar
from motionedit.spec.faults import Fault, FaultyValueError, Keys, show
from motionedit.spec.syntax import DEEPEST, syntax_fault

if TYPE_CHECKING:
    from collections.abc import Iterator

# A spec is a page of text; this bound, and DEEPEST, are far above any real one and keep a hostile one from taking long.
MOST_NODES = 200_000

_INTEGER = re.compile(rf"[-+]?{grammar.INTEGER}")
_FLOAT = re.compile(rf"[-+]?(?:{grammar.AMOUNT})")
# Python refuses to convert integers of thousands of digits; a float of any length is cheap.
_LONGEST_INTEGER = 40

_CORE = "tag:yaml.org,2002:"
_NULLS = ("", "~", "null")
_BOOLEANS = {"true": True, "false": False}


@dataclass
class Node:
    """A value and where it stands.

    `value` is a scalar, a list of nodes or a mapping of nodes; `line` counts from 1; `key_lines` are the lines of a
    mapping's keys; `source` is the command line's option where the value does not come from the file.
    """

    value: Any
    line: int
    key_lines: dict[str, int] = field(default_factory=dict)
    source: str | None = None
    size: int = 1
    depth: int = 1

    def plain(self) -> Any:  # noqa: ANN401 (a plain value is anything YAML can say)
        """Return the value as plain dictionaries, lists and scalars, each a copy of its own."""
        if isinstance(self.value, dict):
            return {key: child.plain() for key, child in self.value.items()}
        if isinstance(self.value, list):
            return [child.plain() for child in self.value]
        return self.value

    def child(self, key: str | int) -> Node | None:
        """Return the node under a key or index, None where there is none."""
        if isinstance(self.value, dict):
            return self.value.get(str(key))
        if isinstance(self.value, list) and isinstance(key, int) and 0 <= key < len(self.value):
            child: Node = self.value[key]
            return child
        return None


def read_tree(text: str) -> tuple[Node | None, list[Fault]]:
    """Return the tree of a text, None where it is empty, and its faults (each with its line).

    Where the text is no YAML at all the tree is None too, and there is a fault.
    """
    builder = _Builder()
    try:
        for event in _events(text):
            builder.take(event)
    except FaultyValueError as error:
        return None, [*builder.faults, *error.faults]
    except yaml.YAMLError as error:
        return None, [*builder.faults, syntax_fault(error, text)]
    return builder.root, builder.faults


def value_from_text(text: str) -> Any:  # noqa: ANN401 (as Node.plain)
    """Return the plain value of a text such as ``{joint: Club, offset: [0, -92, 0]}``, as a spec would read it.

    Raises
    ------
    FaultyValueError
        Where the text is not YAML.
    """
    node, faults = read_tree(text)
    if faults:
        raise FaultyValueError([Fault(fault.message, fault.keys) for fault in faults])
    return None if node is None else node.plain()


def _events(text: str) -> Iterator[Any]:
    # libyaml's parser is ten times faster; the other one serves where PyYAML was built without it.
    loader = getattr(yaml, "CLoader", yaml.Loader)
    return yaml.parse(text, Loader=loader)


@dataclass
class _Open:
    """A list or mapping that is being read."""

    node: Node
    anchor: str | None
    key: str | None = None
    key_line: int = 0
    merged: list[tuple[Node, int]] = field(default_factory=list)


class _Builder:
    def __init__(self) -> None:
        self.root: Node | None = None
        self.faults: list[Fault] = []
        self._stack: list[_Open] = []
        self._anchors: dict[str, Node] = {}
        self._count = 0
        self._documents = 0

    def take(self, event: yaml.Event) -> None:
        line = event.start_mark.line + 1  # type: ignore[union-attr]  # every event has its mark
        match event:
            case yaml.DocumentStartEvent():
                self._documents += 1
                if self._documents > 1:
                    raise self._faulty("a second document begins here; a spec is one document", line)
            case yaml.ScalarEvent():
                self._scalar(event, line)
            case yaml.AliasEvent():
                self._alias(event, line)
            case yaml.MappingStartEvent():
                self._open(Node({}, line), event, "map")
            case yaml.SequenceStartEvent():
                self._open(Node([], line), event, "seq")
            case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                self._close()

    def _faulty(self, message: str, line: int) -> FaultyValueError:
        return FaultyValueError([Fault(message, self._path(), line=line)])

    def _path(self) -> Keys:
        keys: list[str | int] = []
        for level in self._stack:
            if isinstance(level.node.value, list):
                keys.append(len(level.node.value))
            elif level.key is not None:
                keys.append(level.key)
        return tuple(keys)

    def _scalar(self, event: yaml.ScalarEvent, line: int) -> None:
        level = self._stack[-1] if self._stack else None
        if level is not None and isinstance(level.node.value, dict) and level.key is None:
            self._key(level, event, line)
            return
        node = Node(self._resolved(event, line), line)
        self._count_nodes(1, line)
        if event.anchor is not None:
            self._anchors[event.anchor] = node
        self._put(node, line)

    def _resolved(self, event: yaml.ScalarEvent, line: int) -> object:
        tag = event.tag
        text: str = event.value
        if tag is None or tag == "!":
            plain = tag is None and event.implicit[0]
            return scalar(text) if plain else text
        kinds = {"str": str, "int": int, "float": float, "bool": bool, "null": type(None)}
        kind = kinds.get(tag.removeprefix(_CORE))
        if kind is None:
            raise self._faulty(f"the tag {_short(tag)} is not supported", line)
        value = text if kind is str else scalar(text)
        if kind is float and isinstance(value, int):
            value = float(value)
        if type(value) is not kind:
            raise self._faulty(f"{show(text)} is not what its tag says", line)
        return value

    def _key(self, level: _Open, event: yaml.ScalarEvent, line: int) -> None:
        self._count_nodes(1, line)
        if event.value == "" and event.implicit[0]:
            raise self._faulty("a key is missing before the ':'", line)
        # Keys keep their text, so that a clip may be called 001.
        level.key, level.key_line = event.value, line
        if event.value == "<<" and event.implicit[0]:
            level.key = _MERGE
        if event.anchor is not None:
            self._anchors[event.anchor] = Node(event.value, line)

    def _alias(self, event: yaml.AliasEvent, line: int) -> None:
        name = event.anchor or ""
        if any(level.anchor == name for level in self._stack):
            raise self._faulty(f"*{name} stands inside itself", line)
        if name not in self._anchors:
            raise self._faulty(f"no anchor &{name} above", line)
        node = self._anchors[name]
        level = self._stack[-1]
        if isinstance(level.node.value, dict) and level.key is None:
            if isinstance(node.value, (dict, list)):
                raise self._faulty("a key must be a word", line)
            level.key, level.key_line = str(node.value), line
            return
        self._count_nodes(node.size, line)
        if len(self._stack) + node.depth > DEEPEST:
            raise self._faulty(f"nested more than {DEEPEST} deep", line)
        self._put(node, line)

    def _open(self, node: Node, event: yaml.CollectionStartEvent, kind: str) -> None:
        level = self._stack[-1] if self._stack else None
        if level is not None and isinstance(level.node.value, dict) and level.key is None:
            raise self._faulty("a key must be a word, not a list or mapping", node.line)
        if event.tag not in (None, "!", _CORE + kind):
            raise self._faulty(f"the tag {_short(event.tag)} is not supported", node.line)
        self._count_nodes(1, node.line)
        if len(self._stack) + 1 > DEEPEST:
            raise self._faulty(f"nested more than {DEEPEST} deep", node.line)
        self._stack.append(_Open(node, event.anchor))

    def _close(self) -> None:
        level = self._stack.pop()
        node = level.node
        for other, line in level.merged:
            self._merge(node, other, line)
        if level.anchor is not None:
            self._anchors[level.anchor] = node
        self._put(node, node.line)

    def _put(self, node: Node, line: int) -> None:
        if not self._stack:
            self.root = node
            return
        level = self._stack[-1]
        parent = level.node
        parent.size += node.size
        parent.depth = max(parent.depth, node.depth + 1)
        if isinstance(parent.value, list):
            parent.value.append(node)
            return
        key, level.key = level.key or "", None
        if key == _MERGE:
            level.merged.append((node, line))
        elif key in parent.value:
            message = f"given twice, on lines {parent.key_lines[key]} and {level.key_line}; keep one"
            self.faults.append(Fault(message, (*self._path(), key), line=level.key_line))
        else:
            parent.value[key] = node
            parent.key_lines[key] = level.key_line

    def _merge(self, node: Node, other: Node, line: int) -> None:
        """Add the keys of `<<: *anchor`, or of a list of them, that the mapping does not give itself."""
        for source in other.value if isinstance(other.value, list) else [other]:
            if not isinstance(source.value, dict):
                raise self._faulty("<< needs a mapping, such as *anchor", line)
            for key, child in source.value.items():
                if key not in node.value:
                    node.value[key] = child
                    node.key_lines[key] = source.key_lines[key]

    def _count_nodes(self, nodes: int, line: int) -> None:
        self._count += nodes
        if self._count > MOST_NODES:
            raise self._faulty(f"more than {MOST_NODES} values", line)


# No key of a file can be equal to it: YAML allows no such character.
_MERGE = "\0merge"


def _short(tag: str) -> str:
    return show(tag.replace(_CORE, "!!"))


def scalar(text: str) -> object:
    """Return the value of a plain scalar: null, true, false, a decimal number, or the text itself.

    The traps of YAML 1.1 are left out: ``010`` is 10, ``1e-3`` is 0.001, and ``0x10``, ``1_000``, ``10:20``, ``yes``,
    ``off``, ``.nan`` and dates are texts.
    """
    if text in _NULLS:
        return None
    if text in _BOOLEANS:
        return _BOOLEANS[text]
    if _INTEGER.fullmatch(text) and len(text) <= _LONGEST_INTEGER:
        return int(text)
    return float(text) if _FLOAT.fullmatch(text) else text
