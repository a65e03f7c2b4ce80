"""How the papers' figures are drawn: bodies seen by a camera, plots in one style, files of the same bytes."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from motionedit.core.bvh import read_clip
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.preview.bodies import body_of
from motionedit.report.sheet_shapes import pose_shapes

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from motionedit.core.arrays import FloatArray
    from motionedit.report.preview.body import Body

# The input is grey and the edit orange, as in the other pages; what is set beside them, the other two.
GREY, ORANGE, BLUE, GREEN, PURPLE = "#9aa1a9", "#dc5f00", "#2a78bd", "#16936f", "#6a51b5"
INK, QUIET, GROUND, PALE = "#2b3138", "#5c6670", "#c3cad2", "#eceff2"
STYLES = ("#2a78bd", "#16936f", "#ad4f8d")
_DOTS = 140
_LINE = 0.065  # of a stage's height: what a line of text below it takes
_COLORS = 160  # of a picture's palette: half the bytes, and no difference to be seen
_STYLE = {
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": PALE,
    "text.color": INK,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.6,
    "svg.hashsalt": "motionedit",
}


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure in the papers' style, in inches."""
    mpl.rcParams.update(_STYLE)
    figure = Figure(figsize=(width, height), dpi=_DOTS, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def png_bytes(figure: Figure) -> bytes:
    """Return the picture as a small PNG file; the same bytes for the same figure and matplotlib."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=_DOTS, metadata={"Software": None}, bbox_inches="tight", pad_inches=0.08)
    picture = Image.open(stream).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    out = io.BytesIO()
    picture.save(out, format="PNG", optimize=True)
    return out.getvalue()


def body(path: Path) -> Body:
    """Return a clip's body, ready to draw."""
    return body_of(facts_of(read_clip(path)), label=path.stem)


@dataclass(frozen=True)
class Camera:
    """Where a body is seen from: degrees from +z towards +x, and above the horizon."""

    azimuth: float
    elevation: float = 8.0

    def flat(self, points: FloatArray) -> FloatArray:
        """Return (right, up, towards the eye) of points, shape (..., 3)."""
        a, e = np.radians([self.azimuth, self.elevation])
        right = np.array([np.cos(a), 0.0, -np.sin(a)])
        towards = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
        up = np.array([-np.sin(e) * np.sin(a), np.cos(e), -np.sin(e) * np.cos(a)])
        flat: FloatArray = points @ np.stack((right, up, towards), axis=-1)
        return flat


class Stage:
    """Axes on which bodies stand: each group is drawn about an anchor (3,) of its own, moved to `at` on the page."""

    def __init__(self, axes: Axes, camera: Camera) -> None:
        self.axes, self.camera = axes, camera
        self._low, self._high = np.full(2, np.inf), np.full(2, -np.inf)
        axes.set_axis_off()
        axes.set_aspect("equal")

    def place(self, points: FloatArray, anchor: FloatArray, at: float) -> FloatArray:
        """Return where world points are on the page, shape (..., 3), and let them be seen."""
        flat = self.camera.flat(points) - np.append(self.camera.flat(anchor)[:2], 0.0) + np.array([at, 0.0, 0.0])
        self._see(flat[..., :2].reshape(-1, 2))
        return flat

    def _see(self, flat: FloatArray) -> None:
        self._low = np.minimum(self._low, flat.min(axis=0))
        self._high = np.maximum(self._high, flat.max(axis=0))

    def pose(
        self, who: Body, frame: int, color: str, *, anchor: FloatArray, at: float = 0.0, alpha: float = 1.0
    ) -> None:
        """Draw a body at a frame."""
        shapes = pose_shapes(who, self.place(who.positions[frame], anchor, at), color)
        self._see(np.concatenate([shape.outline for shape in shapes]))
        self.axes.add_collection(
            PolyCollection(
                [shape.outline for shape in shapes],
                facecolors=[shape.fill for shape in shapes],
                edgecolors=[shape.edge for shape in shapes],
                linewidths=0.5,
                alpha=alpha,
                zorder=3.0,
            ),
            autolim=False,
        )

    def floor(self, anchor: FloatArray, at: float, *, half: tuple[float, float], step: float) -> None:
        """Draw a piece of the floor (up = 0) about the anchor, `half` its size along x and z."""
        x, z = (np.arange(-np.floor(h / step), np.floor(h / step) + 1) * step for h in half)
        centre = np.array([anchor[0], 0.0, anchor[2]])
        ends = [np.array([[a, 0.0, z[0]], [a, 0.0, z[-1]]]) for a in x]
        ends += [np.array([[x[0], 0.0, b], [x[-1], 0.0, b]]) for b in z]
        lines = [self.place(centre + pair, anchor, at)[:, :2] for pair in ends]
        self.axes.add_collection(LineCollection(lines, colors=PALE, linewidths=0.8, zorder=0.0), autolim=False)

    def path(self, points: FloatArray, color: str, *, anchor: FloatArray, at: float = 0.0, width: float = 1.2) -> None:
        """Draw a path of world points."""
        flat = self.place(points, anchor, at)
        self.axes.plot(flat[:, 0], flat[:, 1], color=color, linewidth=width, zorder=2.0)

    def area(self, points: FloatArray, color: str, *, anchor: FloatArray, at: float = 0.0) -> None:
        """Fill a polygon of world points, such as a support or a step."""
        flat = self.place(points, anchor, at)
        self.axes.fill(flat[:, 0], flat[:, 1], facecolor=color, alpha=0.35, edgecolor=color, linewidth=0.8, zorder=1.0)

    def mark(
        self, point: FloatArray, marker: str, color: str, *, anchor: FloatArray, at: float = 0.0, size: float = 7.0
    ) -> None:
        """Draw a mark at a world point: a ball, a goal, a center of mass."""
        flat = self.place(point, anchor, at)
        thin = marker in {"+", "x"}
        self.axes.plot(
            *flat[:2],
            marker,
            markersize=size,
            color=color,
            markeredgecolor=color if thin else INK,
            markeredgewidth=2.0 if thin else 0.8,
            zorder=4.0,
        )

    def text(self, words: str, at: float, *, color: str = INK) -> None:
        """Write words under a group; each line takes its room."""
        self.axes.annotate(
            words,
            (at, self._low[1]),
            (0.0, -4.0),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=9,
            color=color,
        )

    def close(self, *, margin: float, lines: int = 1) -> None:
        """Set the limits so that all that was drawn is seen, with room for lines of text below."""
        line = _LINE * (self._high[1] - self._low[1])
        self.axes.set_xlim(self._low[0] - margin, self._high[0] + margin)
        self.axes.set_ylim(self._low[1] - lines * line - margin, self._high[1] + 0.4 * margin)


def hull(points: FloatArray) -> FloatArray:
    """Return the convex outline of points on the ground, shape (N, 3), up = 0."""
    from scipy.spatial import ConvexHull

    level = points[:, [0, 2]]
    outline = level[ConvexHull(level).vertices]
    return np.stack((outline[:, 0], np.zeros(len(outline)), outline[:, 1]), axis=-1)


def outside(point: FloatArray, outline: FloatArray) -> float:
    """Return how far a point is outside a convex outline on the ground; 0 inside. Both as `hull` returns them."""
    p, corners = point[[0, 2]], outline[:, [0, 2]]
    after = np.roll(corners, -1, axis=0)
    along = after - corners
    cross = along[:, 0] * (p - corners)[:, 1] - along[:, 1] * (p - corners)[:, 0]
    if np.all(cross >= 0.0) or np.all(cross <= 0.0):
        return 0.0
    share = np.clip(np.sum((p - corners) * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
    return float(np.linalg.norm(corners + share[:, None] * along - p, axis=1).min())
