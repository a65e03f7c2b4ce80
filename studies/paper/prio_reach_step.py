"""[PRIO] Figures 3 and 4: reaching, with and without the center of mass; stepping, by priorities and by weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from studies.demonstrations import config, foot_plants, reach, step
from studies.paper.comparison import SECONDS, timed
from studies.paper.drawing import BLUE, GREY, ORANGE, Camera, Stage, new_figure
from studies.paper.prio_clips import Shown, stand_over
from studies.paper.study import AS_PRIO, ROOT, Findings, Table

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study

Spec = dict[str, Any]
FINAL, LOOSE, INPUT = "final", "without CoM", "input"
PRIORITIES, WEIGHTS = "priorities", "weights"


def study(lab: Study) -> Findings:
    """Run both demonstrations on the walk of data/, and on a real walk where there is one."""
    walk = ROOT / "data" / "walk.bvh"
    reached, reach_time = _variants(lab, walk, _reaching(config("reach")))
    stepped, step_time = _variants(lab, walk, _stepping(config("step")))
    tables = [_reach_table("prio-reach", reached, "LeftHand", 69), _step_table("prio-step", stepped, "RightFoot", 56)]
    tables.append(_times(reach_time, step_time))
    pictures = {
        "prio-reach": _picture(reached, 69, goal=np.array([58.0, 150.0, 322.0]), camera=Camera(20.0, 12.0)),
        "prio-step": _picture(
            stepped, 56, goal=_lifted(reached[INPUT], "RightFoot", 56, 28.0), camera=Camera(-62.0, 10.0)
        ),
    }
    return Findings((*tables, *_real(lab)), pictures)


def _lifted(clip: Shown, joint: str, frame: int, rise: float) -> FloatArray:
    lifted: FloatArray = clip.point(joint)[frame] + np.array([0.0, rise, 0.0])
    return lifted


def _reaching(spec: Spec) -> dict[str, Spec]:
    loose = [c for c in spec["constraints"] if c["type"] != "com"]
    return {FINAL: spec, LOOSE: {**spec, "constraints": loose}}


def _stepping(spec: Spec) -> dict[str, Spec]:
    """Return the spec, and the same with the lifted ankle in the feet's own layer."""
    top = max(c["priority"] for c in spec["constraints"])
    feet = next(c["priority"] for c in spec["constraints"] if isinstance(c["effector"], list))
    level = [{**c, "priority": feet} if c["priority"] == top else c for c in spec["constraints"]]
    return {PRIORITIES: spec, WEIGHTS: {**spec, "constraints": level}}


def _variants(lab: Study, clip: Path, specs: dict[str, Spec]) -> tuple[dict[str, Shown], dict[str, float]]:
    """Return the clips that specs lead to, the input last, and the seconds each took."""
    clips, seconds = {}, {}
    for name, spec in specs.items():
        edit, seconds[name] = timed(
            lambda spec=spec: lab.lab.edit_prioritized(clip, {**spec, **AS_PRIO}), rounds=lab.rounds
        )
        clips[name] = Shown(edit.path)
    return {**clips, INPUT: Shown(clip)}, seconds


def _reach_table(name: str, clips: dict[str, Shown], hand: str, frame: int, *, quoted: bool = False) -> Table:
    """Return where hand, feet and CoM of each variant are, beside the input's."""
    source = clips[INPUT]
    scale = source.centimetres
    rows: list[tuple[str, ...]] = [
        ("variant", "hand moves", "planted feet move", "CoM off its path, most", "CoM outside the feet")
    ]
    for variant, clip in clips.items():
        moved = scale * np.linalg.norm(clip.point(hand)[frame] - source.point(hand)[frame])
        feet = scale * source.drift_of(clip)
        com = scale * np.linalg.norm(clip.com - source.com, axis=-1).max()
        cells = (f"{moved:.1f}", f"{feet:.4f}", f"{com:.2f}", f"{scale * clip.lost_balance(frame):.1f}")
        rows.append((variant, *cells))
    title = f"Figure 3: reaching, at frame {frame} (cm at a leg of 85 cm)"
    return Table(name, title, tuple(rows), quoted=quoted)


def _step_table(name: str, clips: dict[str, Shown], ankle: str, frame: int, *, quoted: bool = False) -> Table:
    source = clips[INPUT]
    scale = source.centimetres
    other = "LeftFoot" if ankle == "RightFoot" else "RightFoot"
    rows: list[tuple[str, ...]] = [("variant", "ankle rises", "toe of that foot rises", "other foot moves, most")]
    for variant, clip in clips.items():
        rise = [
            scale * float((clip.point(joint) - source.point(joint))[frame, 1])
            for joint in (ankle, ankle.replace("Foot", "ToeBase"))
        ]
        moved = scale * np.linalg.norm(clip.point(other) - source.point(other), axis=-1).max()
        rows.append((variant, *(f"{r:.1f}" for r in rise), f"{moved:.3f}"))
    title = f"Figure 4: stepping, the ankle asked higher at frame {frame} (cm at a leg of 85 cm)"
    return Table(name, title, tuple(rows), quoted=quoted)


def _times(*seconds: dict[str, float]) -> Table:
    rows: list[tuple[str, ...]] = [("edit", "the paper (s)", "ours (s)")]
    theirs = {FINAL: "9", PRIORITIES: "about as long"}
    named = {FINAL: "reaching, 145 frames", LOOSE: "the same without the CoM"}
    named |= {PRIORITIES: "stepping", WEIGHTS: "the same by weights"}
    for each in seconds:
        rows += [(named[name], theirs.get(name, ""), f"{took:.2f}") for name, took in each.items()]
    return Table("prio-seconds", SECONDS, tuple(rows), quoted=True)


def _picture(clips: dict[str, Shown], frame: int, *, goal: FloatArray, camera: Camera) -> Figure:
    figure = new_figure(10.0, 3.9)
    stage = Stage(figure.subplots(), camera)
    source = clips[INPUT]
    anchor = source.barycenter[frame] * np.array([1.0, 0.0, 1.0])
    apart = 2.3 * source.size
    for place, clip in enumerate(clips.values()):
        at = apart * place
        color = GREY if clip is source else (ORANGE, BLUE)[place]
        stand_over(source, stage, clip, frame, color, anchor=anchor, at=at)
        stage.mark(goal, "+", "#c01f2e", anchor=anchor, at=at, size=11.0)
    for place, name in enumerate(clips):
        stage.text(name, apart * place)
    stage.close(margin=0.08 * source.size)
    return figure


def _real(lab: Study) -> list[Table]:
    """Return the same tables of a real walk."""
    clip = None if lab.clips is None else lab.clips / "motions" / "cmu_12_01_walk.bvh"
    if clip is None or not clip.exists() or lab.quick:
        return []
    frame = len(Shown(clip).com) // 2
    reached, _ = _variants(lab, clip, _reaching({"constraints": [*foot_plants(clip), *reach(clip)]}))
    stepped, _ = _variants(lab, clip, _stepping({"constraints": step(clip)}))
    return [
        _reach_table("prio-reach-real", reached, "LeftHand", frame, quoted=True),
        _step_table("prio-step-real", stepped, "RightFoot", frame, quoted=True),
    ]
