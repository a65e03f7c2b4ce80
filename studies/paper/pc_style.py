"""[PC] Figures 6 and 7: five goals for one swing, their convergence, and whether the edits keep their style."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.paper.drawing import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, QUIET, STYLES, Camera, Stage, body, new_figure
from studies.paper.study import ALGORITHM_1, COMPONENTS_ALONE, Findings, Table
from studies.paper.truth import coefficients, paired

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited
    from studies.paper.study import Study

INPUT = 0  # swing01, of style 1
GOALS = (7, 2, 5, 4, 1)  # the swings, all of other styles, whose balls are the five goals
BANDS = ((1.0, 10.0), (10.0, 15.0))
PLANE = [1, 2]  # of Figure 6: in data/ the first component is the ball, the next two tell styles apart
SOLVERS: dict[str, dict[str, Any]] = {
    "Algorithm 1": {"solver": ALGORITHM_1, "components": 8},
    "gauss-newton": COMPONENTS_ALONE,
    "map": {},
}


def study(lab: Study) -> Findings:
    """Edit one swing to five balls, and every swing to the balls of other styles."""
    five = {name: [_to_ball(lab, INPUT, ball, spec) for ball in GOALS] for name, spec in SOLVERS.items()}
    kept = [_kept(lab, name, band) for band in BANDS for name in SOLVERS]
    headings = ("goal (cm)", "solver", "own cluster: inputs", "truths", "edits", "nearer to the truth")
    headings += ("moves", "truth moves", "off the truth")
    title = "Figure 6: every swing to the balls of other styles; the truth is the same player's own swing to that ball"
    tables = (_five(lab, five), _what_components_are(lab), Table("pc-clusters", title, (headings, *kept)))
    return Findings(tables, {"pc-style": _figure(lab, five["Algorithm 1"])})


def _to_ball(lab: Study, swing: int, ball: int, spec: dict[str, Any]) -> Edited:
    return lab.edit(swing, {"position": lab.balls[ball].tolist()}, **spec)


def _five(lab: Study, five: dict[str, list[Edited]]) -> Table:
    rows: list[tuple[str, ...]] = [
        ("goal", "ball of", "away (cm)", "solver", "iterations", "left (cm)", "nearest motion", "style")
    ]
    for number, ball in enumerate(GOALS):
        away = np.linalg.norm(lab.balls[ball] - lab.balls[INPUT])
        for name, edits in five.items():
            record = edits[number].record
            left = record["goals"][0]["error_max"]
            nearest = record["nearest"]["after"]
            style = lab.styles[[clip.stem for clip in lab.swings].index(nearest)]
            goal = (str(number + 1), f"swing{ball + 1:02d}, style {lab.styles[ball]}", f"{away:.1f}")
            rows.append((*goal, name, str(record["iterations"]), f"{left:.3f}", nearest, str(style)))
    return Table("pc-goals", "Figure 7: swing01, of style 1, to five balls of other styles", tuple(rows))


def _what_components_are(lab: Study) -> Table:
    """Return how much of each coefficient the style, and the place of the ball, account for."""
    alpha, styles = lab.model.components.coefficients, np.array(lab.styles)
    places = np.column_stack((np.ones(len(styles)), lab.balls[:, [0, 2]]))
    groups = np.stack([styles == style for style in (1, 2, 3)], axis=1).astype(float)
    rows: list[tuple[str, ...]] = [("component", *(str(k + 1) for k in range(alpha.shape[1])))]
    for name, basis in (("style (%)", groups), ("ball (%)", places)):
        left = alpha - basis @ np.linalg.lstsq(basis, alpha, rcond=None)[0]
        rows.append((name, *(f"{100 * (1 - v):.0f}" for v in np.var(left, axis=0) / np.var(alpha, axis=0))))
    return Table("pc-components", "What the coefficients of the ten swings go with (R squared)", tuple(rows))


def _kept(lab: Study, name: str, band: tuple[float, float]) -> tuple[str, ...]:
    """Return how many edits stay with their style, and how near they are to the player's own swing to that ball."""
    swings = range(2) if lab.quick else range(len(lab.swings))
    own = np.zeros(3, dtype=int)
    known, figures = lab.model.components.coefficients, []
    for swing in swings:
        for ball in lab.near_balls(swing, least=band[0], most=band[1]):
            if lab.styles[ball] == lab.styles[swing]:
                continue
            # Of the written clip: what leaves the components at the goal may come back into them elsewhere.
            edited = coefficients(lab, swing, _to_ball(lab, swing, ball, SOLVERS[name]).path)
            truth = coefficients(lab, swing, paired(lab, swing, lab.balls[ball]))
            own += [_cluster(lab, alpha) == lab.styles[swing] for alpha in (known[swing], truth, edited)]
            figures.append([np.linalg.norm(edited - alpha) for alpha in (truth, known[ball], known[swing])])
            figures[-1].append(np.linalg.norm(truth - known[swing]))
    far = np.array(figures)
    nearer = int(np.count_nonzero(far[:, 0] < far[:, 1]))
    middle = np.median(far, axis=0)
    total = len(far)
    counts = (f"{count} of {total}" for count in (*own, nearer))
    distances = (f"{middle[k]:.1f}" for k in (2, 3, 0))
    return f"{band[0]:g} to {band[1]:g}", name, *counts, *distances


