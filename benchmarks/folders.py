"""Folders of short clips: clips a second and core, and what a second worker gains beside two busy loops.

A core's seconds are the processor's: what other programs take does not count.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.clock import Row, best_of, duration, process
from benchmarks.scale import tiled
from data.generator.golf import make_swing
from data.generator.players import random_swings
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.edit_prioritized import job as edit_prioritized
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

ROOT = Path(__file__).resolve().parents[1]
CONFIGS = ROOT / "configs"
WALK, SKATING = ROOT / "data" / "walk.bvh", ROOT / "data" / "walk-skating.bvh"
PROGRAM = Path(sys.executable).parent / "motionedit"
CLIPS = 20
# Of what two workers share: enough that a process alone takes three seconds or more, ten times what it takes to start
# and to end. A cheaper clip takes more of them.
EDITED, NORMALIZED, FITTED, BY_MODEL = 600, 3600, 1200, 200
# Clips of the model that edits by.
BASE = 100
LONG = 20_000
# Clips and frames a second and core.
LEAST_REACH, LEAST_STANDING, LEAST_FRAMES = 150.0, 60.0, 10_000.0
LEAST_GAIN = 0.9
_BUSY = "n = 0\nfor i in range(30_000_000): n += i"


def rows(folder: Path) -> list[Row]:
    """Return the table's rows on folders of short clips."""
    edits = [
        *_rate(WALK, "reach", folder, LEAST_REACH),
        *_rate(SKATING, "footplants", folder, LEAST_STANDING),
    ]
    return [*edits, _long(folder), *_gains(folder)]


def _rate(clip: Path, config: str, folder: Path, least: float) -> list[Row]:
    clips, again = _copies(clip, folder / config, CLIPS), _edit(config, folder)
    best = best_of(
        {"read": lambda: [read_clip(each) for each in clips], "edit": lambda: again(clips)},
        rounds=6,
        clock=time.process_time,
    )
    rate = CLIPS / best["edit"]
    return [
        Row(
            f"edit-prioritized, {config}.yaml, {CLIPS} clips of {len(read_clip(clip).motion)} frames, in a process",
            f"{rate:.0f} clips/s",
            f"{duration(best['read'])} to read them",
            f"{best['edit'] / best['read']:.1f} x",
            f">= {least:g} clips/s",
            "met" if rate >= least else "MISSED",
        )
    ]


def _long(folder: Path) -> Row:
    clip, again = tiled(folder / "standing.bvh", LONG, SKATING), _edit("footplants", folder)
    best = best_of({"edit": lambda: again([clip])}, rounds=2, clock=time.process_time)
    rate = LONG / best["edit"]
    return Row(
        f"edit-prioritized, footplants.yaml, {LONG:,} frames, in a process",
        f"{rate:,.0f} frames/s",
        duration(best["edit"]),
        "",
        f">= {LEAST_FRAMES:,.0f} frames/s",
        "met" if rate >= LEAST_FRAMES else "MISSED",
    )


def _edit(config: str, folder: Path) -> Callable[[Sequence[Path]], object]:
    """Return a function that edits clips into a new folder each time.

    To replace files a disk may wait for what was in them, and for a while it steps over what was removed.
    """
    spec, rounds = load_spec(CONFIGS / f"{config}.yaml", "edit-prioritized"), count()

    def run(clips: Sequence[Path]) -> object:
        return edit_prioritized.run(spec, clips, f"{folder / f'{config}-out{next(rounds)}'}/", RunOptions())

    return run


def _gains(folder: Path) -> list[Row]:
    """Return the rows of what two workers gain, as processes, over what two busy loops do in the same minute."""
    walks, swings, model = folder / "walks", folder / "shared-swings", folder / "shared.npz"
    _copies(WALK, walks, EDITED)
    swings.mkdir()
    for n, swing in enumerate(random_swings(np.random.default_rng(11), FITTED)):
        clip = new_bytes(make_swing(swing))
        for copy in range(NORMALIZED // FITTED):
            (swings / f"swing{n:04d}-{copy}.bvh").write_bytes(clip)
    each = sorted(swings.glob("*-0.bvh"))
    normalized, base = folder / "shared-normalized", folder / "base-normalized"
    for clips, out in ((each, normalized), (each[:BASE], base)):
        process((PROGRAM, "normalize", *clips, "-s", CONFIGS / "golf-normalize.yaml", "-o", out), folder)()
    process((PROGRAM, "fit-pca", base, "-s", CONFIGS / "golf-fit.yaml", "-o", model), folder)()
    commands: dict[str, tuple[str | Path, ...]] = {
        f"edit-prioritized, reach.yaml, {EDITED} clips": ("edit-prioritized", walks, "-s", CONFIGS / "reach.yaml"),
        f"normalize, {NORMALIZED:,} clips": ("normalize", swings, "-s", CONFIGS / "golf-normalize.yaml"),
        f"fit-pca, {FITTED:,} clips": ("fit-pca", normalized, "-s", CONFIGS / "golf-fit.yaml"),
        f"edit-pc, {BY_MODEL} clips": ("edit-pc", *each[:BY_MODEL], "-m", model, "-s", CONFIGS / "golf-edit.yaml"),
    }
    return [_gain(name, command, folder) for name, command in commands.items()]


def _gain(name: str, command: tuple[str | Path, ...], folder: Path) -> Row:
    end = ".npz" if "fit-pca" in command else ""

    rounds = count()

    def run(jobs: int) -> Callable[[], object]:
        def fresh() -> object:
            out = folder / f"gain-{command[0]}{next(rounds)}{end}"
            return process((PROGRAM, *command, "-o", out, "-j", str(jobs)), folder)()

        return fresh

    best = best_of({"busy": lambda: _busy(1), "both": lambda: _busy(2), "one": run(1), "two": run(2)}, rounds=5)
    loops, gain = 2.0 * best["busy"] / best["both"], best["one"] / best["two"]
    return Row(
        f"{name}, -j 2 beside -j 1",
        f"{gain:.2f} x faster",
        f"{loops:.2f} x, two busy loops",
        f"{gain / loops:.2f} x",
        f">= {LEAST_GAIN:g} x",
        "met" if gain / loops >= LEAST_GAIN else "MISSED",
    )


def _busy(count: int) -> float:
    start = time.perf_counter()
    for each in [subprocess.Popen([sys.executable, "-c", _BUSY]) for _ in range(count)]:
        each.wait()
    return time.perf_counter() - start


def _copies(clip: Path, folder: Path, number: int) -> list[Path]:
    folder.mkdir()
    clips = [folder / f"clip{n:04d}.bvh" for n in range(number)]
    for each in clips:
        shutil.copyfile(clip, each)
    return clips
