"""[PC] section 6.2 and Figure 8: the edit by coefficients against per-frame constraints, one goal for both."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.paper.comparison import Outcome, Task, balance, feet, grip, outcome, put_back, timed
from studies.paper.drawing import BLUE, GREEN, GREY, GROUND, ORANGE, QUIET, Camera, Stage, body, new_figure
from studies.paper.study import COMPONENTS_ALONE, GOLF, Findings, Table, club_head
from studies.paper.truth import paired

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from studies.lab import Edited
    from studies.paper.study import Study

SHIFTS = {"10 cm ahead": np.array([10.0, 0.0, 0.0]), "10 cm away": np.array([0.0, 0.0, 10.0])}
SHOWN = 0
SHOWN_SHIFT = np.array([14.0, 0.0, 0.0])
NO_EDIT, PC, PC_OUT = "no edit", "edit-pc", "edit-pc, left out of the database"
GN, GN_OUT = "edit-pc, gauss-newton", "edit-pc, gauss-newton, left out"
PC_FEET = "the same in the database, then its feet put back"
ONE, FIVE, SIX = "edit-prioritized, the goal alone", "the same, feet and CoM", "the same, left hand on the club"
CONSTRAINTS = {NO_EDIT: "", PC: "1", PC_OUT: "1", GN: "1", GN_OUT: "1", PC_FEET: "1 + 5", ONE: "1", FIVE: "5", SIX: "6"}


def study(lab: Study) -> Findings:
    """Edit every swing by every method."""
    swings = (0,) if lab.quick else range(len(lab.swings))
    found: dict[str, list[Outcome]] = {}
    for swing in swings:
        left_out = lab.lab.model([clip for i, clip in enumerate(lab.swings) if i != swing], GOLF)
        for shift in SHIFTS.values():
            task = Task(lab.swings[swing], lab.hits[swing], {"end_site": "Club"}, shift)
            truth = paired(lab, swing, lab.balls[swing] + shift)
            for name, (edited, seconds) in _edits(lab, swing, task, left_out).items():
                result = outcome(task, edited, seconds, place=club_head, truth=truth)
                found.setdefault(name, []).append(result)
    return Findings((_table(found), _seconds(found)), {"pc-comparison": _figure(lab)})


def _edits(lab: Study, swing: int, task: Task, left_out: Path) -> dict[str, tuple[Path, float]]:
    goal = {"shift": task.shift.tolist()}
    away = {**goal, "at": task.hit}
    edits = {
        PC: timed(lambda: lab.edit(swing, goal)),
        PC_OUT: timed(lambda: lab.edit(swing, away, model=left_out, events={"hit": task.hit})),
        GN: timed(lambda: lab.edit(swing, goal, **COMPONENTS_ALONE)),
        GN_OUT: timed(lambda: lab.edit(swing, away, model=left_out, events={"hit": task.hit}, **COMPONENTS_ALONE)),
    }
    for name, constraints in _layers(task).items():
        edits[name] = timed(lambda constraints=constraints: _prioritized(lab, task, constraints))
    first, seconds = edits[GN]
    keep = [{"type": "position", "effector": task.effector, "priority": 5}, grip()]
    second, more = timed(lambda: put_back(task.clip, first.path, keep, lab.lab))
    results = {NO_EDIT: (task.clip, 0.0), **{name: (edit.path, took) for name, (edit, took) in edits.items()}}
    return {**results, PC_FEET: (second.path, seconds + more)}


def _layers(task: Task) -> dict[str, list[dict[str, Any]]]:
    five = [*feet(task.clip), task.pull, balance()]
    return {ONE: [task.pull], FIVE: five, SIX: [*five, grip()]}


def _prioritized(lab: Study, task: Task, constraints: list[dict[str, Any]]) -> Edited:
    return lab.lab.edit_prioritized(task.clip, {"constraints": constraints})


def _table(found: dict[str, list[Outcome]]) -> Table:
    rows: list[tuple[str, ...]] = [
        (
            "method",
            "constraints",
            "goal (mm)",
            "feet drift (cm)",
            "slide (cm/s)",
            "jerk",
            "worst",
            "limbs overlap (cm)",
            "worst",
            "off the truth at the hit",
            "all frames",
        )
    ]
    for name, count in CONSTRAINTS.items():
        values = np.stack([each.row for each in found[name]])
        left, drift, slide, jerk, overlap, near, whole = np.median(values, axis=0)
        worst = values.max(axis=0)
        cells = (f"{10 * left:.3f}", f"{drift:.2f}", f"{slide:.1f}", f"{jerk:.2f}", f"{worst[3]:.2f}")
        rows.append((name, count, *cells, f"{overlap:.2f}", f"{worst[4]:.2f}", f"{near:.2f}", f"{whole:.2f}"))
    title = "The ball 10 cm ahead, and 10 cm away, from ten swings: medians (truth: cm, root mean square over joints)"
    return Table("pc-comparison", title, tuple(rows))


def _seconds(found: dict[str, list[Outcome]]) -> Table:
    rows: list[tuple[str, ...]] = [("method", "the paper (s)", "ours, median (s)", "most")]
    theirs = {PC: "1", FIVE: "100"}
    for name in CONSTRAINTS:
        seconds = [each.seconds for each in found[name]]
        if name != NO_EDIT:
            rows.append((name, theirs.get(name, ""), f"{np.median(seconds):.3f}", f"{max(seconds):.3f}"))
    return Table("pc-comparison-seconds", "Seconds for one clip, reading and writing in", tuple(rows), quoted=True)


def _figure(lab: Study) -> Figure:
    task = Task(lab.swings[SHOWN], lab.hits[SHOWN], {"end_site": "Club"}, SHOWN_SHIFT)
    kinds = {
        "input": (task.clip, GREY),
        "edit-pc": (lab.edit(SHOWN, {"shift": SHOWN_SHIFT.tolist()}).path, ORANGE),
        "edit-prioritized": (_prioritized(lab, task, _layers(task)[FIVE]).path, BLUE),
        "the player's own": (paired(lab, SHOWN, lab.balls[SHOWN] + SHOWN_SHIFT), GREEN),
    }
    frames = task.hit + np.array([-70, -22, -12, -6, -2, 0, 2, 6, 26])
    figure = new_figure(10.0, 8.6)
    grid = figure.subplots(len(kinds), 1)
    source, start = body(task.clip), club_head(task.clip)[task.hit]
    for axes, (name, (path, color)) in zip(grid, kinds.items(), strict=True):
        stage, who = Stage(axes, Camera(0.0, 6.0)), body(path)
        for column, frame in enumerate(frames):
            at, anchor = 135.0 * column, np.zeros(3)
            if color != GREY:
                stage.pose(source, frame, GREY, anchor=anchor, at=at, alpha=0.28)
            stage.pose(who, frame, color, anchor=anchor, at=at)
            ball = start if color == GREY else start + SHOWN_SHIFT
            stage.mark(ball, "o", "#ffffff", anchor=anchor, at=at, size=4.5)
        axes.axhline(0.0, color=GROUND, linewidth=0.8, zorder=0.0)
        stage.close(margin=8.0, lines=0)
        axes.set_title(name, color=QUIET if color == GREY else color)
    for column, frame in enumerate(frames):
        grid[-1].annotate(
            f"{frame}" if frame != task.hit else f"{frame}, the hit",
            (135.0 * column, 0.0),
            (0.0, -12.0),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=8.5,
            color=QUIET,
        )
    return figure
