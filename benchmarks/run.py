"""Measure speed, as ratios inside one run, print the table and write it to results.md beside this file.

Run it with `make bench`. What is measured and what it is measured against take turns, and the best of each counts.
"""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]
# As the program itself does, and before numpy is loaded.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import batches  # noqa: E402
import bvh_files  # noqa: E402
import pc_edit  # noqa: E402
import prioritized  # noqa: E402
import scale  # noqa: E402
from clock import HEADINGS, Row  # noqa: E402
from lab import print_table  # noqa: E402

RESULTS = HERE / "results.md"
INTRODUCTION = """\
# Speed

Written by `make bench`. Times are the best of several rounds in which all that is compared takes a turn, so ratios
hold on other machines, times do not. One core, one BLAS thread. A process is measured from its start to its end, with
the libraries' imports (numpy, click, PyYAML) beside it.
"""


def main() -> None:
    """Measure, print and write every table."""
    with tempfile.TemporaryDirectory() as scratch:
        parts = [
            ("BVH files", bvh_files.rows(Path(scratch))),
            ("The edit by coefficients, data/golf/swing04.bvh", pc_edit.rows(Path(scratch))),
            ("The edit by prioritized constraints", prioritized.rows(Path(scratch))),
            ("The edit by prioritized constraints, file to file", scale.edits(Path(scratch))),
            ("Many clips, in one process", batches.rows(Path(scratch))),
            (
                "Many motions, made in memory",
                scale.fits([(1_000, "gram", None), (1_000, "gram", 20), (1_000, "streaming", 20)]),
            ),
        ]
    print(machine())
    for title, rows in parts:
        print_table(title, [HEADINGS, *(row.cells for row in rows)])
    RESULTS.write_text("\n".join([INTRODUCTION, machine(), *(table(title, rows) for title, rows in parts)]) + "\n")


def machine() -> str:
    """Return the machine in a line: cores, processor, versions."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    names = ", ".join(f"{name} {version(name)}" for name in ("numpy", "pydantic", "bvhio"))
    return f"{cores} cores, {_processor()}, Python {platform.python_version()}, {names}"


def _processor() -> str:
    described = Path("/proc/cpuinfo")
    lines = described.read_text().splitlines() if described.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def table(title: str, rows: list[Row]) -> str:
    """Return rows as a part of a page."""
    lines = [f"\n## {title}\n", f"| {' | '.join(HEADINGS)} |", "|---|---|---|---|---|---|"]
    return "\n".join([*lines, *(f"| {' | '.join(row.cells)} |" for row in rows)])


if __name__ == "__main__":
    main()
