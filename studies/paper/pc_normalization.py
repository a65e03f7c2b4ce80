"""[PC] Figure 4: the clips as recorded, of one duration, and with the hit at one frame; and what that is good for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.bvh import read_clip
from studies.paper.drawing import INK, STYLES, new_figure
from studies.paper.study import GOLF, Findings, Table, club_head

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study


def study(lab: Study) -> Findings:
    """Normalize the ten swings in two stages, and rebuild each by the others."""
    raw = [club_head(clip) for clip in lab.swings]
    stages = {"as recorded": (raw, np.array(lab.hits, dtype=float))}
    for name, spec in (("one duration", {}), ("the hit at one frame", GOLF)):
        folder = lab.lab.normalized(lab.swings, spec)
        paths = [club_head(folder / clip.name) for clip in lab.swings]
        stages[name] = (paths, _hits(lab, paths))
    return Findings((_stages(stages), _rebuilt(lab)), {"pc-normalization": _figure(lab, stages)})


def _hits(lab: Study, paths: Sequence[FloatArray]) -> FloatArray:
    """Return the frame of each normalized hit: where the head's path comes nearest to its place at the recorded one."""
    frames = []
    for clip, hit, path in zip(lab.swings, lab.hits, paths, strict=True):
        share = hit / (len(read_clip(clip).motion) - 1)
        around = round(share * (len(path) - 1))
        window = np.arange(around - 10, around + 11)
        distance = np.linalg.norm(path[window] - club_head(clip)[hit], axis=1)
        frames.append(_lowest(window, distance**2))
    return np.array(frames)


def _lowest(frames: FloatArray, values: FloatArray) -> float:
    """Return where a parabola through the lowest of the values and its neighbours is lowest."""
    k = int(np.clip(np.argmin(values), 1, len(values) - 2))
    a, b, c = values[k - 1 : k + 2]
    return float(frames[k] + 0.5 * (a - c) / (a - 2.0 * b + c))


def _stages(stages: dict[str, tuple[list[FloatArray], FloatArray]]) -> Table:
    rows: list[tuple[str, ...]] = [
        ("stage", "frames", "hit at frame", "spread of the hit", "club head at the mean hit: spread (cm)")
    ]
    for name, (paths, hits) in stages.items():
        frames = [len(path) for path in paths]
        many = f"{min(frames)} to {max(frames)}" if len(set(frames)) > 1 else str(frames[0])
        at = round(float(np.mean(hits)))
        there = np.array([path[at] for path in paths])
        apart = np.sqrt(np.mean(np.sum((there - there.mean(axis=0)) ** 2, axis=1)))
        rows.append((name, many, f"{np.mean(hits):.1f}", f"{np.ptp(hits):.1f}", f"{apart:.1f}"))
    return Table("pc-normalization", "Figure 4: ten swings on their way to one timeline", tuple(rows))


def _rebuilt(lab: Study) -> Table:
    """Return how well a swing is rebuilt by a model that does not know it, normalized with more and less care."""
    ways: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
        "duration alone": ({"events": {}}, {}),
        "duration and hit (the tool)": (GOLF, {}),
        "the same, exponential maps as in the paper": (GOLF, {"rotation": "exponential"}),
    }
    chosen = range(2) if lab.quick else range(len(lab.swings))
    rows: list[tuple[str, ...]] = [("normalized by", "at the hit, mean (cm)", "worst", "all frames, mean")]
    for name, (normalize, fit) in ways.items():
        errors = np.array([_left_out(lab, swing, normalize, fit) for swing in chosen])
        rows.append((name, f"{errors[:, 0].mean():.2f}", f"{errors[:, 0].max():.2f}", f"{errors[:, 1].mean():.2f}"))
    title = "The club head of a swing rebuilt by the components of the nine others, 8 components"
    return Table("pc-left-out", title, tuple(rows))


def _left_out(lab: Study, swing: int, normalize: dict[str, Any], fit: dict[str, Any]) -> tuple[float, float]:
    """Return the error (cm) at the hit, and over all frames, of a swing rebuilt in its own timing."""
    clip = lab.swings[swing]
    model = lab.lab.model([other for other in lab.swings if other != clip], normalize, fit=fit)
    events = GOLF if normalize.get("events") else {}
    spec = {"goals": [], "residual": "drop", "components": 8, **events}
    errors = np.linalg.norm(club_head(lab.lab.edit(clip, model, spec).path) - club_head(clip), axis=1)
    return float(errors[lab.hits[swing]]), float(errors.mean())


def _figure(lab: Study, stages: dict[str, tuple[list[FloatArray], FloatArray]]) -> Figure:
    figure = new_figure(10.0, 3.2)
    panels = figure.subplots(1, 3, sharey=True)
    for letter, axes, (name, (paths, hits)) in zip("abc", panels, stages.items(), strict=True):
        _panel(axes, lab, paths, hits)
        axes.set_title(f"({letter}) {name}")
    panels[0].set_ylabel("height of the club head (cm)")
    return figure


def _panel(axes: Axes, lab: Study, paths: Sequence[FloatArray], hits: FloatArray) -> None:
    seen = set()
    for style, path, hit in zip(lab.styles, paths, hits, strict=True):
        color, label = STYLES[style - 1], None if style in seen else f"style {style}"
        seen.add(style)
        axes.plot(path[:, 1], color=color, linewidth=1.0, alpha=0.85, label=label)
        axes.plot(hit, np.interp(hit, np.arange(len(path)), path[:, 1]), "o", color=color, markersize=4)
    axes.axvline(float(np.mean(hits)), color=INK, linewidth=0.8, linestyle=":")
    axes.set_xlabel("frame")
    if len({len(path) for path in paths}) > 1:
        axes.legend(loc="upper left")
