"""What is written on one system is read on another: text has its encoding, and what only some systems have its twin."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = sorted((ROOT / "motionedit").rglob("*.py"))
SCRIPTS = [*sorted((ROOT / ".ci").glob("*.py")), *sorted((ROOT / "docs").glob("*.py"))]
# Modules that Windows lacks.
POSIX_ONLY = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"}
TEXT_CALLS = {"open": 1, "read_text": 0, "write_text": 1}


def text_without_encoding(tree):
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", None))
        if name not in TEXT_CALLS or any(word.arg == "encoding" for word in node.keywords):
            continue
        given = [word.value for word in node.keywords if word.arg == "mode"] + node.args
        binary = name == "open" and any("b" in str(getattr(one, "value", "")) for one in given)
        if not binary and len(node.args) <= TEXT_CALLS[name]:
            yield node.lineno


def test_the_search_sees_text_without_an_encoding():
    found = ast.parse("a.read_text()\nopen(x)\na.open('w')\na.write_text('b')")
    assert list(text_without_encoding(found)) == [1, 2, 3, 4]
    fine = ast.parse("a.read_text('utf-8')\nopen(x, 'rb')\na.open('xb')\na.write_text('b', encoding='utf-8')")
    assert list(text_without_encoding(fine)) == []


@pytest.mark.parametrize("path", [*PROGRAM, *SCRIPTS], ids=lambda path: path.relative_to(ROOT).as_posix())
def test_text_is_read_and_written_with_its_encoding(path):
    assert list(text_without_encoding(ast.parse(path.read_text(encoding="utf-8")))) == []


def imported_without_a_try(tree):
    guarded = {id(inner) for node in ast.walk(tree) if isinstance(node, ast.Try) for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import) and id(node) not in guarded:
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and id(node) not in guarded:
            yield node.module


def test_modules_that_windows_lacks_are_only_tried():
    for path in PROGRAM:
        names = set(imported_without_a_try(ast.parse(path.read_text(encoding="utf-8"))))
        assert not names & POSIX_ONLY, path
