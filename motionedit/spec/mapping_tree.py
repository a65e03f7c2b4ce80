"""A Python mapping as a spec's tree: what YAML would have said, without lines."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, SupportsIndex

from motionedit.spec.faults import Fault, Keys, show
from motionedit.spec.syntax import DEEPEST
from motionedit.spec.yaml_tree import Node

if TYPE_CHECKING:
    from collections.abc import Iterable

# What a node without a line has.
NO_LINE = 0


def tree_of(data: object, *, source: str | None = None) -> tuple[Node, list[Fault]]:
    """Return the tree of a plain value, and what in it no spec could say; `data` is only read.

    Tuples and other sequences, and numpy's arrays, are lists; numpy's numbers are numbers; paths are texts.

    Parameters
    ----------
    source : str, optional
        What messages call the place of a value that does not come from the spec itself.
    """
    builder = _Builder(source)
    return builder.node(data, ()), builder.faults


class _Builder:
    def __init__(self, source: str | None) -> None:
        self.faults: list[Fault] = []
        self._source = source

    def node(self, value: object, keys: Keys) -> Node:
        """Return the node of a value; a fault leaves an empty one."""
        if len(keys) > DEEPEST:
            return self._faulty(f"nested more than {DEEPEST} deep", keys[:3])
        if hasattr(value, "tolist"):  # numpy's arrays and numbers, and all that behave like them
            value = value.tolist()
        elif isinstance(value, SupportsIndex) and not isinstance(value, int):  # other libraries' whole numbers
            value = operator.index(value)
        if isinstance(value, os.PathLike):
            value = os.fspath(value)
        if isinstance(value, Mapping):
            return self._mapping(value, keys)
        if isinstance(value, Sequence) and not isinstance(value, (str, bytes, bytearray)):
            return self._parent([self.node(item, (*keys, i)) for i, item in enumerate(value)])
        if value is None or isinstance(value, (bool, int, float, str)):
            return self._leaf(value)
        return self._faulty(f"a value of type {type(value).__name__} cannot stand in a spec", keys)

    def _mapping(self, value: Mapping[object, object], keys: Keys) -> Node:
        children: dict[str, Node] = {}
        for name, item in value.items():
            key = os.fspath(name) if isinstance(name, os.PathLike) else name
            if not isinstance(key, str):
                self._faulty(f"a key must be a word, not {show(key)}", keys)
                continue
            children[key] = self.node(item, (*keys, key))
        node = self._parent(children)
        node.key_lines = dict.fromkeys(children, NO_LINE)
        return node

    def _parent(self, value: dict[str, Node] | list[Node]) -> Node:
        children: Iterable[Node] = value.values() if isinstance(value, dict) else value
        size, depth = 1, 1
        for child in children:
            size, depth = size + child.size, max(depth, child.depth + 1)
        return Node(value, NO_LINE, source=self._source, size=size, depth=depth)

    def _leaf(self, value: object) -> Node:
        return Node(value, NO_LINE, source=self._source)

    def _faulty(self, message: str, keys: Keys) -> Node:
        self.faults.append(Fault(message, keys))
        return self._leaf(None)