def _cluster(lab: Study, alpha: FloatArray) -> int:
    """Return the style whose mean is nearest in the coefficients that tell styles apart."""
    known, styles = lab.model.components.coefficients[:, PLANE], np.array(lab.styles)
    means = np.stack([known[styles == style].mean(axis=0) for style in (1, 2, 3)])
    return 1 + int(np.argmin(np.linalg.norm(means - alpha[PLANE], axis=1)))


def _figure(lab: Study, edits: list[Edited]) -> Figure:
    figure = new_figure(10.0, 3.6)
    first, second = figure.subfigures(1, 2, width_ratios=(1.0, 1.9))
    _goals(Stage(first.subplots(), Camera(12.0, 22.0)), lab)
    middle, right = second.subplots(1, 2)
    shades = [BLUE, GREEN, ORANGE, PURPLE, INK]
    for number, edit in enumerate(edits):
        history = edit.record["history"]
        middle.plot(history, color=shades[number], label=f"goal {number + 1}")
    middle.axhline(1.0, color=GREY, linewidth=1.0, linestyle=":")
    middle.set_xlabel("iterations")
    middle.set_ylabel("club head to goal (cm)")
    middle.legend(loc="upper right")
    middle.set_title("Figure 7 (b): Algorithm 1")
    _coefficients(right, lab, edits)
    return figure


def _goals(stage: Stage, lab: Study) -> None:
    anchor = np.zeros(3)
    stage.floor(np.array([0.0, 0.0, 30.0]), 0.0, half=(60.0, 60.0), step=20.0)
    stage.pose(body(lab.swings[INPUT]), lab.hits[INPUT], GREY, anchor=anchor)
    stage.mark(lab.balls[INPUT], "o", BLUE, anchor=anchor, size=6.0)
    for ball in GOALS:
        stage.mark(lab.balls[ball], "o", "#ffffff", anchor=anchor, size=4.5)
    stage.close(margin=4.0, lines=0)
    stage.axes.set_title("Figure 7 (a): five goals")
    _plan(stage.axes.inset_axes((0.80, 0.56, 0.38, 0.32)), lab)


def _plan(axes: Axes, lab: Study) -> None:
    """Draw the balls as seen from above, the player below them."""
    for number, ball in enumerate(GOALS):
        x, _, z = lab.balls[ball]
        axes.plot(x, z, "o", color="#ffffff", markeredgecolor=INK, markersize=5)
        axes.annotate(str(number + 1), (x, z), (4, 2), textcoords="offset points", fontsize=8)
    axes.plot(lab.balls[INPUT][0], lab.balls[INPUT][2], "o", color=BLUE, markeredgecolor=INK, markersize=5)
    axes.set_aspect("equal")
    axes.margins(0.25)
    axes.tick_params(labelsize=6.5)
    axes.set_title("from above (cm)", fontsize=7.5, fontweight="normal")


def _coefficients(axes: Axes, lab: Study, edits: list[Edited]) -> None:
    known = lab.model.components.coefficients[:, PLANE]
    for style, color in zip((1, 2, 3), STYLES, strict=True):
        members = known[[s == style for s in lab.styles]]
        axes.plot(members[:, 0], members[:, 1], "o", color=color, markersize=8, alpha=0.4, label=f"style {style}")
    start = known[INPUT]
    for number, (ball, edit) in enumerate(zip(GOALS, edits, strict=True)):
        alpha = np.array(edit.record["alpha"]["after"])[PLANE]
        truth = coefficients(lab, INPUT, paired(lab, INPUT, lab.balls[ball]))[PLANE]
        axes.plot(*known[ball], ".", color=INK, markersize=5)
        axes.annotate(str(number + 1), known[ball], (6, 4), textcoords="offset points", fontsize=8, color=QUIET)
        axes.plot(*np.stack((start, alpha)).T, color=ORANGE, linewidth=0.9)
        axes.plot(*alpha, "o", color=ORANGE, markersize=5, label=None if number else "edited")
        axes.plot(*np.stack((alpha, truth)).T, ":", color=QUIET, linewidth=0.9)
        axes.plot(*truth, "x", color=INK, markersize=5, label=None if number else "own swing there")
    axes.plot(*start, "o", color=GREY, markeredgecolor=INK, markersize=6, label="the input")
    axes.set_xlabel("second coefficient")
    axes.set_ylabel("third coefficient")
    axes.set_title("Figure 6: style")
    axes.set_ylim(-6.0, 10.5)
    axes.legend(fontsize=7.5, loc="upper left", ncols=2)
