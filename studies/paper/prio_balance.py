"""[PRIO] Figure 1: the paths of a walk's center of mass and of the barycenter of A, and one seen from the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from studies.paper.drawing import BLUE, INK, ORANGE, new_figure
from studies.paper.prio_clips import Shown
from studies.paper.study import ROOT, Findings, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from motionedit.core.arrays import FloatArray
    from studies.paper.study import Study


def study(lab: Study) -> Findings:
    """Measure the walk of data/, and a real one where there is one."""
    walks = {"data/walk": Shown(ROOT / "data" / "walk.bvh")}
    tables = [_table("prio-balance", walks)]
    real = None if lab.clips is None else lab.clips / "motions" / "cmu_12_01_walk.bvh"
    if real is not None and real.exists():
        walks["CMU 12_01"] = Shown(real)
        tables.append(_table("prio-balance-real", {"CMU 12_01": walks["CMU 12_01"]}, quoted=True))
    return Findings(tuple(tables), {"prio-balance": _figure(walks)})


def _aside(clip: Shown) -> tuple[FloatArray, FloatArray]:
    """Return the CoM and the barycenter, each (F, 2): along the walk and to its left, cm at a leg of 85 cm."""
    first = clip.facts.first
    com, mean = clip.com[first:], clip.barycenter[first:]
    ahead = (com[-1] - com[0]) * np.array([1.0, 0.0, 1.0])
    ahead /= np.linalg.norm(ahead)
    left = np.cross([0.0, 1.0, 0.0], ahead)
    centimetres = clip.centimetres
    flat = [centimetres * (path - com[0]) @ np.stack((ahead, left), axis=1) for path in (com, mean)]
    return flat[0], flat[1]


def _swayed(way: FloatArray) -> FloatArray:
    """Return a coordinate over the frames without its even travel, shape (F,)."""
    frames = np.arange(len(way))
    swayed: FloatArray = way - np.polyval(np.polyfit(frames, way, 1), frames)
    return swayed


def _table(name: str, walks: dict[str, Shown], *, quoted: bool = False) -> Table:
    rows: list[tuple[str, ...]] = [
        ("walk", "axis", "CoM sways over", "barycenter sways over", "displacement, least to most")
    ]
    for walk, clip in walks.items():
        com, mean = _aside(clip)
        for k, axis in ((1, "sideways"), (0, "along")):
            ways = [_swayed(path[:, k]) for path in (com, mean)]
            apart = com[:, k] - mean[:, k]
            cells = (f"{np.ptp(way):.1f}" for way in ways)
            rows.append((walk, axis, *cells, f"{apart.min():.1f} to {apart.max():.1f}"))
    title = "Figure 1: the CoM and the barycenter of A, ankles and toes (cm at a leg of 85 cm, even travel taken away)"
    return Table(name, title, tuple(rows), quoted=quoted)


def _figure(walks: dict[str, Shown]) -> Figure:
    figure = new_figure(10.0, 2.9 * len(walks))
    grid = figure.subplots(len(walks), 2, squeeze=False, width_ratios=(1.7, 1.0))
    for (name, clip), (left, right) in zip(walks.items(), grid, strict=True):
        com, mean = _aside(clip)
        left.plot(mean[:, 0], mean[:, 1], color=BLUE, label="barycenter of A")
        left.plot(com[:, 0], com[:, 1], color=ORANGE, label="center of mass")
        left.set_title(f"{name}: paths on the ground")
        left.set_xlabel("along the walk (cm)")
        left.set_ylabel("to the left (cm)")
        left.legend(loc="best", ncols=2)
        apart = com - mean
        right.plot(apart[:, 0], apart[:, 1], color=INK, linewidth=1.0)
        right.plot(*apart[0], "o", color=ORANGE, markersize=5, label="first frame")
        right.set_title("CoM less barycenter")
        right.set_xlabel("along (cm)")
        right.set_ylabel("to the left (cm)")
        right.legend(loc="best")
    return figure
