"""Console sessions in pages: commands are run, their outputs compared with what the page shows, and put right.

In a block that begins with ```console, a line after ``$ `` is a command and the lines below it are what it prints,
standard error too. A line ``...`` stands for lines left out. Numbers that differ by less than the last digits a machine
can be blamed for are the same, and so are the seconds of a table. The commands of a page run in one folder, in the
order of the page. Each must end with exit code 0, unless ``$ echo $?`` below it shows another one. A ```yaml block that
begins with ``# file: NAME`` is written to that name first.
"""

from __future__ import annotations

import os
import re
import shlex
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from click.testing import CliRunner

from motionedit.cli import main as program

if TYPE_CHECKING:
    from collections.abc import Iterator

FENCE = "```"
LEFT_OUT = "..."
# What two machines may differ in: rounding shows in the small errors that a solver leaves.
RELATIVE, ABSOLUTE = 0.02, 1e-3
_FILE = re.compile(r"^```yaml\n# file: (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_SECONDS = re.compile(r"\s+\d+\.\d\d$")


@dataclass
class Command:
    """A command of a page, the lines that the page shows below it, and the place of these lines in the page."""

    text: str
    start: int
    shown: list[str] = field(default_factory=list)

    @property
    def stop(self) -> int:
        """The line after the shown ones."""
        return self.start + len(self.shown)


def commands_of(page: str) -> list[Command]:
    """Return the commands of a page's console blocks."""
    commands: list[Command] = []
    inside = False
    for number, line in enumerate(page.splitlines()):
        if line.startswith(FENCE):
            inside = line == f"{FENCE}console"
        elif inside and line.startswith("$ "):
            commands.append(Command(line[2:], number + 1))
        elif inside:
            commands[-1].shown.append(line)
    return commands


def working_copy(root: Path, folder: Path) -> Path:
    """Return a folder from which the project's data and configs are seen under their own names."""
    for name in ("data", "configs"):
        (folder / name).symlink_to(root / name)
    return folder


def refreshed(page: str, folder: Path) -> str:
    """Return the page with the outputs of its commands, run in a folder; outputs that are the same stay as they are.

    Raises
    ------
    RuntimeError
        A command failed, and the page does not show its exit code.
    """
    for name, content in _FILE.findall(page):
        (folder / name).write_text(f"# file: {name}\n{content}", encoding="utf-8")
    lines = page.splitlines()
    for command, printed in reversed(list(_outputs(commands_of(page), folder))):
        if not same(command.shown, printed):
            lines[command.start : command.stop] = _cut(command.shown, printed)
    return "\n".join(lines) + "\n"


def _outputs(commands: list[Command], folder: Path) -> Iterator[tuple[Command, list[str]]]:
    code = 0
    asked = {c.start for c in commands if c.text == "echo $?"}
    for command in commands:
        if command.text == "echo $?":
            yield command, [str(code)]
            continue
        code, printed = run(command.text, folder)
        if code != 0 and command.stop + 1 not in asked:
            raise RuntimeError(f"exit code {code}: {command.text}\n" + "\n".join(printed))
        yield command, printed


def run(line: str, folder: Path) -> tuple[int, list[str]]:
    """Return the exit code of a command line, run in a folder, and the lines that it prints."""
    name, *arguments = shlex.split(line)
    if name == "cat":
        return 0, (folder / arguments[0]).read_text(encoding="utf-8").splitlines()
    if name != "motionedit":
        raise RuntimeError(f"pages show 'motionedit', 'cat' and 'echo $?', not: {line}")
    with _inside(folder):
        result = CliRunner().invoke(program, arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.output.splitlines()


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def same(shown: list[str], printed: list[str]) -> bool:
    """Return whether shown lines, with some left out, say what was printed."""
    cut = _cut(shown, printed)
    return len(cut) == len(shown) and all(map(_same_line, shown, cut))


def _cut(shown: list[str], printed: list[str]) -> list[str]:
    """Return the printed lines with as many left out as in the shown ones."""
    if LEFT_OUT not in shown:
        return printed
    head = shown.index(LEFT_OUT)
    tail = len(shown) - head - 1
    return [*printed[:head], LEFT_OUT, *printed[max(len(printed) - tail, head) :]]


def _same_line(a: str, b: str) -> bool:
    a, b = (_SECONDS.sub("", line).rstrip() for line in (a, b))
    if a == b:
        return True
    words_a, words_b = (_NUMBER.sub("#", line).split() for line in (a, b))
    numbers_a, numbers_b = (_NUMBER.findall(line) for line in (a, b))
    return words_a == words_b and all(map(_same_number, numbers_a, numbers_b))


def _same_number(a: str, b: str) -> bool:
    if a == b:
        return True
    if not {".", "e"} & {*a, *b}:
        return False
    return abs(float(a) - float(b)) <= ABSOLUTE + RELATIVE * abs(float(a))
