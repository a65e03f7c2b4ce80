"""Measure this project beside others on the same jobs, print the tables and write them to peers.md.

Run it with `make bench-peers`. Each peer runs in a virtual environment of its own; one that could not be installed has
its place in the tables all the same.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.peers import blender, files, jobs, whole_body
from benchmarks.peers.tables import Table, page
from benchmarks.results import machine
from studies.lab import print_table

RESULTS = Path(__file__).resolve().parents[1] / "peers.md"


def main() -> None:
    """Measure, print and write every table."""
    whole = jobs.reach()
    parts: list[tuple[str, Table]] = []
    found: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        alone = jobs.reach_alone(whole)
        for title, job, ways in (
            (f"Whole-body inverse kinematics: the reaching clip, {len(whole.motion)} frames", whole, whole_body.WAYS),
            (f"The same, the {len(alone.motion)} frames of the reach alone", alone, whole_body.QUICK_WAYS),
        ):
            rows, versions = whole_body.speed(job, folder, ways)
            parts.append((title, rows))
            found |= versions
        parts += [
            (
                "Heel and toe of one foot, both hard, 0.1 mm apart from what the foot is",
                whole_body.conflict(jobs.contradicting(whole), folder),
            ),
            (
                f"A hand that cannot reach, after {jobs.FAR_ITERATIONS} iterations",
                whole_body.far(jobs.unreachable(whole), folder),
            ),
        ]
        for title, table in (("The reach as an edit of a file", blender.table), ("BVH files", files.table)):
            rows, versions = table(folder)
            parts.append((title, rows))
            found |= versions
    described = f"{machine()}. Peers: {'; '.join(found.values()) or 'none'}."
    print(described)
    for title, rows in parts:
        print_table(title, rows)
    RESULTS.write_text(page(described, parts), encoding="utf-8")


if __name__ == "__main__":
    main()
