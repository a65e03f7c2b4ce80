"""[PC] on real strokes: Table 1, xi = 0 against xi = 10, and section 6.2, where MOTIONEDIT_CLIPS names them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.lab import effector_path, jerk
from studies.paper.comparison import Outcome, Task, balance, feet, outcome, timed
from studies.paper.drawing import BLUE, GREY, GROUND, ORANGE, QUIET, Camera, Stage, body, new_figure
from studies.paper.study import ALGORITHM_1, COMPONENTS_ALONE, Findings, Table, spread

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.lab import Edited
    from studies.paper.study import Study

WRIST = "RightWrist"
CAP = 5000
SHIFTS = (np.array([10.0, 0.0, 0.0]), np.array([0.0, 0.0, 10.0]))
GN_OUT = "edit-pc, gauss-newton, left out"
PC, PC_OUT, ONE, FIVE = "edit-pc", "edit-pc, left out", "edit-prioritized, goal alone", "the same, feet and CoM"


@dataclass(frozen=True)
class Strokes:
    """Real repetitions of one stroke, cut so that all hit at one frame."""

    name: str
    clips: tuple[Path, ...]
    hit: int

    @property
    def normalize(self) -> dict[str, Any]:
        """The spec that normalizes them."""
        return self.without(None)

    def without(self, clip: Path | None) -> dict[str, Any]:
        """Return the spec that normalizes all but one."""
        return {"events": {"hit": {"frames": {c.stem: self.hit for c in self.clips if c != clip}}}}


def study(lab: Study) -> Findings:
    """Run [PC]'s experiments on smashes and serves; nothing where there are none."""
    found = _strokes(lab)
    if not found:
        return Findings()
    models = {strokes.name: lab.lab.model(strokes.clips, strokes.normalize) for strokes in found}
    tables = [_iterations(lab, found, models), _damping(lab, found, models)]
    tables += [_compared(lab, strokes, models[strokes.name]) for strokes in found]
    return Findings(tuple(tables), {"pc-strokes": _figure(lab, found[0], models[found[0].name])})


def _strokes(lab: Study) -> list[Strokes]:
    if lab.clips is None:
        return []
    kinds = (("smash", "smash_mrios", 110), ("serve", "serve_jsgiraldo", 140))
    all_clips = [(name, sorted((lab.clips / "strokes" / folder).glob("*.bvh")), hit) for name, folder, hit in kinds]
    found = [Strokes(name, tuple(clips), hit) for name, clips, hit in all_clips if len(clips) > 2]
    return found[:1] if lab.quick else found


def _wrist(path: Path) -> FloatArray:
    return effector_path(path, WRIST)


def _edit(lab: Study, clip: Path, strokes: Strokes, model: Path, shift: FloatArray, **spec: Any) -> Edited:  # noqa: ANN401
    goal = {"name": "wrist", "at": "hit", "effector": WRIST, "shift": shift.tolist()}
    return lab.lab.edit(clip, model, {"unit": "cm", "events": {"hit": strokes.hit}, "goals": [goal], **spec})


def _iterations(lab: Study, found: list[Strokes], models: dict[str, Path]) -> Table:
    counts = (3, 7) if lab.quick else (2, 3, 4, 5, 6, 7)
    solver = {**ALGORITHM_1, "max_iterations": CAP}
    rows: list[tuple[str, ...]] = [("strokes", *(f"{m} components" for m in counts))]
    for strokes in found:
        clips = strokes.clips[:2] if lab.quick else strokes.clips[:6]
        cells = []
        for m in counts:
            edits = [
                _edit(
                    lab,
                    clip,
                    strokes,
                    models[strokes.name],
                    SHIFTS[0],
                    components=m,
                    solver=solver,
                )
                for clip in clips
            ]
            met = [edit.record["iterations"] for edit in edits if edit.record["stopped"] == "converged"]
            cells.append(f"{spread(met, '.0f') if met else 'none'}, {len(met)} of {len(edits)}")
        rows.append((strokes.name, *cells))
    title = f"Real strokes, the wrist 10 cm along x: iterations of Algorithm 1, xi = 10; who gets to 1 cm in {CAP}"
    return Table("pc-strokes-iterations", title, tuple(rows), quoted=True)


def _damping(lab: Study, found: list[Strokes], models: dict[str, Path]) -> Table:
    rows: list[tuple[str, ...]] = [
        ("strokes", "goal (cm)", "solver", "iterations", "left (cm)", "norm", "wrist jerk", "worst")
    ]
    solvers = {"xi = 0": {"solver": {**ALGORITHM_1, "damping": 0.0}}, "xi = 10": {"solver": ALGORITHM_1}}
    solvers |= {"gauss-newton": COMPONENTS_ALONE, "map": {}}
    for strokes in found:
        clips = strokes.clips[:2] if lab.quick else strokes.clips
        for far in (10.0, 30.0, 60.0):
            for name, spec in solvers.items():
                edits = [
                    (clip, _edit(lab, clip, strokes, models[strokes.name], np.array([far, 0.0, 0.0]), **spec))
                    for clip in clips
                ]
                rows.append((strokes.name, f"{far:.0f}", name, *_figures_of(edits)))
    title = "Real strokes, the wrist moved along x: medians (jerk over the input's)"
    return Table("pc-strokes-damping", title, tuple(rows), quoted=True)


