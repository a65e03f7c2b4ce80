"""Many clips and long ones: time and peak memory of processes.

What takes less than a minute stands in the table of `make bench`; `make bench-scale` runs this file for the rest and
writes results-scale.md.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.clock import Row, best_of, cells, duration, longer, peak_of, process
from benchmarks.results import machine, table
from data.generator.golf import make_swing
from data.generator.players import random_swings
from motionedit.core.bvh import new_bytes, read_clip
from studies.lab import print_table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
CONFIGS = ROOT / "configs"
PROGRAM = Path(sys.executable).parent / "motionedit"
WALK = ROOT / "data" / "walk.bvh"
MEGABYTE = 1e6
# A long take, and the longest that anyone has asked for.
LONG, LONGEST = 5_945, 150_000
LEAST_RATE = 6_000.0
MOST_TIMES_FILE = 4.0
MOST_MEMORY = 1e9
MANY = 1_000
# So many more clips take no more than this many times the memory.
MORE, MOST_GROWTH = 10, 1.1
# What motionedit/dataclass.py saves is measured beside it.
_WITH_PLAIN_DATACLASSES = """\
import dataclasses, motionedit.dataclass
motionedit.dataclass.dataclass = dataclasses.dataclass
from motionedit.cli import main
main()
"""


def edits(folder: Path) -> list[Row]:
    """Return the rows of edit-prioritized as a process, file to file, on one core."""
    long = tiled(folder / "long.bvh", LONG)
    edit = _edit(WALK, folder)
    runs = {
        "short": process(edit, folder),
        "plain": process((sys.executable, "-c", _WITH_PLAIN_DATACLASSES, *edit[1:]), folder),
        "libraries": process((sys.executable, "-c", "import numpy, click, yaml"), folder),
    }
    for run in runs.values():  # compiled modules are written, files are in memory
        run()
    best = best_of(runs, rounds=8)
    best |= best_of({"long": process(_edit(long, folder), folder)}, rounds=2)
    than = "import numpy, click, yaml"
    rate = LONG / best["long"]
    return [
        longer(
            "edit-prioritized, reach.yaml, 145 frames, a process", best["short"], best["libraries"], aim=2.0, than=than
        ),
        Row(
            "the same with the library's frozen dataclasses",
            duration(best["plain"]),
            f"{duration(best['short'])} with our own",
            f"{best['plain'] / best['short']:.2f} x",
        ),
        Row(
            f"edit-prioritized, reach.yaml, {LONG:,} frames, a process",
            f"{rate:,.0f} frames/s",
            duration(best["long"]),
            "",
            f">= {LEAST_RATE:,.0f} frames/s",
            "met" if rate >= LEAST_RATE else "MISSED",
        ),
    ]


def fits(counts: Sequence[tuple[int, str, int | None]]) -> list[Row]:
    """Return the rows of fits of so many motions of 12,276 values: (motions, gram or streaming, components).

    Times are the processor's, which other programs disturb less: nothing is run twice.
    """
    found = []
    for count, how, components in counts:
        more = () if components is None else (str(components),)
        command = (sys.executable, HERE / "fit_at_scale.py", str(count), how, *more)
        done = subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True)
        found.append(_fit_row(count, how, json.loads(done.stdout)))
    return found


def _fit_row(count: int, how: str, told: dict[str, Any]) -> Row:
    passes = "" if told["passes"] is None else f", {told['passes']} passes, residual {told['residual']:.0e}"
    matrix = count * 12_276 * 8
    most = MOST_MEMORY if how == "streaming" else 4.0 * matrix
    return Row(
        f"fit of {count:,} motions of 12,276 values, {how}, {told['components']} components{passes}",
        f"{duration(told['fit'])}, peak {told['peak'] / MEGABYTE:.0f} MB",
        f"{duration(told['making'])} to make them; the matrix takes {matrix / MEGABYTE:.0f} MB",
        f"{told['peak'] / matrix:.2f} x matrix",
        f"<= {most / MEGABYTE:.0f} MB",
        "met" if told["peak"] <= most else "MISSED",
    )


def chain(folder: Path) -> list[Row]:
    """Return the rows of normalize and fit-pca of 1,000 golf swings, as processes on one core, beside reading them."""
    source, normalized, model = folder / "many", folder / "many-normalized", folder / "many.npz"
    source.mkdir()
    for n, swing in enumerate(random_swings(np.random.default_rng(11), MANY)):
        (source / f"swing{n:04d}.bvh").write_bytes(new_bytes(make_swing(swing)))
    clips = sorted(source.iterdir())
    spec = CONFIGS / "golf-normalize.yaml"
    runs = {
        "normalize": process((PROGRAM, "normalize", source, "-s", spec, "-o", normalized), folder),
        "fit": process((PROGRAM, "fit-pca", normalized, "-o", model), folder),
        "read": lambda: [read_clip(clip) for clip in clips],
    }
    best = best_of(runs, rounds=1)
    seconds, peak = peak_of((PROGRAM, "fit-pca", normalized, "-o", model), folder)
    best["fit"] = min(best["fit"], seconds)
    both = best["normalize"] + best["fit"]
    reading = f"{duration(best['read'])} to read them"
    return [
        Row(f"normalize, {MANY:,} clips, a process", *_share(best["normalize"], reading, best["read"])),
        Row(f"fit-pca, {MANY:,} clips, all of rank, a process", *_share(best["fit"], reading, best["read"])),
        Row(f"normalize + fit-pca, {MANY:,} clips", *_share(both, reading, best["read"])),
        Row(f"fit-pca, {MANY:,} clips, peak memory", f"{peak / MEGABYTE:.0f} MB"),
    ]


def _share(seconds: float, reading: str, read: float) -> tuple[str, str, str]:
    return f"{duration(seconds)}, {MANY / seconds:.0f} clips/s", reading, f"{seconds / read:.1f} x"


def longest(folder: Path) -> list[Row]:
    """Return the rows of the memory that edits of the longest clip take."""
    path = tiled(folder / "longest.bvh", LONGEST)
    size, rows = path.stat().st_size, []
    # Feet that stand are found before the edit; constraints that end one after the other are solved one by one.
    for spec, most in (("reach", MOST_TIMES_FILE), ("footplants", None), ("stairs", None)):
        seconds, peak = peak_of(_edit(path, folder, spec), folder)
        aim = () if most is None else (f"<= {most:g} x", "met" if peak <= most * size else "MISSED")
        rows.append(
            Row(
                f"edit-prioritized, {spec}.yaml, {LONGEST:,} frames, {size / MEGABYTE:.0f} MB, peak memory",
                f"{peak / MEGABYTE:.0f} MB, {duration(seconds)}",
                "its file",
                f"{peak / size:.2f} x",
                *aim,
            )
        )
    return rows


def flat(folder: Path) -> list[Row]:
    """Return the row of the memory of an edit of many clips, beside a tenth of them."""
    peaks = []
    for count in (MANY // MORE, MANY):
        clips = folder / f"walks{count}"
        clips.mkdir()
        for n in range(count):
            shutil.copyfile(WALK, clips / f"walk{n:04d}.bvh")
        command = PROGRAM, "edit-prioritized", clips, "-s", CONFIGS / "reach.yaml", "-o", folder / f"edited{count}"
        peaks.append(peak_of((*command, "-j", "1", "-q"), folder)[1])
    few, many = peaks
    return [
        Row(
            f"edit-prioritized, reach.yaml, {MANY:,} clips, peak memory",
            f"{many / MEGABYTE:.0f} MB",
            f"{few / MEGABYTE:.0f} MB of {MANY // MORE}",
            f"{many / few:.2f} x",
            f"<= {MOST_GROWTH:g} x",
            "met" if many <= MOST_GROWTH * few else "MISSED",
        )
    ]


def _edit(clip: Path, folder: Path, spec: str = "reach") -> tuple[str | Path, ...]:
    return PROGRAM, "edit-prioritized", clip, "-s", CONFIGS / f"{spec}.yaml", "-o", folder / "edited.bvh", "-j", "1"


def tiled(path: Path, frames: int, clip: Path = WALK) -> Path:
    """Write a walk there and back as often as it takes, so that the tiles meet."""
    motion = read_clip(clip).motion
    there_and_back = np.concatenate((np.arange(len(motion)), np.arange(len(motion) - 2, 0, -1)))
    at = there_and_back[np.arange(frames) % len(there_and_back)]
    path.write_bytes(new_bytes(motion.at(at)))
    return path


def main() -> None:
    """Measure what takes longer than `make bench` may, print the table and write it."""
    page = [
        "# Scale\n\nWritten by `make bench-scale`: processes on one core, their time and their peak memory.\n",
        machine(),
    ]
    print(machine())
    with tempfile.TemporaryDirectory() as scratch:
        parts: list[tuple[str, Callable[[], list[Row]]]] = [
            ("Many motions, made in memory", lambda: fits([(10_000, "streaming", 20), (1_000, "gram", None)])),
            ("Many clips", lambda: chain(Path(scratch))),
            ("The same, as many components as without a number", lambda: fits([(10_000, "streaming", None)])),
            ("A long clip", lambda: longest(Path(scratch))),
            ("A large folder", lambda: flat(Path(scratch))),
        ]
        for title, measure in parts:
            rows = cells(measure())
            print_table(title, rows)
            # What was measured stands, should the rest be stopped.
            page.append(table(title, rows))
            (HERE / "results-scale.md").write_text("\n".join(page) + "\n")


if __name__ == "__main__":
    main()
