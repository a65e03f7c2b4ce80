"""What pages refer to exists, and what they tell a reader to type runs."""

import ast
import re
import shlex

import click
import pytest
import sessions

from motionedit.cli import main as program

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
PLACE = re.compile(r"`((?:motionedit|tests|studies)/\S+\.py)::(\w+)`")
FILE = re.compile(r"`((?:motionedit|tests|configs|docs|data|benchmarks|studies)/(?!.*/v\d`)[\w./-]+)`")


def text_of(page):
    return page.read_text(encoding="utf-8")


def prose_of(page):
    return BLOCK.sub("", text_of(page))


def blocks(page, language):
    return [content for name, content in BLOCK.findall(text_of(page)) if name == language]


def anchors(page):
    headings = re.findall(r"^#+ (.*)$", prose_of(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


def test_links_lead_somewhere(page):
    for target in LINK.findall(prose_of(page)):
        if target.startswith("https://"):
            continue
        name, _, anchor = target.partition("#")
        other = (page.parent / name).resolve() if name else page
        assert other.exists(), target
        assert not anchor or anchor in anchors(other), target


def test_files_that_are_named_exist(page, root):
    for name in FILE.findall(prose_of(page)):
        assert (root / name).exists(), name


def test_functions_and_tests_that_are_named_exist(page, root):
    for name, thing in PLACE.findall(prose_of(page)):
        tree = ast.parse((root / name).read_text(encoding="utf-8"))
        assert thing in {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}, f"{name}::{thing}"


def equation_rows(root, paper):
    page = text_of(root / "docs" / "equations.md")
    section = page.partition(f"## [{paper}]\n")[2].partition("\n## ")[0]
    return [line for line in section.splitlines() if line.startswith("| ") and not line.startswith("| equation")]


@pytest.mark.parametrize(("paper", "last"), [("PC", 14), ("PRIO", 4)])
def test_every_equation_of_the_papers_has_a_row_with_a_function_and_a_test(root, paper, last):
    rows = equation_rows(root, paper)
    numbers = {int(n) for line in rows for n in re.findall(r"\((\d+)\)", line.split("|")[1])}
    assert numbers == set(range(1, last + 1))
    for line in rows:
        function, test = (PLACE.findall(cell) for cell in line.split("|")[3:5])
        assert len(function) == len(test) == 1, line
        assert not function[0][0].startswith("tests/"), line
        assert test[0][0].startswith("tests/"), line
        assert test[0][1].startswith("test_"), line


def test_every_symbol_is_in_the_code(root):
    table = text_of(root / "docs" / "equations.md").partition("## Symbols\n")[2]
    code = "\n".join(path.read_text(encoding="utf-8") for path in (root / "motionedit").rglob("*.py"))
    for line in table.splitlines():
        for name in re.findall(r"`([A-Za-z_.]+)", line):
            assert all(re.search(rf"\b{part}\b", code) for part in name.split(".")), name


def test_targets_of_make_that_are_named_exist(page, root):
    targets = set(re.findall(r"^([a-z-]+):.*## ", (root / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    typed = "\n".join(blocks(page, "sh"))
    named = re.findall(r"`make ([a-z-]+)`", prose_of(page)) + re.findall(r"^make ([a-z-]+)", typed, re.MULTILINE)
    assert set(named) <= targets


def command_lines(page):
    """Yield the command lines that are not run: those of shell blocks, and those in the text that name files."""
    for block in blocks(page, "sh"):
        yield from (line for line in block.splitlines() if re.match(r"(\.venv/bin/)?motionedit ", line))
    for inline in re.findall(r"`(motionedit [^`]*)`", prose_of(page)):
        if not re.search(r"\b[A-Z]{2}", inline):
            yield inline.replace("\n", " ")


def test_command_lines_have_commands_and_options_that_exist(page):
    for line in command_lines(page):
        _, *arguments = shlex.split(line.partition(" > ")[0])
        if not arguments or arguments[0].startswith("-"):
            continue
        command = program.get_command(click.Context(program), arguments[0])
        assert command is not None, line
        # Files are not looked for; what is no option of the command is an error all the same.
        command.make_context(arguments[0], list(arguments[1:]), resilient_parsing=True)


def test_examples_in_python_run(page, root, tmp_path, monkeypatch):
    examples = blocks(page, "python")
    if not examples:
        pytest.skip("no example in Python")
    monkeypatch.chdir(sessions.working_copy(root, tmp_path))
    for example in examples:
        exec(compile(example, str(page), "exec"), {})  # noqa: S102


def test_the_example_below_the_face_turns_the_head_and_nothing_else(root, tmp_path, monkeypatch):
    monkeypatch.chdir(sessions.working_copy(root, tmp_path))
    example = blocks(root / "docs" / "library.md", "python")[-1]
    exec(compile(example, "library.md", "exec"), {})  # noqa: S102
    code, lines = sessions.run("motionedit diff data/walk.bvh walk-looking-left.bvh", tmp_path)
    assert code == 3
    assert "turned by 10 degrees" in lines[0]
    assert "joint Head (" in lines[0]


def test_pictures_are_small(root):
    pictures = [path for path in (root / "docs" / "images").iterdir() if path.is_file()]
    assert pictures
    assert all(path.stat().st_size < 300_000 for path in pictures)


def test_every_page_is_named_in_the_readme(root):
    readme = text_of(root / "README.md")
    for page in (root / "docs").glob("*.md"):
        assert f"(docs/{page.name})" in readme, page.name


def test_lines_of_prose_are_not_too_long(page):
    if page.name in ("cli.md", "spec.md"):
        pytest.skip("generated")
    long = [line for line in prose_of(page).splitlines() if len(line) > 130 and not line.startswith("|")]
    assert long == []
