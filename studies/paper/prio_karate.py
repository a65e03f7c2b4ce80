"""[PRIO] Figures 5 and 6: a kick that cannot be reached, by priorities and by weights; kicks at different heights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.demonstrations import config, karate
from studies.paper.comparison import SECONDS, timed
from studies.paper.drawing import BLUE, GREY, ORANGE, PURPLE, Camera, Stage, new_figure
from studies.paper.prio_clips import Shown, stand_over
from studies.paper.study import AS_PRIO, ROOT, Findings, Table

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study

Spec = dict[str, Any]
PRIORITIES, LOOSE, WEIGHTS, INPUT = "priorities", "without CoM", "weights", "input"
COLORS = {PRIORITIES: ORANGE, LOOSE: BLUE, WEIGHTS: PURPLE, INPUT: GREY}
AT, BEFORE = 35, 31  # the kick's frame in data/kick, and one on the way
FAR = 120.0  # cm: out of reach
HEIGHTS = (-40.0, -20.0, 0.0, 20.0, 40.0)


def study(lab: Study) -> Findings:
    """Kick out of reach, and to five heights; the former on a real kick, too."""
    kick = ROOT / "data" / "kick.bvh"
    source = Shown(kick)
    clips = _variants(lab, kick, _raised(config("karate"), FAR))
    goal = source.point("RightFoot")[AT] + np.array([0.0, FAR, 0.0])
    tables = [_table("prio-karate", clips, ("LeftFoot", "RightFoot"), AT, goal)]
    heights, seconds = _heights(lab, kick)
    tables += [_heights_table(heights, source), _seconds(seconds), *_real(lab)]
    pictures = {"prio-karate": _picture(clips, goal), "prio-heights": _heights_picture(heights, source)}
    return Findings(tuple(tables), pictures)


def _raised(spec: Spec, rise: float) -> Spec:
    constraints = [dict(c) for c in spec["constraints"]]
    constraints[-1] = {**constraints[-1], "points": [{"at": AT, "shift": [0.0, rise, 0.0]}]}
    return {**spec, "constraints": constraints}


def _variants(lab: Study, clip: Path, spec: Spec) -> dict[str, Shown]:
    constraints = spec["constraints"]
    specs = {
        PRIORITIES: constraints,
        LOOSE: [c for c in constraints if c["type"] != "com"],
        WEIGHTS: [{**c, "priority": 1} for c in constraints],
    }
    made = {
        name: lab.lab.edit_prioritized(clip, {**spec, **AS_PRIO, "constraints": each}) for name, each in specs.items()
    }
    return {**{name: Shown(edit.path) for name, edit in made.items()}, INPUT: Shown(clip)}


def _table(
    name: str,
    clips: dict[str, Shown],
    joints: tuple[str, str],
    frame: int,
    goal: FloatArray,
    *,
    quoted: bool = False,
) -> Table:
    """Return what each variant does with the goal, the support foot and the balance."""
    source, (support, kick) = clips[INPUT], joints
    scale = source.centimetres
    rows: list[tuple[str, ...]] = [
        ("variant", "short of the goal", "support foot moves, most", "CoM off P'", "CoM outside the foot")
    ]
    for variant, clip in clips.items():
        short = scale * np.linalg.norm(clip.point(kick)[frame] - goal)
        foot = scale * np.linalg.norm(clip.point(support) - source.point(support), axis=-1).max()
        com = scale * _off_balance(clip, source)
        rows.append((variant, f"{short:.1f}", f"{foot:.3f}", f"{com:.2f}", f"{scale * clip.lost_balance(frame):.1f}"))
    title = f"Figure 5: a kick out of reach, at frame {frame} (cm at a leg of 85 cm)"
    return Table(name, title, tuple(rows), quoted=quoted)


def _off_balance(clip: Shown, source: Shown) -> float:
    """Return how far the CoM is from P' of section 4.3, P moved with the barycenter of A, at most, on the level."""
    apart = (clip.com - clip.barycenter) - (source.com - source.barycenter)
    return float(np.linalg.norm(apart[:, [0, 2]], axis=-1).max())