def _figures_of(edits: list[tuple[Path, Edited]]) -> tuple[str, ...]:
    records = [edit.record for _, edit in edits]
    jerks = [jerk(_wrist(edit.path)) / jerk(_wrist(clip)) for clip, edit in edits]
    iterations, left, norm = (
        np.median(values)
        for values in (
            [r["iterations"] for r in records],
            [r["goals"][0]["error_max"] for r in records],
            [r["mahalanobis"]["after"] / r["mahalanobis"]["database_max"] for r in records],
        )
    )
    return f"{iterations:.0f}", f"{left:.2f}", f"{norm:.2f}", f"{np.median(jerks):.2f}", f"{max(jerks):.2f}"


def _compared(lab: Study, strokes: Strokes, model: Path) -> Table:
    found: dict[str, list[Outcome]] = {}
    for clip in strokes.clips[:1] if lab.quick else strokes.clips:
        others = [other for other in strokes.clips if other != clip]
        left_out = lab.lab.model(others, strokes.without(clip))
        for shift in SHIFTS:
            task = Task(clip, strokes.hit, WRIST, shift)
            for name, (edit, seconds) in _edits(lab, strokes, task, model, left_out).items():
                found.setdefault(name, []).append(outcome(task, edit.path, seconds, place=_wrist, truth=None))
    headings = (
        "method",
        "goal (mm)",
        "feet drift (cm)",
        "slide (cm/s)",
        "jerk",
        "worst",
        "limbs overlap (cm)",
        "seconds",
    )
    rows: list[tuple[str, ...]] = [headings]
    for name, outcomes in found.items():
        values = np.stack([each.row for each in outcomes])
        left, drift, slide, jerks, overlap, _, _ = np.median(values, axis=0)
        seconds = np.median([each.seconds for each in outcomes])
        cells = (f"{10 * left:.3f}", f"{drift:.2f}", f"{slide:.0f}", f"{jerks:.2f}", f"{values[:, 3].max():.2f}")
        rows.append((name, *cells, f"{overlap:.2f}", f"{seconds:.2f}"))
    title = f"Real strokes ({strokes.name}), the wrist 10 cm along x and along z: medians"
    return Table(f"pc-strokes-{strokes.name}", title, tuple(rows), quoted=True)


def _edits(lab: Study, strokes: Strokes, task: Task, model: Path, left_out: Path) -> dict[str, tuple[Edited, float]]:
    five = [*feet(task.clip), task.pull, balance()]
    return {
        PC: timed(lambda: _edit(lab, task.clip, strokes, model, task.shift)),
        PC_OUT: timed(lambda: _edit(lab, task.clip, strokes, left_out, task.shift)),
        GN_OUT: timed(lambda: _edit(lab, task.clip, strokes, left_out, task.shift, **COMPONENTS_ALONE)),
        ONE: timed(lambda: lab.lab.edit_prioritized(task.clip, {"constraints": [task.pull]})),
        FIVE: timed(lambda: lab.lab.edit_prioritized(task.clip, {"constraints": five})),
    }


def _figure(lab: Study, strokes: Strokes, model: Path) -> Figure:
    """Draw one stroke, its edit by coefficients and by constraints, at instants about the hit."""
    clip, shift = strokes.clips[0], np.array([20.0, 0.0, 0.0])
    task = Task(clip, strokes.hit, WRIST, shift)
    kinds = {
        "edit-pc": (_edit(lab, clip, strokes, model, shift).path, ORANGE),
        "edit-prioritized": (
            lab.lab.edit_prioritized(clip, {"constraints": [*feet(clip), task.pull, balance()]}).path,
            BLUE,
        ),
    }
    frames = strokes.hit + np.array([-70, -35, -18, -8, 0, 10, 25])
    figure = new_figure(10.0, 5.0)
    grid = figure.subplots(len(kinds), 1)
    source, wrist = body(clip), _wrist(clip)[strokes.hit]
    for axes, (name, (path, color)) in zip(grid, kinds.items(), strict=True):
        stage, who = Stage(axes, Camera(0.0, 6.0)), body(path)
        for column, frame in enumerate(frames):
            at = 150.0 * column
            anchor = source.positions[frame].mean(axis=0) * np.array([1.0, 0.0, 1.0])
            stage.pose(source, frame, GREY, anchor=anchor, at=at, alpha=0.4)
            stage.pose(who, frame, color, anchor=anchor, at=at)
            if frame == strokes.hit:
                stage.mark(wrist + shift, "+", "#c01f2e", anchor=anchor, at=at, size=9.0)
        axes.axhline(0.0, color=GROUND, linewidth=0.8, zorder=0.0)
        for column, frame in enumerate(frames):
            stage.text("the hit" if frame == strokes.hit else f"{frame - strokes.hit:+d}", 150.0 * column, color=QUIET)
        stage.close(margin=8.0)
        axes.set_title(f"{name}: {strokes.name} {clip.stem}", color=color)
    return figure
