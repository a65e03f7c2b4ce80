"""The edits beside the player's own swing to that ball, each swing left out of the database that edits it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.lab import jerk, joint_positions
from studies.paper.study import COMPONENTS_ALONE, GOLF, Findings, Table, club_head
from studies.paper.truth import coefficients, paired

if TYPE_CHECKING:
    from pathlib import Path

    from studies.lab import Edited
    from studies.paper.study import Study

METHODS: dict[str, dict[str, Any]] = {"no edit": {}, "gauss-newton": COMPONENTS_ALONE, "map": {}}
DOWNSWING = 12  # frames before the hit
FARTHEST = 20.0  # cm from a swing's ball to another's
STYLE = [1, 2]  # the coefficients that tell styles apart


def study(lab: Study) -> Findings:
    """Edit every swing to the balls of the others by a model that does not know it."""
    found: dict[str, list[list[float]]] = {name: [] for name in METHODS}
    for swing in range(2) if lab.quick else range(len(lab.swings)):
        model = lab.lab.model([clip for i, clip in enumerate(lab.swings) if i != swing], GOLF)
        for ball in lab.near_balls(swing, least=1.0, most=FARTHEST)[: 2 if lab.quick else None]:
            place, hit = lab.balls[ball].tolist(), lab.hits[swing]
            truth = paired(lab, swing, place)
            goal = {"position": place, "at": hit}
            for name, spec in METHODS.items():
                path = lab.swings[swing]
                if name != "no edit":
                    edit: Edited = lab.edit(swing, goal, model=model, events={"hit": hit}, **spec)
                    path = edit.path
                found[name].append(_figures(lab, swing, path, truth))
    headings = (
        "method",
        "edits",
        "all joints",
        "club at the finish",
        "club in the downswing",
        "style kept (%)",
        "jerk",
    )
    rows: list[tuple[str, ...]] = [headings]
    for name, values in found.items():
        whole, finish, down, _, jerks = np.median(values, axis=0)
        kept = 100.0 * float(np.mean([value[3] for value in values]))
        cells = (f"{whole:.2f}", f"{finish:.1f}", f"{down:.1f}", f"{kept:.0f}", f"{jerks:.2f}")
        rows.append((name, str(len(values)), *cells))
    title = "Swings left out, to balls of the others: medians of the distance to the player's own swing there (cm, rms)"
    return Findings((Table("pc-truth", title, tuple(rows)),))


def _figures(lab: Study, swing: int, path: Path, truth: Path) -> list[float]:
    """Return how far a clip is from the truth: all joints, club at the end and before the hit; its style, its jerk."""
    body, own = joint_positions(path), joint_positions(truth)
    club, own_club = club_head(path), club_head(truth)
    off = np.linalg.norm(club - own_club, axis=1)
    down = off[lab.hits[swing] - DOWNSWING : lab.hits[swing] + 1]
    known, styles = lab.model.components.coefficients[:, STYLE], np.array(lab.styles)
    means = np.stack([known[styles == style].mean(axis=0) for style in (1, 2, 3)])
    alpha = coefficients(lab, swing, path)[STYLE]
    style = 1 + int(np.argmin(np.linalg.norm(means - alpha, axis=1)))
    return [
        float(np.sqrt(np.mean(np.sum((body - own) ** 2, axis=-1)))),
        float(off[-1]),
        float(np.sqrt(np.mean(down**2))),
        float(style == lab.styles[swing]),
        jerk(body) / jerk(joint_positions(lab.swings[swing])),
    ]
