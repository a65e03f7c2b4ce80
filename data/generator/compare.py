"""A table of what the generated clips share with real ones: `python -m data.generator --compare FOLDER_OF_CLIPS`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from data.generator.golf import make_swing
from data.generator.kick import make_kick
from data.generator.measures import LEG, kick_measures, swing_measures, walk_measures
from data.generator.players import SHIPPED_RATE, shipped_swings
from data.generator.walk import make_walk
from motionedit.core.bvh import read_clip

if TYPE_CHECKING:
    from pathlib import Path

# The real clips: their paths below the folder, and what a person has read off them.
SWING, SWING_HIT = "golf/cmu_63_01.bvh", 325
WALK, WALK_FIRST = "motions/cmu_12_01_walk.bvh", 1
KICK = "motions/karate_mawashi_geri_left_1.bvh"
KICK_NAMES = {"LeftUpLeg": "LeftThigh", "RightUpLeg": "RightThigh"}


def comparison(folder: Path) -> str:
    """Return the table, real clips on the left; lengths are for a leg of `LEG` cm."""
    swings = [
        swing_measures(make_swing(swing), hit=round(swing.timing.hit * SHIPPED_RATE)) for swing in shipped_swings()
    ]
    mean = {name: float(np.mean([swing[name] for swing in swings])) for name in swings[0]}
    spread = {
        name: f"{min(swing[name] for swing in swings):.2f} to {max(swing[name] for swing in swings):.2f}"
        for name in mean
    }
    parts = [
        _part(
            "Golf: cmu_63_01 | mean of ten | their range",
            swing_measures(read_clip(folder / SWING).motion, hit=SWING_HIT),
            mean,
            spread,
        ),
        _part(
            "Walk: cmu_12_01 | walk.bvh",
            walk_measures(read_clip(folder / WALK).motion, first=WALK_FIRST),
            walk_measures(make_walk()),
            {},
        ),
        _part(
            "Kick: karate_mawashi_geri_left_1 (round) | kick.bvh (front)",
            kick_measures(read_clip(folder / KICK).motion, side="Left", names=KICK_NAMES),
            kick_measures(make_kick(), side="Right"),
            {},
        ),
    ]
    return f"Degrees, or cm for a leg of {LEG:.0f} cm, unless named.\n\n" + "\n\n".join(parts) + "\n"


def _part(title: str, real: dict[str, float], ours: dict[str, float], spread: dict[str, str]) -> str:
    rows = [f"  {name:<42}{real[name]:>10.2f}{ours[name]:>10.2f}   {spread.get(name, '')}".rstrip() for name in real]
    return "\n".join((title, *rows))
