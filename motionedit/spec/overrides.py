"""`--set KEY=VALUE`: a spec's tree with single values replaced from the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.dataclass import replace
from motionedit.spec.faults import Fault, FaultyValueError, did_you_mean, dotted, faulty, listed
from motionedit.spec.syntax import DEEPEST
from motionedit.spec.yaml_tree import Node, read_tree

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence


def apply_overrides(root: Node, overrides: Sequence[str], *, known: Collection[str] = ()) -> tuple[Node, list[Fault]]:
    """Return the tree with each ``KEY=VALUE`` in place, and the faults of those that cannot be.

    A key is a dotted path; an item of a list is named by its index or its `name`. A missing key of a mapping is
    made; whether it may stand there, the spec's model says afterwards. A goal or constraint may be named without its
    list, as in ``ball.weight``, where its name is no key that the spec has or may have (`known`).
    """
    faults: list[Fault] = []
    for override in overrides:
        path, equals, text = override.partition("=")
        source = f"--set {path}"
        try:
            if not equals or not path.strip():
                raise faulty("must be KEY=VALUE, such as goals.0.weight=2")
            keys = path.strip().split(".")
            if len(keys) > DEEPEST:
                raise faulty(f"is a path of more than {DEEPEST} keys")
            root = _replaced(root, _from_list(root, keys, known), _value(text, source), ())
        except FaultyValueError as error:
            faults += [Fault(fault.message, file=source) for fault in error.faults]
    return root, faults


def _from_list(root: Node, keys: list[str], known: Collection[str]) -> list[str]:
    """Return a path with the list in front whose item its first key names; the path itself where none does."""
    if len(keys) < 2 or keys[0] in known or not isinstance(root.value, dict) or keys[0] in root.value:
        return keys
    lists = [key for key, node in root.value.items() if isinstance(node.value, list)]
    named = [key for key in lists if keys[0] in map(_item_name, root.value[key].value)]
    return [named[0], *keys] if len(named) == 1 else keys


def _value(text: str, source: str) -> Node:
    node, faults = read_tree(text)
    if faults:
        raise FaultyValueError(faults)
    return _marked(node or Node(None, 1), source)


def _marked(node: Node, source: str) -> Node:
    value = node.value
    if isinstance(value, dict):
        value = {key: _marked(child, source) for key, child in value.items()}
    elif isinstance(value, list):
        value = [_marked(child, source) for child in value]
    return replace(node, value=value, source=source)


def _replaced(node: Node, path: list[str], new: Node, above: tuple[str | int, ...]) -> Node:
    """Return `node` with the value at `path` replaced; nodes are shared, so those on the way are copied."""
    if isinstance(node.value, dict):
        key, rest = _longest_key(node, path)
        child = node.value.get(key)
        if rest:
            child = Node({}, node.line, source=new.source) if child is None or child.value is None else child
            changed = _replaced(child, rest, new, (*above, key))
        else:
            changed = new
        lines = {**node.key_lines, key: node.key_lines.get(key, node.line)}
        return replace(node, value={**node.value, key: changed}, key_lines=lines)
    if isinstance(node.value, list):
        i = _item_index(node, path[0], above)
        items = list(node.value)
        items[i] = _replaced(items[i], path[1:], new, (*above, i)) if path[1:] else new
        return replace(node, value=items)
    raise faulty(f"{dotted(above) or 'the spec'} is one value; it has no key '{path[0]}'")


def _longest_key(node: Node, path: list[str]) -> tuple[str, list[str]]:
    # A key may itself hold dots, as a clip's name does: the longest one that is there is meant.
    for n in range(len(path), 0, -1):
        key = ".".join(path[:n])
        if key in node.value:
            return key, path[n:]
    return path[0], path[1:]


def _item_index(node: Node, name: str, above: tuple[str | int, ...]) -> int:
    names = [_item_name(item) for item in node.value]
    if name in names:
        return names.index(name)
    # The length bound keeps int() away from thousands of digits.
    if name.isascii() and name.isdigit() and len(name) < 10 and int(name) < len(names):
        return int(name)
    here = dotted(above)
    if not names:
        raise faulty(f"no item '{name}': {here} is empty")
    given = [item for item in names if item]
    indices = "the one item is 0" if len(names) == 1 else f"the items are 0 to {len(names) - 1}"
    valid = f"{indices}; by name: {listed(given)}" if given else indices
    raise faulty(f"no item '{name}' in {here}; {did_you_mean(name, given, otherwise='')} {valid}".replace("  ", " "))


def _item_name(item: Node) -> str:
    """Return the name an item gives itself, else its effector's, which is its default name."""
    for key in ("name", "effector", "joint", "end_site"):
        child = item.child(key)
        if child is not None and isinstance(child.value, str):
            return child.value
        if key == "effector" and child is not None:
            return _item_name(child)
    return ""
