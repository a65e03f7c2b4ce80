"""Contact sheets: key poses of clips in rows, drawn by matplotlib as a PNG or SVG file."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from motionedit.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from motionedit.report.preview.body import Body, Limb, Side

    FloatArray = NDArray[np.float64]
    IntArray = NDArray[np.intp]

_WIDTH = 12.0  # inches: 1200 pixels at 100 dots, the width of a README
_DOTS = 100  # at which fonts are measured
_PNG_DOTS = 150  # still sharp where a page is shown enlarged
_FEWEST, _MOST = 8, 12  # columns
_TRAVEL = 2.0  # leg lengths on the ground: more is a walk, less is a stroke or a kick
_BACKGROUND = "#ffffff"
_QUIET, _GROUND = "#5c6670", "#c3cad2"
_GREY = "#9aa1a9"
# As in the page: apart for every kind of colour vision, and in lightness.
_HUES = ("#2a78bd", "#dc5f00", "#16936f", "#ad4f8d", "#a98000", "#5a5f66", "#6a51b5", "#a8323e")
_TOGETHER = 1.0  # leg length between the middles of two bodies that are still laid over each other
_LABEL_HEIGHT = 0.16  # of a row: the frame numbers under the ground
_ROUND = np.linspace(0.5 * np.pi, 1.5 * np.pi, 9)


@dataclass(frozen=True, eq=False)
class _View:
    """Where the sheet is seen from: `right` and `back` are horizontal unit vectors (3,), up is y."""

    right: FloatArray
    back: FloatArray

    def flat(self, points: FloatArray) -> FloatArray:
        """Return (right, up, towards the eye) of points, shape (..., 3)."""
        return np.stack((points @ self.right, points[..., 1], points @ self.back), axis=-1)


def need_matplotlib() -> None:
    """Raise a UsageError where matplotlib is not installed."""
    if find_spec("matplotlib") is None:
        raise UsageError("a .png or .svg sheet needs matplotlib: pip install 'motionedit[plot]'; .html needs nothing")


def sheet(bodies: Sequence[Body], kind: Literal["png", "svg"]) -> bytes:
    """Return a contact sheet; the same bytes for the same bodies and matplotlib.

    One row per clip; two clips that keep together are overlaid in one row, the first in grey. All figures have one
    scale, each column is one key pose: evenly spaced in half of time and half of movement, so that fast parts get
    more of them.
    """
    need_matplotlib()
    import matplotlib as mpl

    with warnings.catch_warnings(), mpl.rc_context({"svg.hashsalt": "motionedit", "svg.fonttype": "path"}):
        # A clip's name may hold letters that the font lacks: boxes in a label are no reason to fail.
        warnings.filterwarnings("ignore", message="Glyph")
        stream = io.BytesIO()
        metadata: dict[str, Any] = {"Software": None} if kind == "png" else {"Date": None, "Creator": "motionedit"}
        _figure(bodies).savefig(stream, format=kind, dpi=_PNG_DOTS, metadata=metadata, facecolor=_BACKGROUND)
    return stream.getvalue()


def _figure(bodies: Sequence[Body]) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = [list(bodies)] if _is_pair(bodies) else [[body] for body in bodies]
    view = _view(bodies[0])
    columns, half_width, bottom, top = _layout(bodies, rows, view)
    height = (top - bottom) * _WIDTH / (2.0 * half_width * columns)
    figure = Figure(figsize=(_WIDTH, len(rows) * height), dpi=_DOTS, facecolor=_BACKGROUND)
    FigureCanvasAgg(figure)
    for r, row in enumerate(rows):
        axes = figure.add_axes((0.0, 1.0 - (r + 1) / len(rows), 1.0, 1.0 / len(rows)))
        axes.set_axis_off()
        axes.set_xlim(-half_width, (2 * columns - 1) * half_width)
        axes.set_ylim(bottom, top)
        colors = [_GREY, _HUES[1]] if len(row) == 2 else [_HUES[r % len(_HUES)]]
        _draw_row(axes, row, colors, view=view, columns=columns, cell=2.0 * half_width)
    return figure


def key_frames(body: Body, count: int) -> IntArray:
    """Return `count` frames, the first and the last among them, denser where the body moves faster, shape (count,).

    Fewer where the clip has fewer frames.
    """
    local = body.positions[body.first :] - body.positions[body.first :].mean(axis=1, keepdims=True)
    steps = np.linalg.norm(np.diff(local, axis=0), axis=-1).mean(axis=1)
    moved = np.concatenate(([0.0], np.cumsum(steps)))
    time = np.linspace(0.0, 1.0, len(moved))
    progress = 0.5 * time + 0.5 * (moved / moved[-1] if moved[-1] > 0.0 else time)
    wanted = np.linspace(0.0, progress[-1], min(count, len(moved)))
    nearest = np.unique(np.argmin(np.abs(progress[:, None] - wanted), axis=0))
    frames: IntArray = nearest + body.first
    return frames


def _view(body: Body) -> _View:
    """Return the view from which the body shows most.

    A clip that travels is seen from its side and goes to the right; one that stays where it is, from where its hands
    and feet spread widest, from the front where there is a choice.
    """
    positions = body.positions[body.first :][..., [0, 2]]
    centers = positions.mean(axis=1)
    front = np.array([body.forward[0], body.forward[2]])
    if np.linalg.norm(np.ptp(centers, axis=0)) > _TRAVEL * body.size:
        right = _main_axis(centers - centers.mean(axis=0))
        right *= np.sign(right @ (centers[-1] - centers[0])) or 1.0
    else:
        ends = sorted({limb.end for limb in body.limbs} - {limb.start for limb in body.limbs})
        spread = (positions - centers[:, None])[:, ends].reshape(-1, 2)
        right = _main_axis(spread - spread.mean(axis=0)) if ends else np.array([front[1], -front[0]])
        back = np.array([-right[1], right[0]])
        # In profile the character looks to the right; otherwise its front is seen.
        profile = abs(right @ front) > abs(back @ front)
        right *= np.sign(right @ front if profile else back @ front) or 1.0
    return _View(right=np.array([right[0], 0.0, right[1]]), back=np.array([-right[1], 0.0, right[0]]))


def _is_pair(bodies: Sequence[Body]) -> bool:
    """Tell whether these are two clips whose bodies stay so near that they can be laid over each other."""
    if len(bodies) != 2:
        return False
    first, second = bodies
    frames = key_frames(first, _MOST)
    centers = first.positions[frames].mean(axis=1) - second.positions[_frames_of(second, first, frames)].mean(axis=1)
    return float(np.linalg.norm(centers, axis=-1).max()) < _TOGETHER * first.size


def _main_axis(points: FloatArray) -> FloatArray:
    """Return the unit direction in which centred points (N, 2) spread most, shape (2,)."""
    axis: FloatArray = np.linalg.eigh(points.T @ points)[1][:, -1]
    return axis


def _layout(bodies: Sequence[Body], rows: list[list[Body]], view: _View) -> tuple[int, float, float, float]:
    """Return the number of columns, half a cell's width, and the lower and upper edge of a row (lengths)."""
    low, high, half = np.inf, -np.inf, 0.0
    for row in rows:
        for body in row:
            frames = key_frames(row[0], _MOST)
            flat = view.flat(body.positions[_frames_of(body, row[0], frames)])
            flat[..., 0] -= _anchors(row[0], frames, view)[:, None]
            half = max(half, float(np.abs(flat[..., 0]).max()))
            low = min(low, row[0].floor, float(flat[..., 1].min()))
            high = max(high, float(flat[..., 1].max()))
    size = bodies[0].size
    half += 0.12 * size
    # As many columns as leave a figure a good part of its row's height.
    columns = int(np.clip(12 * 0.45 * size / half, _FEWEST, _MOST))
    tall = high - low + 0.45 * size
    return columns, half, low - _LABEL_HEIGHT * tall, high + 0.42 * size


