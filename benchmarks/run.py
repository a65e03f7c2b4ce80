"""Measure speed, as ratios inside one run, print the table and write it to results.md beside this file.

Run it with `make bench`. What is measured and what it is measured against take turns, and the best of each counts.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import batches, bvh_files, folders, pc_edit, prioritized, scale
from benchmarks.clock import cells
from benchmarks.results import machine, table
from studies.lab import print_table

RESULTS = Path(__file__).with_name("results.md")
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
            ("Folders of short clips", folders.rows(Path(scratch))),
            (
                "Many motions, made in memory",
                scale.fits([(1_000, "gram", None), (1_000, "gram", 20), (1_000, "streaming", 20)]),
            ),
        ]
    print(machine())
    tables = [(title, cells(rows)) for title, rows in parts]
    for title, rows in tables:
        print_table(title, rows)
    RESULTS.write_text("\n".join([INTRODUCTION, machine(), *(table(title, rows) for title, rows in tables)]) + "\n")


if __name__ == "__main__":
    main()
