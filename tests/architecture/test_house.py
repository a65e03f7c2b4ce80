"""The laws of the house: no circles, two papers that do not know each other, kinds that nobody asks for by name."""

import ast
import re
from dataclasses import fields
from pathlib import Path

import pytest
from import_graph import arrows, circles, sources_of

import motionedit
from motionedit.core.priorities.kinds import KINDS
from motionedit.spec.constraint_types import TYPES

PACKAGE = Path(motionedit.__file__).parent
ROOT = PACKAGE.parent
FILES = sorted(PACKAGE.rglob("*.py"))
PRIORITIES = PACKAGE / "core" / "priorities"
# The two rooms that may know what a kind is called: its file, and its model in the spec.
KNOW_KINDS = ("core/priorities/kinds/", "spec/constraint_types.py")


def place_of(path):
    return path.relative_to(PACKAGE).as_posix()


GRAPH = arrows(sources_of(FILES, ROOT))


def test_no_modules_import_each_other_in_a_circle():
    assert circles(GRAPH) == []


def test_the_two_papers_do_not_know_each_other():
    for one, other in (("coefficients", "priorities"), ("priorities", "coefficients"), ("priorities", "pca")):
        room, stranger = f"motionedit.core.{one}", f"motionedit.core.{other}"
        for name in (name for name in GRAPH if name.startswith(room)):
            assert not [each for each in GRAPH[name] if each.startswith(stranger)], name


def room_of(module, floor):
    """Return the room of a module on a floor: a folder in there, or that itself."""
    inside = ".".join(module.split(".")[: floor.count(".") + 2])
    return inside if any(name.startswith(f"{inside}.") for name in GRAPH) else inside.rpartition(".")[0]


def rooms_of(floor):
    """Return the rooms of a floor, and which others each imports."""
    rooms = {}
    for name in (name for name in GRAPH if name.startswith(f"{floor}.")):
        others = {room_of(each, floor) for each in GRAPH[name] if each.startswith(f"{floor}.")}
        rooms.setdefault(room_of(name, floor), set()).update(others - {room_of(name, floor)})
    return rooms


@pytest.mark.parametrize("floor", ["motionedit.core", "motionedit.jobs"])
def test_the_rooms_of_a_floor_do_not_import_each_other_in_a_circle(floor):
    rooms = rooms_of(floor)
    assert len(rooms) > 5
    assert circles(rooms) == []


def test_the_edit_by_priorities_has_its_rooms_in_one_order():
    """What stands beside them is in the middle: it uses some, and is used by others."""
    floor = "motionedit.core.priorities"
    rooms = {room: others - {floor} for room, others in rooms_of(floor).items() if room != floor}
    assert {room.rpartition(".")[2] for room in rooms} == {"solver", "trajectories", "kinds", "continuity"}
    assert circles(rooms) == []
    assert not any(f"{floor}.continuity" in others for others in rooms.values())


def test_the_compiled_part_is_reached_from_one_file():
    reach = [place_of(path) for path in FILES if re.search(r"\b_compiled\b", path.read_text(encoding="utf-8"))]
    assert reach == ["core/compiled.py"]


def test_the_environment_is_asked_for_in_two_files_and_changes_no_result():
    ask = [
        place_of(path)
        for path in FILES
        if re.search(r"\b(?:environ|getenv|unless_set)\b", path.read_text(encoding="utf-8"))
    ]
    assert ask == ["cli/program.py", "core/compiled.py"]


def test_a_kind_of_constraint_is_one_file_one_model_and_a_line_in_the_registry():
    assert list(KINDS) == list(TYPES)
    files = {path.stem for path in (PRIORITIES / "kinds").glob("*.py")} - {"__init__", "constraint", "effector"}
    assert {kind.__module__.rpartition(".")[2] for kind in KINDS.values()} == files


@pytest.mark.parametrize("name", list(KINDS))
def test_what_a_kinds_model_has_of_its_own_is_what_its_constraint_takes(name):
    model, kind = TYPES[name], KINDS[name]
    keys = {kind.called.get(key.name, key.name) for key in model.model_keys.values()}
    takes = {field.name for field in fields(kind)} - {"measure", "since", "yields", "goals"}
    # What is common to all, what becomes the measure, where the clip begins, and what yields is resolved for all alike;
    # where feet stand is found later.
    assert takes - keys == set()
    assert keys - takes <= {"type", "tolerance", *model.measure_keys}


def branches_on_kinds(tree):
    """Yield the lines that ask whether something is of a kind: comparisons with names, matches, types."""
    classes = {kind.__name__ for kind in KINDS.values()}
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare | ast.Match | ast.Subscript):
            told = {each.value for each in ast.walk(node) if isinstance(each, ast.Constant)} & KINDS.keys()
            asks = {each.attr for each in ast.walk(node) if isinstance(each, ast.Attribute)} & {"kind", "type"}
            if told and asks:
                yield node.lineno
        called = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id
        if called == "isinstance" and {each.id for each in ast.walk(node) if isinstance(each, ast.Name)} & classes:
            yield node.lineno


@pytest.mark.parametrize("path", FILES, ids=place_of)
def test_nothing_outside_asks_for_a_kind(path):
    if not place_of(path).startswith(KNOW_KINDS):
        text = path.read_text(encoding="utf-8")
        assert list(branches_on_kinds(ast.parse(text))) == []
        kinds = re.findall(r"from motionedit\.core\.priorities\.kinds(\S*) import (.*)", text)
        assert all(module == ".constraint" or names == "KINDS" for module, names in kinds)


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.js")), ids=place_of)
def test_no_page_asks_for_a_kind(path):
    assert not re.findall(r"\bkind\s*(?:[=!]==|\))", path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", sorted((PRIORITIES / "solver" / "csrc").glob("*.[ch]")), ids=lambda path: path.name)
def test_the_compiled_part_knows_kinds_by_their_table_alone(path):
    text = path.read_text(encoding="utf-8")
    assert not re.findall(r"->kind\s*[=!<>]=|switch\s*\([^)]*kind", text)


def test_these_laws_are_broken_by_what_breaks_them():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == ["a", "b", "c", "d"]
    broken = [
        'if each.constraint.kind == "com": pass',
        'match constraint.type:\n    case "aim": pass',
        'if c.kind in {"position", "pose"}: pass',
        "isinstance(each, Posture)",
    ]
    assert [len(list(branches_on_kinds(ast.parse(text)))) for text in broken] == [1] * len(broken)
