"""Imports go one way, and each outside package has one room."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import motionedit

PACKAGE = Path(motionedit.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))

# What a room may import of the others.
MAY_IMPORT = {
    "cli": {"cli", "jobs", "spec", "core", "report", "errors", "dataclass", "regular_files", "interrupts"},
    "library": {"library", "jobs", "spec", "core", "report", "errors", "dataclass", "regular_files", "interrupts"},
    "jobs": {"jobs", "spec", "core", "report", "errors", "dataclass", "regular_files", "interrupts"},
    "spec": {"spec", "errors", "dataclass", "regular_files", "interrupts"},
    "core": {"core", "errors", "dataclass", "regular_files", "interrupts"},
    "report": {"report", "errors", "dataclass", "regular_files", "interrupts"},
    "errors": set(),
    "dataclass": set(),
    "regular_files": set(),
    "interrupts": set(),
    "version": set(),
    "__init__": {"library", "core", "errors"},
    "__main__": {"cli", "interrupts"},
}
# The rooms (and files) in which an outside package may be imported.
HOMES = {
    "numpy": ("core/", "jobs/", "report/", "library/mean_clip.py"),
    "click": ("cli/",),
    "yaml": ("spec/",),
    "bvhio": ("core/bvh/",),
    "distributed": ("jobs/batch/cluster.py",),
    "matplotlib": ("report/",),
    "scipy": (),
    "bvh": (),
    "pandas": (),
}
# The files that import what a name says, so that it is found late: modules of their own rooms.
BY_NAME = {"__init__.py", "cli/program.py", "spec/__init__.py"}
HEAVY = {"numpy", "scipy", "yaml", "bvhio", "matplotlib", "multiprocessing", "json", "difflib"}


IMPORTERS = {"import_module", "__import__", "find_spec", "spec_from_file_location", "run_module", "run_path"}


def imported(text, place):
    """Yield the modules and names that a file imports, by statements and by calls."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{place} imports relatively: say where from"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and called(node.func) in IMPORTERS:
            name = node.args[0]
            if isinstance(name, ast.Constant):
                yield name.value
            else:
                assert place in BY_NAME, f"{place} imports by a name that is made"
                parts = getattr(name, "values", [])
                assert parts, f"{place} imports any module"
                own = isinstance(parts[0], ast.FormattedValue) and ast.unparse(parts[0].value) == "__name__"
                assert own or ast.unparse(parts[0]).startswith("'motionedit."), f"{place} imports others' modules"


def called(function):
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", None)


def assert_within_its_room(text, place):
    room = place.split("/")[0].removesuffix(".py")
    for name in imported(text, place):
        first, *rest = name.split(".")
        if first == "motionedit":
            assert rest[0] in MAY_IMPORT[room] | {"version"}, f"{place} imports {name}"
        elif first in HOMES:
            assert place.startswith(HOMES[first]), f"{place} imports {name}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_a_file_imports_only_what_its_room_may(path):
    assert_within_its_room(path.read_text(encoding="utf-8"), path.relative_to(PACKAGE).as_posix())


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ("core/measure.py", "from motionedit.jobs.clip.facts import ClipFacts"),
        ("core/measure.py", "import importlib\nimportlib.import_module('motionedit.jobs.clip.facts')"),
        ("core/measure.py", "from importlib import import_module\nimport_module('yaml')"),
        ("core/measure.py", "import yaml"),
        ("jobs/diff.py", "def later():\n    __import__('yaml')"),
        ("cli/info.py", "import numpy as np"),
        ("cli/info.py", "if TYPE_CHECKING:\n    from numpy.typing import NDArray"),
        ("spec/values.py", "from numpy import array"),
        ("errors.py", "import_module('numpy')"),
        ("jobs/diff.py", "import_module(name)"),
        ("cli/program.py", "import_module(f'{name}.x')"),
        ("cli/program.py", "import_module(name)"),
        ("core/euler.py", "from scipy.spatial.transform import Rotation"),
        ("core/euler.py", "from . import rotations"),
    ],
)
def test_an_import_of_what_belongs_elsewhere_is_seen(place, text):
    with pytest.raises(AssertionError):
        assert_within_its_room(text, place)


@pytest.mark.parametrize(
    "code",
    [
        "import motionedit, motionedit.errors, motionedit.cli",
        "import sys, motionedit.cli as c\ntry: c.main(['--help'])\nexcept SystemExit: pass",
    ],
    ids=["import", "help"],
)
def test_the_command_line_starts_without_loading_what_it_does_not_need(code):
    command = [sys.executable, "-c", f"{code}\nimport sys\nprint('LOADED', *sys.modules)"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    assert "motionedit.cli" in loaded
    assert not loaded & HEAVY


@pytest.mark.parametrize(("clip", "spec"), [("walk", "reach"), ("kick", "karate")])
def test_a_short_edit_loads_nothing_that_takes_longer_than_its_work(clip, spec, tmp_path):
    root = PACKAGE.parent
    paths = [root / "data" / f"{clip}.bvh", "-s", root / "configs" / f"{spec}.yaml", "-o", tmp_path / "e.bvh", "-q"]
    arguments = ["edit-prioritized", *map(str, paths)]
    code = f"import sys, motionedit.cli as c\ntry: c.main({arguments!r})\nexcept SystemExit: pass\n"
    code += "print('LOADED', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    assert "motionedit.core.priorities.edit" in loaded
    assert not loaded & {"scipy", "matplotlib", "bvhio", "multiprocessing", "numpy.ma", "numpy.fft"}
