"""[PRIO] Figure 7: all together, a walk that climbs stairs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studies.demonstrations import config, stairs
from studies.figures_prioritized import HEADINGS as MEASURES
from studies.figures_prioritized import measured
from studies.paper.comparison import SECONDS, timed
from studies.paper.drawing import GREY, GROUND, ORANGE, Camera, Stage, new_figure
from studies.paper.prio_clips import Shown
from studies.paper.study import AS_PRIO, ROOT, Findings, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from studies.lab import Edited
    from studies.paper.study import Study

# When a foot stands on which step, and on which height: of configs/stairs.yaml.
STEPS = (("RightToeBase", 42, 12.0), ("LeftToeBase", 57, 24.0), ("RightToeBase", 71, 36.0), ("LeftToeBase", 86, 48.0))
FRAMES = (8, 28, 43, 57, 72, 86, 101)
WIDTH = 45.0
_ITERATIONS = ("iterations, median", "95 %", "most")


def study(lab: Study) -> Findings:
    """Climb as the config says, and smoothed as in the paper; and on a real walk."""
    walk, spec = ROOT / "data" / "walk.bvh", config("stairs")
    edit, seconds = timed(lambda: lab.lab.edit_prioritized(walk, spec), rounds=lab.rounds)
    paper = {**spec, **AS_PRIO}
    single = {**paper, "smoothing": {"method": "paper", "passes": 1}}
    edits: dict[str, tuple[Edited, float]] = {"the default, 3 passes": (edit, seconds)}
    if not lab.quick:
        edits["the paper's FIR, 1 pass"] = timed(lambda: lab.lab.edit_prioritized(walk, single), rounds=lab.rounds)
        edits["the paper's FIR, 2 passes"] = timed(lambda: lab.lab.edit_prioritized(walk, paper), rounds=lab.rounds)
    rows = [_kept(MEASURES)]
    rows += [_kept(measured(name, walk, each, spec["constraints"])) for name, (each, _) in edits.items()]
    title = "Figure 7: climbing stairs, by how it is smoothed (at a leg of 0.85 m)"
    times = [("edit", "the paper (s)", "ours (s)")]
    times += [(name, "40" if "2 passes" in name else "", f"{took:.2f}") for name, (_, took) in edits.items()]
    tables = [
        Table("prio-stairs", title, tuple(rows)),
        Table("prio-stairs-seconds", SECONDS, tuple(times), quoted=True),
        *_real(lab),
    ]
    return Findings(tuple(tables), {"prio-stairs": _picture(Shown(edit.path), Shown(walk))})


def _kept(row: tuple[str, ...]) -> tuple[str, ...]:
    """Return a row of the figures' table without its iterations, which hang on the solver and not on the method."""
    return tuple(cell for cell, heading in zip(row, MEASURES, strict=True) if heading not in _ITERATIONS)


def _picture(climb: Shown, walk: Shown) -> Figure:
    figure = new_figure(10.0, 5.2)
    stage, anchor = Stage(figure.subplots(), Camera(-78.0, 9.0)), np.zeros(3)
    _draw_steps(stage, climb)
    stage.path(climb.com[: FRAMES[-1] + 8], ORANGE, anchor=anchor, width=1.0)
    stage.path(walk.com[: FRAMES[-1] + 8], GREY, anchor=anchor, width=1.0)
    for frame in FRAMES:
        stage.pose(walk.body, frame, GREY, anchor=anchor, alpha=0.22)
    for frame in FRAMES:
        stage.pose(climb.body, frame, ORANGE, anchor=anchor)
    stage.close(margin=8.0, lines=0)
    return figure


def _draw_steps(stage: Stage, climb: Shown) -> None:
    """Draw each step as a block: its top, its riser and the side that is seen."""
    fronts = [float(climb.point(joint)[frame, 2]) - 22.0 for joint, frame, _ in STEPS]
    end = float(climb.com[FRAMES[-1] + 8, 2]) + 60.0
    heights = [0.0, *(height for _, _, height in STEPS)]
    edges = [float(climb.com[0, 2]) - 40.0, *fronts, end]
    anchor = np.zeros(3)
    for k, height in enumerate(heights):
        near, far = edges[k], edges[k + 1]
        top = [(-WIDTH, height, near), (WIDTH, height, near), (WIDTH, height, far), (-WIDTH, height, far)]
        side = [(-WIDTH, 0.0, near), (-WIDTH, height, near), (-WIDTH, height, far), (-WIDTH, 0.0, far)]
        for corners in (top, side) if height else (top,):
            stage.area(np.array(corners), GROUND, anchor=anchor)
        if k:
            riser = [
                (x, y, near)
                for x, y in ((-WIDTH, heights[k - 1]), (WIDTH, heights[k - 1]), (WIDTH, height), (-WIDTH, height))
            ]
            stage.area(np.array(riser), GREY, anchor=anchor)


def _real(lab: Study) -> list[Table]:
    clip = None if lab.clips is None else lab.clips / "motions" / "cmu07" / "cmu_07_04_walk.bvh"
    if clip is None or not clip.exists() or lab.quick:
        return []
    constraints = stairs(clip)
    made = lab.lab.edit_prioritized(clip, {**AS_PRIO, "constraints": constraints})
    rows = (_kept(MEASURES), _kept(measured("CMU 07_04", clip, made, constraints)))
    return [Table("prio-stairs-real", "Climbing on a real walk (at a leg of 0.85 m)", rows, quoted=True)]
