"""Normalizing and fitting many clips."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.clock import Row, best_of, duration
from data.generator.golf import make_swing
from data.generator.players import random_swings
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.jobs.batch.plan import RunOptions
from motionedit.jobs.fit_pca import job as fit_pca
from motionedit.jobs.normalize import job as normalize
from motionedit.spec.load import load_spec

if TYPE_CHECKING:
    from collections.abc import Sequence

CONFIGS = Path(__file__).resolve().parents[1] / "configs"
COUNTS = (10, 200)


def rows(folder: Path) -> list[Row]:
    """Return the table's rows on normalize and fit-pca, on one core."""
    source = folder / "swings"
    source.mkdir()
    clips = []
    for n, swing in enumerate(random_swings(np.random.default_rng(11), max(COUNTS))):
        clips.append(source / f"swing{n:03d}.bvh")
        clips[-1].write_bytes(new_bytes(make_swing(swing)))
    return [row for count in COUNTS for row in _rows_of(clips[:count], folder / f"normalized{count}")]


def _rows_of(clips: Sequence[Path], normalized: Path) -> list[Row]:
    spec = load_spec(CONFIGS / "golf-normalize.yaml", "normalize")
    fit = load_spec(CONFIGS / "golf-fit.yaml", "fit-pca")
    model = normalized.with_suffix(".npz")
    failures = normalize.run(spec, clips, normalized, RunOptions()).failures
    if failures:
        raise failures[0]

    rounds = itertools.count()

    def again() -> object:
        # Into a new folder, as in folders.py: for a while a disk steps over what was removed.
        return normalize.run(spec, clips, normalized.with_name(f"{normalized.name}-{next(rounds)}"), RunOptions())

    best = best_of(
        {
            "read": lambda: [read_clip(clip) for clip in clips],
            "normalize": again,
            "fit": lambda: fit_pca.run(normalized, model, fit, RunOptions()),
        },
        rounds=3,
    )
    count = len(clips)
    return [
        _rate(f"normalize, {count} clips", best["normalize"], best["read"], count),
        _rate(f"fit-pca, {count} clips", best["fit"], best["read"], count),
    ]


def _rate(what: str, seconds: float, reading: float, count: int) -> Row:
    return Row(
        what, f"{count / seconds:.0f} clips/s", f"{duration(reading)} to read them", f"{seconds / reading:.1f} x"
    )