def _frames_of(body: Body, reference: Body, frames: IntArray) -> IntArray:
    """Return a body's frames at the times of another's."""
    same = np.rint(frames * (reference.frame_time / body.frame_time)).astype(np.intp)
    shown: IntArray = np.minimum(same, len(body.positions) - 1)
    return shown


def _anchors(body: Body, frames: IntArray, view: _View) -> FloatArray:
    """Return what is subtracted from x so that each figure stands in the middle of its cell, shape (len(frames),)."""
    x = view.flat(body.positions[frames])[..., 0]
    middle: FloatArray = 0.5 * (x.min(axis=1) + x.max(axis=1))
    return middle


def _draw_row(axes: Axes, row: list[Body], colors: list[str], *, view: _View, columns: int, cell: float) -> None:
    reference = row[0]
    frames = key_frames(reference, columns)
    size = reference.size
    axes.axhline(reference.floor, color=_GROUND, linewidth=1.0, zorder=0)
    anchors = _anchors(reference, frames, view)
    for c, frame in enumerate(frames):
        shift = c * cell - anchors[c]
        for body, color in zip(row, colors, strict=True):
            own = _frames_of(body, reference, frames)
            _draw_trail(axes, body, color, view=view, until=int(own[c]), since=int(own[max(0, c - 1)]), shift=shift)
            _draw_body(axes, body, color, flat=view.flat(body.positions[own[c]]), shift=shift)
        text = f"{frame} · {frame * reference.frame_time:.2f} s"
        y = reference.floor - 0.12 * size
        axes.text(c * cell, y, text, ha="center", va="top", fontsize=9, color=_QUIET, parse_math=False)
    _draw_names(axes, row, colors)


