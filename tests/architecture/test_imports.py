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
    "click": ("cli/",),
    "yaml": ("spec/",),
    "pydantic": ("spec/",),
    "bvhio": ("core/bvh/",),
    "distributed": ("jobs/batch/pool.py",),
    "matplotlib": ("report/",),
    "scipy": (),
    "bvh": (),
    "pandas": (),
}
HEAVY = {"numpy", "scipy", "yaml", "pydantic", "bvhio", "matplotlib", "multiprocessing", "json", "difflib"}


def imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively: say where from"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_a_file_imports_only_what_its_room_may(path):
    place = path.relative_to(PACKAGE).as_posix()
    room = place.split("/")[0].removesuffix(".py")
    for name in imported(path):
        first, *rest = name.split(".")
        if first == "motionedit":
            assert rest[0] in MAY_IMPORT[room] | {"version"}, f"{place} imports {name}"
        elif first in HOMES:
            assert place.startswith(HOMES[first]), f"{place} imports {name}"


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
