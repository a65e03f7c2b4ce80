"""Lines of the tables of accuracy figures, and what is measured of edits by coefficients."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.bvh import read_clip
from studies.lab import effector_path, jerk, joint_positions

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited

HEADINGS = ("what", "measured", "aim", "")


def row(what: str, value: float, aim: float, *, least: bool = False) -> tuple[str, str, str, str]:
    """Return a line of a table: the figure beside its aim."""
    met = value >= aim if least else value <= aim
    return what, f"{value:.3g}", f"{'>=' if least else '<='} {aim:g}", "" if met else "MISSED"


def told(what: str, value: str) -> tuple[str, str, str, str]:
    """Return a line that has no aim."""
    return what, value, "", ""


def goal_misses(edits: Sequence[tuple[Path, Edited, FloatArray]], joint: str, *, end_site: bool) -> FloatArray:
    """Return how far (mm at 1 cm units) each written file is from its goal: (clip, edit, shift) triples."""
    misses = []
    for clip, edit, shift in edits:
        frame = edit.record["goals"][0]["frame"]
        before = effector_path(clip, joint, end_site=end_site)[frame]
        after = effector_path(edit.path, joint, end_site=end_site)[frame]
        misses.append(10.0 * np.linalg.norm(after - before - shift))
    return np.array(misses)


def counts(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> str:
    """Return how often each status came out."""
    found = [edit.record["status"] for _, edit, _ in edits]
    return ", ".join(f"{found.count(status)} {status}" for status in sorted(set(found)))


def side_effects(edits: Sequence[tuple[Path, Edited, FloatArray]]) -> tuple[list[float], list[float]]:
    """Return how far the feet move at the goal's frame, and the jerk over the input's, per edit."""
    feet, jerks = [], []
    for clip, edit, _ in edits:
        before, after = joint_positions(clip), joint_positions(edit.path)
        names = read_clip(clip).motion.skeleton.names
        soles = [j for j, name in enumerate(names) if name.endswith(("Foot", "ToeBase", "Ankle"))]
        frame = edit.record["goals"][0]["frame"]
        feet.append(float(np.linalg.norm(after[frame, soles] - before[frame, soles], axis=-1).max()))
        jerks.append(jerk(after) / jerk(before))
    return feet, jerks
