"""Put small faults into a file, one at a time, and report those that no test notices.

Usage: python .ci/mutants.py FILE[:A-B] ... [--most N] [--seconds S] [--jobs J] [--tests PATH ...]

A FILE is one of motionedit/, or some lines of it; all are Python, or all are C. Of the faults of each
(.ci/mutations.py) N are tried, evenly spread. For each those tests run that go through its line, the nearest and
quickest first, S seconds of them at the most; of a C file any, on a build of its own. The working tree is not touched:
all this happens in copies of it.

What survives is a place to look at, not a verdict: some faults change nothing, and others only a speed.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from queue import SimpleQueue

from mutations import Mutation, mutations_of

ROOT = Path(__file__).resolve().parents[1]
ROOMS = [
    "tests/unit",
    "tests/properties",
    "tests/jacobians",
    "tests/spec",
    "tests/bvh_files",
    "tests/library",
    "tests/cli",
]
C_ROOMS = [
    "tests/properties/test_compiled_text.py",
    *(
        f"tests/unit/core/priorities/{test}.py"
        for test in (
            "solver/test_compiled",
            "solver/test_compiled_one_sided",
            "solver/test_compiled_postures",
            "continuity/test_compiled_smoothing",
            "solver/test_compiled_buffers",
            "solver/test_few_channels",
        )
    ),
]
PATIENCE = 60.0  # seconds; a fault whose tests take longer counts as one that hangs


@dataclass(frozen=True)
class Suite:
    """Seconds of each test that passes, and in which copy coverage says which lines each goes through (None: any)."""

    seconds: dict[str, float]
    traced: Path | None

    def tests(self, file: str, line: int, most: float) -> list[str]:
        """Return the tests to run for a line of a file, the nearest and quickest first, `most` seconds of them."""
        names = self.seconds.keys()
        if self.traced is not None:
            through = tests_through(self.traced / ".coverage", self.traced / file)
            # A constant's line is run on import, before all tests: those of the whole file may notice.
            names &= (through.get(line, set()) - {""}) or set().union(*through.values())
        chosen: list[str] = []
        for name in sorted(names, key=lambda name: (-nearness(name, file), self.seconds[name], name)):
            most -= self.seconds[name]
            if chosen and most < 0.0:
                break
            chosen.append(name)
        return chosen


def nearness(test: str, file: str) -> int:
    """Return how many words of a file's path are in that of a test: `tests/unit` mirrors the package."""
    words = set(re.split(r"[/_.]", file)) - {"motionedit", "py"}
    return len(words & set(re.split(r"[/_.]", test.partition("::")[0])))


def main() -> int:
    """Print the report."""
    asked = arguments()
    with tempfile.TemporaryDirectory(prefix="motionedit-mutants-") as scratch:
        copies = [copied(Path(scratch) / str(k), c=asked.c) for k in range(asked.jobs)]
        suite = suite_of(copies[0], asked.tests, asked.jobs, c=asked.c)
        for file in asked.files:
            name, _, lines = file.partition(":")
            text = (ROOT / name).read_bytes()
            found = chosen(mutations_of(text, name=name), lines or "1-1000000", asked.most)
            tests = [suite.tests(name, each.line, asked.seconds) for each in found]
            fates = all_tried(copies, name, [each.applied(text) for each in found], tests)
            print(*report(name, text, found, fates), sep="\n", flush=True)
    return 0


