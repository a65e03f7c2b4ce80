"""[PC] section 6.1: xi = 0 against xi = 10, for goals further and further away."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from studies.lab import jerk, joint_positions
from studies.paper.drawing import BLUE, GREEN, GREY, ORANGE, PURPLE, Camera, Stage, body, new_figure
from studies.paper.study import ALGORITHM_1, COMPONENTS_ALONE, Findings, Table, club_head

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from studies.lab import Edited
    from studies.paper.study import Study

DISTANCES = (5, 10, 20, 30, 45, 60)
SOLVERS: dict[str, tuple[str, dict[str, Any]]] = {
    "xi = 0": (PURPLE, {"solver": {**ALGORITHM_1, "damping": 0.0}}),
    "xi = 10": (BLUE, {"solver": ALGORITHM_1}),
    "gauss-newton, bounded": (ORANGE, COMPONENTS_ALONE),
    "map, the default": (GREEN, {}),
}
SHOWN = 3  # the swing of the picture


class Measured(NamedTuple):
    """Of one edit: iterations, cm left, coefficients over the database's furthest, cm of feet at the hit, jerk."""

    iterations: int
    left: float
    norm: float
    feet: float
    jerk: float


def study(lab: Study) -> Findings:
    """Move the ball away from the player, with each solver, from each swing."""
    swings = range(2) if lab.quick else range(len(lab.swings))
    distances = DISTANCES[1::3] if lab.quick else DISTANCES
    edits = {
        (name, far): [lab.edit(s, {"shift": [0.0, 0.0, float(far)]}, components=8, **spec) for s in swings]
        for name, (_, spec) in SOLVERS.items()
        for far in distances
    }
    found = {key: [_measured(lab, s, e) for s, e in zip(swings, each, strict=True)] for key, each in edits.items()}
    shown = {name: lab.edit(SHOWN, {"shift": [0, 0, 60]}, components=8, **spec) for name, (_, spec) in SOLVERS.items()}
    return Findings((_table(found),), {"pc-damping": _figure(lab, found, shown)})


def _measured(lab: Study, swing: int, edit: Edited) -> Measured:
    record, hit = edit.record, lab.hits[swing]
    before, after = joint_positions(lab.swings[swing]), joint_positions(edit.path)
    names = lab.model.skeleton.names
    feet = [names.index(f"{side}{part}") for side in ("Left", "Right") for part in ("Foot", "ToeBase")]
    return Measured(
        record["iterations"],
        record["goals"][0]["error_max"],
        record["mahalanobis"]["after"] / record["mahalanobis"]["database_max"],
        float(np.linalg.norm(after[hit, feet] - before[hit, feet], axis=-1).max()),
        jerk(after) / jerk(before),
    )


def _table(found: dict[tuple[str, int], list[Measured]]) -> Table:
    rows: list[tuple[str, ...]] = [
        ("goal (cm)", "solver", "iterations", "left (cm)", "norm", "feet (cm)", "jerk", "worst jerk")
    ]
    for name, far in sorted(found, key=lambda key: key[1]):
        middle = np.median(np.array(found[name, far]), axis=0)
        worst = max(each.jerk for each in found[name, far])
        figures = (f"{middle[0]:.0f}", f"{middle[1]:.2f}", f"{middle[2]:.2f}", f"{middle[3]:.1f}", f"{middle[4]:.2f}")
        rows.append((str(far), name, *figures, f"{worst:.2f}"))
    title = "The ball moved away from the player, 8 components: medians of ten swings, jerk over the input's"
    return Table("pc-damping", title, tuple(rows))


def _figure(lab: Study, found: dict[tuple[str, int], list[Measured]], shown: dict[str, Edited]) -> Figure:
    figure = new_figure(10.0, 5.5)
    above, below = figure.subfigures(2, 1, height_ratios=(1.0, 1.35))
    panels = (
        ("iterations", 0, "iterations"),
        ("norm", 2, "coefficients' norm"),
        ("feet", 3, "feet move at the hit (cm)"),
    )
    for axes, (_, column, label) in zip(above.subplots(1, 3), panels, strict=True):
        for name, (color, _) in SOLVERS.items():
            far = sorted(d for n, d in found if n == name)
            middle = [np.median([each[column] for each in found[name, d]]) for d in far]
            axes.plot(far, middle, "o-", color=color, markersize=4, label=name)
        axes.set_xlabel("goal moved by (cm)")
        axes.set_title(label)
        if column == 0:
            axes.set_yscale("log")
        if column == 2:
            axes.legend(loc="upper left")
    _bodies(lab, Stage(below.subplots(), Camera(62.0, 10.0)), shown)
    return figure


def _bodies(lab: Study, stage: Stage, shown: dict[str, Edited]) -> None:
    """Draw the swing at the hit as each solver leaves it, 60 cm being asked for."""
    hit, source = lab.hits[SHOWN], body(lab.swings[SHOWN])
    goal = club_head(lab.swings[SHOWN])[hit] + np.array([0.0, 0.0, 60.0])
    anchor = np.zeros(3)
    for place, (name, edit) in enumerate(shown.items()):
        at = 230.0 * place
        stage.floor(anchor + np.array([0.0, 0.0, 40.0]), at, half=(60.0, 90.0), step=30.0)
        stage.pose(source, hit, GREY, anchor=anchor, at=at, alpha=0.45)
        stage.pose(body(edit.path), hit, SOLVERS[name][0], anchor=anchor, at=at)
        stage.mark(goal, "o", "#ffffff", anchor=anchor, at=at)
    for place, (name, edit) in enumerate(shown.items()):
        left = edit.record["goals"][0]["error_max"]
        stage.text(f"{name}: {edit.record['iterations']} iterations, {left:.1f} cm left", 230.0 * place)
    stage.close(margin=12.0)
