"""The paired truth: the same player, style, timing and noise at another ball, from the generator of data/."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator.files import DECIMALS
from data.generator.golf import make_swing, with_ball
from data.generator.players import shipped_swings
from motionedit.core.bvh import new_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study


def paired(lab: Study, swing: int, ball: Sequence[float]) -> Path:
    """Return the file of a swing (0-based) as it would have been with the ball at (x, y, z), cm."""
    path = lab.lab.place() / f"{lab.swings[swing].stem}-truth.bvh"
    moved = with_ball(shipped_swings()[swing], (float(ball[0]), float(ball[2])))
    path.write_bytes(new_bytes(make_swing(moved), decimals=DECIMALS))
    return path


def coefficients(lab: Study, swing: int, clip: Path) -> FloatArray:
    """Return alpha of a clip that has the timing of a swing of the database."""
    record = lab.lab.edit(clip, lab.model_path, {"goals": [], "events": {"hit": lab.hits[swing]}}).record
    return np.array(record["alpha"]["before"])
