"""What `make mutants` puts into files, which tests it runs for each fault, and what it reports."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / ".ci"))

from mutants import Suite, chosen, fate, report  # noqa: E402  .ci is no package
from mutations import mutations_of  # noqa: E402  the same

PYTHON = b'''"""A text with 3 < 4."""
from __future__ import annotations
def f(n: int = 2) -> "1":
    \xc3\xa4 = "1" if n < 3 and not n else -1.5
    print(f"{n + 1}")
    return \xc3\xa4
'''
C = b"""/* a < b */
#define SIZE 3
int f(int *a, int b) { return a->x + b * 2 - 0.5 < -1 && b; } // as "a + 1"
"""


def told(text, name):
    return [each.told(text) for each in mutations_of(text, name=name)]


def test_the_faults_of_a_python_file():
    assert told(PYTHON, "f.py") == [
        "2  ->  (3)",
        "n < 3  ->  (n <= 3)",
        "n < 3 and not n  ->  (n < 3 or not n)",
        "3  ->  (4)",
        "not n  ->  (n)",
        "-1.5  ->  (1.5)",
        "1.5  ->  (3.0)",
        'print(f"{n + 1}")  ->  pass',
    ]


def test_the_faults_of_a_c_file():
    assert told(C, "f.c") == [
        "+  ->  -",
        "*  ->  /",
        "2  ->  3",
        "-  ->  +",
        "0.5  ->  1.0",
        "<  ->  <=",
        "1  ->  2",
        "&&  ->  ||",
    ]


def test_each_fault_changes_one_place_and_leaves_a_program():
    for each in mutations_of(PYTHON, name="f.py"):
        changed = each.applied(PYTHON)
        assert changed != PYTHON
        assert changed.startswith(PYTHON[: each.start])
        ast.parse(changed)
        assert PYTHON.splitlines()[each.line - 1] not in changed.splitlines()


def test_so_many_are_chosen_evenly_and_on_the_lines_that_are_asked_for():
    found = mutations_of(PYTHON, name="f.py")
    assert chosen(found, "1-99", 100) == found
    assert chosen(found, "1-99", 4) == found[::2]
    assert [each.line for each in chosen(found, "5", 9)] == [5]


def test_the_nearest_and_quickest_tests_run_and_one_at_least():
    near, quick, slow = "tests/unit/core/body/test_up.py::a", "tests/cli/test_a.py::b", "tests/cli/test_a.py::c"
    suite = Suite({near: 2.0, quick: 1.0, slow: 3.0}, None)
    assert suite.tests("motionedit/core/body/up.py", 1, 3.5) == [near, quick]
    assert suite.tests("motionedit/core/body/up.py", 1, 0.1) == [near]
    assert suite.tests("motionedit/report/table.py", 1, 3.5) == [quick, near]


@pytest.mark.parametrize(
    ("fault", "expected"), [("x = 1", "survived"), ("x = 2", "killed"), ("while True: pass", "hangs")]
)
def test_a_fault_is_killed_by_a_test_that_fails_or_hangs(tmp_path, fault, expected, monkeypatch):
    if expected == "hangs":
        monkeypatch.setattr("mutants.PATIENCE", 4.0)
    (tmp_path / "a.py").write_text("x = 1\n")
    (tmp_path / "test_a.py").write_text("import a\ndef test_a(): assert a.x == 1\n")
    assert fate(tmp_path, "a.py", fault.encode(), ["test_a.py::test_a"]) == expected
    assert (tmp_path / "a.py").read_text() == "x = 1\n"
    assert fate(tmp_path, "a.py", b"", []) == "no test"


def test_the_report_names_what_survived():
    found = mutations_of(b"x = 1 + 2\n", name="a.py")
    assert report("a.py", b"x = 1 + 2\n", found, ["survived", "killed", "killed"]) == [
        "a.py:1:5: survived: 1  ->  (2)",
        "a.py: 3 faults: 2 killed, 1 survived",
    ]