def _heights(lab: Study, clip: Path) -> tuple[dict[float, Shown], dict[float, float]]:
    clips, seconds = {}, {}
    for rise in HEIGHTS:
        spec = _raised(config("karate"), rise)
        edit, seconds[rise] = timed(
            lambda spec=spec: lab.lab.edit_prioritized(clip, {**spec, **AS_PRIO}), rounds=lab.rounds
        )
        clips[rise] = Shown(edit.path)
    return clips, seconds


def _heights_table(heights: dict[float, Shown], source: Shown) -> Table:
    scale = source.centimetres
    rows: list[tuple[str, ...]] = [("asked", "risen", "left", "support foot moves, most", "CoM off P'")]
    for rise, clip in heights.items():
        moved = clip.point("RightFoot")[AT] - source.point("RightFoot")[AT]
        left = np.linalg.norm(moved - np.array([0.0, rise, 0.0]))
        foot = np.linalg.norm(clip.point("LeftFoot") - source.point("LeftFoot"), axis=-1).max()
        com = _off_balance(clip, source)
        cells = (
            f"{round(scale * moved[1], 1) + 0.0:+.1f}",
            f"{scale * left:.2f}",
            f"{scale * foot:.4f}",
            f"{scale * com:.4f}",
        )
        rows.append((f"{scale * rise:+.1f}", *cells))
    return Table("prio-heights", "Figure 6: the ankle at other heights (cm at a leg of 85 cm)", tuple(rows))


def _seconds(seconds: dict[float, float]) -> Table:
    rows: list[tuple[str, ...]] = [("edit", "the paper (s)", "ours (s)"), ("a kick, median of five heights", "< 2")]
    rows[1] = (*rows[1], f"{np.median(list(seconds.values())):.2f}")
    return Table("prio-karate-seconds", SECONDS, tuple(rows), quoted=True)


def _picture(clips: dict[str, Shown], goal: FloatArray) -> Figure:
    figure = new_figure(10.0, 5.9)
    source = clips[INPUT]
    apart = 2.1 * source.size
    for axes, frame in zip(figure.subplots(2, 1), (BEFORE, AT), strict=True):
        stage = Stage(axes, Camera(-68.0, 8.0))
        anchor = source.point("LeftFoot")[frame] * np.array([1.0, 0.0, 1.0])
        for place, (name, clip) in enumerate(clips.items()):
            at = apart * place
            stand_over(source, stage, clip, frame, COLORS[name], anchor=anchor, at=at)
            stage.mark(goal, "+", "#c01f2e", anchor=anchor, at=at, size=10.0)
        for place, name in enumerate(clips):
            stage.text(name, apart * place)
        axes.set_title(f"frame {frame}")
        stage.close(margin=0.06 * source.size)
    return figure


def _heights_picture(heights: dict[float, Shown], source: Shown) -> Figure:
    figure = new_figure(10.0, 3.3)
    stage, apart = Stage(figure.subplots(), Camera(-68.0, 8.0)), 1.75 * source.size
    anchor = source.point("LeftFoot")[AT] * np.array([1.0, 0.0, 1.0])
    for place, (rise, clip) in enumerate(heights.items()):
        at = apart * place
        stand_over(source, stage, clip, AT, ORANGE, anchor=anchor, at=at)
        goal = source.point("RightFoot")[AT] + np.array([0.0, rise, 0.0])
        stage.mark(goal, "+", "#c01f2e", anchor=anchor, at=at, size=9.0)
    for place, rise in enumerate(heights):
        stage.text(f"{rise:+.0f} cm", apart * place)
    stage.close(margin=0.06 * source.size)
    return figure


def _real(lab: Study) -> list[Table]:
    clip = None if lab.clips is None else lab.clips / "motions" / "karate_mawashi_geri_left_1.bvh"
    if clip is None or not clip.exists() or lab.quick:
        return []
    constraints = karate(clip)
    source = Shown(clip)
    support, kick = constraints[0]["effector"], constraints[-1]["effector"]
    frame = constraints[-1]["points"][0]["at"]
    rise = 0.5 * source.size * source.facts.up
    constraints[-1] = {**constraints[-1], "points": [{"at": frame, "shift": rise.tolist()}]}
    clips = _variants(lab, clip, {"constraints": constraints})
    return [_table("prio-karate-real", clips, (support, kick), frame, source.point(kick)[frame] + rise, quoted=True)]