def _draw_names(axes: Axes, row: list[Body], colors: list[str]) -> None:
    corner = (axes.get_xlim()[0], axes.get_ylim()[1])
    start = 12.0
    for body, color in zip(row, colors, strict=True):
        name = axes.annotate(
            body.label,
            corner,
            (start, -8.0),
            textcoords="offset points",
            ha="left",
            va="top",
            fontsize=10,
            fontweight="bold",
            color=_QUIET if color == _GREY else color,
            parse_math=False,
        )
        start += name.get_window_extent().width * 72.0 / _DOTS + 18.0


def _draw_trail(axes: Axes, body: Body, color: str, *, view: _View, until: int, since: int, shift: float) -> None:
    """Draw the way of the trailed points since the column before, thin at its beginning."""
    for point in body.trails:
        path = view.flat(body.positions[since : until + 1, point])
        axes.plot(path[:, 0] + shift, path[:, 1], color=color, linewidth=1.1, alpha=0.75, zorder=0.5)


def _draw_body(axes: Axes, body: Body, color: str, *, flat: FloatArray, shift: float) -> None:
    """Draw one pose, its shapes from far to near."""
    from matplotlib.collections import PolyCollection

    tones = {side: _tones(color, side) for side in ("left", "middle", "right")}
    shapes: list[tuple[float, FloatArray, Side]] = []
    for limb in body.limbs:
        a, b = flat[limb.start], flat[limb.end]
        shapes.append((float(a[2] + b[2]) / 2.0, _limb_outline(a[:2], b[:2], limb), limb.side))
    for hull in body.hulls:
        points = flat[list(hull.points)]
        # Pushed back a little: an arm at the side lies before the chest.
        depth = float(points[:, 2].mean()) - 0.03 * body.size
        shapes.append((depth, _hull_outline(points[:, :2], np.array(hull.radii)), "middle"))
    for ball in body.balls:
        outline = _hull_outline(flat[[ball.point], :2], np.array([ball.radius]))
        shapes.append((float(flat[ball.point, 2]), outline, "right" if ball.part == "nose" else "middle"))
    shapes.sort(key=lambda shape: shape[0])
    axes.add_collection(
        PolyCollection(
            [outline + np.array([shift, 0.0]) for _, outline, _ in shapes],
            facecolors=[tones[side][0] for _, _, side in shapes],
            edgecolors=[tones[side][1] for _, _, side in shapes],
            linewidths=0.6,
            joinstyle="round",
            zorder=1,
        ),
        autolim=False,
    )


def _limb_outline(a: FloatArray, b: FloatArray, limb: Limb) -> FloatArray:
    """Return the outline of a tapered limb between two flat points, shape (N, 2)."""
    axis = b - a
    length = float(np.hypot(*axis))
    if length <= abs(limb.radii[0] - limb.radii[1]):
        bigger, radius = (a, limb.radii[0]) if limb.radii[0] > limb.radii[1] else (b, limb.radii[1])
        return _hull_outline(bigger[None], np.array([radius]))
    u, v = axis / length, np.array([-axis[1], axis[0]]) / length
    arc = np.cos(_ROUND)[:, None] * u + np.sin(_ROUND)[:, None] * v
    outline: FloatArray = np.concatenate((a + limb.radii[0] * arc, b - limb.radii[1] * arc))
    return outline


def _hull_outline(points: FloatArray, radii: FloatArray) -> FloatArray:
    """Return the convex outline round circles, shape (N, 2)."""
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    cloud = (points[:, None] + radii[:, None, None] * circle).reshape(-1, 2)
    # The support point in each of many directions: all that shows of the hull at this size.
    directions = np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
    normals = np.stack((np.cos(directions), np.sin(directions)))
    outline: FloatArray = cloud[np.argmax(cloud @ normals, axis=0)]
    return outline


def _tones(color: str, side: Side) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return fill and edge of a side: pale on the left, deep on the right."""
    base = np.array([int(color[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    white, black = np.ones(3), np.array([0.03, 0.05, 0.07])
    fill = {
        "left": 0.32 * base + 0.68 * white,
        "middle": 0.82 * base + 0.18 * white,
        "right": 0.66 * base + 0.34 * black,
    }
    edge = {"left": base, "middle": 0.7 * base + 0.3 * black, "right": 0.4 * base + 0.6 * black}
    return tuple(fill[side].tolist()), tuple(edge[side].tolist())