def arguments() -> argparse.Namespace:
    """Return what is asked for on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--most", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--tests", nargs="+")
    asked = parser.parse_args()
    asked.c = not asked.files[0].partition(":")[0].endswith(".py")
    asked.tests = asked.tests or (C_ROOMS if asked.c else ROOMS)
    return asked


def all_tried(copies: list[Path], file: str, texts: list[bytes], tests: list[list[str]]) -> list[str]:
    """Return the fate of each text of a file, as many at a time as there are copies of the tree."""
    free: SimpleQueue[Path] = SimpleQueue()
    for copy in copies:
        free.put(copy)

    def tried(text: bytes, tests: list[str]) -> str:
        copy = free.get()
        try:
            return fate(copy, file, text, tests)
        finally:
            free.put(copy)

    with ThreadPoolExecutor(len(copies)) as pool:
        return list(pool.map(tried, texts, tests))


def chosen(mutations: list[Mutation], lines: str, most: int) -> list[Mutation]:
    """Return those on some lines, at most so many, evenly spread."""
    first, _, last = lines.partition("-")
    inside = [each for each in mutations if int(first) <= each.line <= int(last or first)]
    return [inside[i * len(inside) // most] for i in range(most)] if len(inside) > most else inside


def copied(folder: Path, *, c: bool) -> Path:
    """Return a copy of the working tree, for C with a build of its own."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, check=True
    )
    built = [path.relative_to(ROOT).as_posix() for path in (ROOT / "motionedit" / "core").glob("_compiled*")]
    for name in [*listed.stdout.decode().split("\0"), *built]:
        if name and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, folder / name)
    if c and not build(folder):
        raise SystemExit("mutants: error: gcc does not build the compiled part")
    return folder


def build(folder: Path) -> bool:
    """Build the compiled part of a copy, quickly; return whether it could be built."""
    told = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["ext-modules"][
        0
    ]
    target = folder / "motionedit" / "core" / "_compiled.abi3.so"
    for old in target.parent.glob("_compiled*"):
        old.unlink()
    options = ["-shared", "-fPIC", "-std=c11", "-O2", "-w", "-ffp-contract=off", f"-I{sysconfig.get_path('include')}"]
    return (
        subprocess.run(
            ["gcc", *options, *told["sources"], "-o", target], cwd=folder, capture_output=True, check=False
        ).returncode
        == 0
    )


def pytest_in(folder: Path, *options: str, patience: float | None = None) -> int | None:
    """Run pytest in a copy and return how it ended; None where it took too long."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow", *options]
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        return process.wait(patience)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.wait()
        return None


def suite_of(folder: Path, rooms: list[str], jobs: int, *, c: bool) -> Suite:
    """Return what the tests of some rooms take, and where each of them goes."""
    traced = [] if c else ["--cov=motionedit", "--cov-context=test", "--cov-report="]
    pytest_in(folder, "-n", str(jobs), *traced, "--junitxml=times.xml", "-o", "junit_family=xunit1", *rooms)
    seconds = {
        f"{case.get('file')}::{case.get('name')}": float(case.get("time", 0.0))
        for case in ET.parse(folder / "times.xml").iter("testcase")  # noqa: S314  written a moment ago
        if case.find("failure") is None and case.find("error") is None and case.find("skipped") is None
    }
    return Suite(seconds, None if c else folder)


@cache
def tests_through(data: Path, file: Path) -> dict[int, set[str]]:
    """Return the tests that go through each line of a file, by coverage's record."""
    from coverage import CoverageData

    record = CoverageData(data)
    record.read()
    contexts = record.contexts_by_lineno(str(file))
    return {line: {name.rpartition("|")[0] for name in names} for line, names in contexts.items()}


def fate(folder: Path, file: str, text: bytes, tests: list[str]) -> str:
    """Return what becomes of a file with a fault: killed, hangs, survived, no test, not built."""
    if not tests:
        return "no test"
    original = (folder / file).read_bytes()
    (folder / file).write_bytes(text)
    try:
        if not file.endswith(".py") and not build(folder):
            return "not built"
        ended = pytest_in(folder, "-x", "-n", "0", *tests, patience=PATIENCE)
    finally:
        (folder / file).write_bytes(original)
    if ended is None:
        return "hangs"
    return "survived" if ended == 0 else "killed"


def report(file: str, text: bytes, found: list[Mutation], fates: list[str]) -> list[str]:
    """Return the lines of the report: what survived, where, and the counts."""
    lines = [
        f"{file}:{each.line}:{each.column(text)}: {ended}: {each.told(text)}"
        for each, ended in zip(found, fates, strict=True)
        if ended in {"survived", "no test"}
    ]
    counts = ", ".join(f"{fates.count(ended)} {ended}" for ended in sorted(set(fates)))
    return [*lines, f"{file}: {len(found)} faults: {counts}"]


if __name__ == "__main__":
    sys.exit(main())
