"""Speed and accuracy have a room each: benchmarks may use studies, and nothing goes in a circle."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# What a room may import of the rooms around the package.
MAY_IMPORT = {
    "motionedit": set(),
    "data": {"data"},
    "studies": {"studies", "data"},
    "benchmarks": {"benchmarks", "studies", "data"},
}
FILES = [path for room in MAY_IMPORT for path in sorted((ROOT / room).rglob("*.py"))]


def module(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module(path) for path in FILES}


def imported(path):
    """Yield the modules of these rooms that a file imports as it is loaded."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    nodes = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in MODULES)
        else:
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            yield from names & MODULES or {node.module} & MODULES


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_a_room_imports_only_the_rooms_below_it(path):
    room = path.relative_to(ROOT).parts[0]
    rooms = {name.partition(".")[0] for name in imported(path)}
    assert rooms <= MAY_IMPORT[room] | {"motionedit"}


def test_no_imports_go_in_a_circle():
    tuple(TopologicalSorter({module(path): set(imported(path)) for path in FILES}).static_order())
