"""Speed and accuracy have a room each: benchmarks may use studies, and nothing goes in a circle."""

from pathlib import Path

import pytest
from import_graph import arrows, circles, sources_of

ROOT = Path(__file__).resolve().parents[2]
# What a room may import of the rooms around the package.
MAY_IMPORT = {
    "motionedit": set(),
    "data": {"data"},
    "studies": {"studies", "data"},
    "benchmarks": {"benchmarks", "studies", "data"},
}
FILES = [path for room in MAY_IMPORT for path in sorted((ROOT / room).rglob("*.py"))]
GRAPH = arrows(sources_of(FILES, ROOT))


@pytest.mark.parametrize("name", GRAPH)
def test_a_room_imports_only_the_rooms_below_it(name):
    rooms = {each.partition(".")[0] for each in GRAPH[name]}
    assert rooms <= MAY_IMPORT[name.partition(".")[0]] | {"motionedit"}


def test_no_imports_go_in_a_circle():
    assert circles(GRAPH) == []
