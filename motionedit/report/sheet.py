"""Contact sheets: key poses of clips in rows, drawn by matplotlib as a PNG or SVG file."""

from __future__ import annotations

import io
import warnings
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from motionedit.dataclass import dataclass
from motionedit.errors import UsageError
from motionedit.report.sheet_shapes import pose_shapes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from motionedit.report.preview.body import Body

    FloatArray = NDArray[np.float64]
    IntArray = NDArray[np.intp]

_WIDTH = 12.0  # inches: 1200 pixels at 100 dots, the width of a README
_DOTS = 100  # at which fonts are measured
_PNG_DOTS = 150  # still sharp where a page is shown enlarged
_FEWEST, _MOST = 8, 12  # columns
_WIDEST = 11.0  # leg lengths in a row: a standing figure is then a fifth of the page high
_LABEL_SHARE = 0.072  # of the row's width: what a frame's number and time take
_TRAVEL = 2.0  # leg lengths on the ground: more is a walk, less is a stroke or a kick
_BACKGROUND = "#ffffff"
_QUIET, _GROUND = "#5c6670", "#c3cad2"
_GREY = "#9aa1a9"
# As in the page: apart for every kind of colour vision, and in lightness.
_HUES = ("#2a78bd", "#dc5f00", "#16936f", "#ad4f8d", "#a98000", "#5a5f66", "#6a51b5", "#a8323e")
_TOGETHER = 1.0  # leg length between the middles of two bodies that are still laid over each other
_LABEL_HEIGHT = 0.16  # of a row: the frame numbers under the ground


@dataclass(frozen=True, eq=False)
class _View:
    """Where the sheet is seen from: `right` and `back` are horizontal unit vectors (3,), up is y."""

    right: FloatArray
    back: FloatArray

    def flat(self, points: FloatArray) -> FloatArray:
        """Return (right, up, towards the eye) of points, shape (..., 3)."""
        return np.stack((points @ self.right, points[..., 1], points @ self.back), axis=-1)


@dataclass(frozen=True, eq=False)
class _Layout:
    """Where the bodies' middles stand, (columns,), the sheet's width, and the lower and upper edge of a row."""

    places: FloatArray
    width: float
    bottom: float
    top: float


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
    layout = _layout(rows, view)
    height = (layout.top - layout.bottom) * _WIDTH / layout.width
    figure = Figure(figsize=(_WIDTH, len(rows) * height), dpi=_DOTS, facecolor=_BACKGROUND)
    FigureCanvasAgg(figure)
    for r, row in enumerate(rows):
        axes = figure.add_axes((0.0, 1.0 - (r + 1) / len(rows), 1.0, 1.0 / len(rows)))
        axes.set_axis_off()
        axes.set_xlim(0.0, layout.width)
        axes.set_ylim(layout.bottom, layout.top)
        colors = [_GREY, _HUES[1]] if len(row) == 2 else [_HUES[r % len(_HUES)]]
        _draw_row(axes, row, colors, view=view, places=layout.places)
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


def _layout(rows: list[list[Body]], view: _View) -> _Layout:
    """Return as many columns as leave the figures a good size, each as wide as its widest pose."""
    size = rows[0][0].size
    for count in range(_MOST, _FEWEST - 1, -1):
        layout = _columns(rows, view, count)
        if layout.width <= _WIDEST * size:
            break
    return layout


def _columns(rows: list[list[Body]], view: _View, count: int) -> _Layout:
    size = rows[0][0].size
    left, right = np.full(count, np.inf), np.full(count, -np.inf)
    low, high = np.inf, -np.inf
    for row in rows:
        frames = key_frames(row[0], count)
        anchors = _anchors(row[0], frames, view)
        for body in row:
            flat = view.flat(body.positions[_frames_of(body, row[0], frames)])
            x = flat[..., 0] - anchors[:, None]
            left[: len(x)] = np.minimum(left[: len(x)], x.min(axis=1))
            right[: len(x)] = np.maximum(right[: len(x)], x.max(axis=1))
            low = min(low, row[0].floor, float(flat[..., 1].min()))
            high = max(high, float(flat[..., 1].max()))
    # Columns past the end of short clips are as wide as a body, so that one frame does not fill the page.
    left[np.isinf(left)], right[np.isinf(right)] = -0.4 * size, 0.4 * size
    # A label under each middle, too.
    half = 0.5 * _LABEL_SHARE * float((right - left).sum() + 0.3 * size * count)
    left, right = np.minimum(left, -half), np.maximum(right, half)
    widths = right - left + 0.3 * size
    places = np.cumsum(widths) - right - 0.15 * size
    tall = high - low + 0.45 * size
    return _Layout(places, float(widths.sum()), low - _LABEL_HEIGHT * tall, high + 0.42 * size)


def _frames_of(body: Body, reference: Body, frames: IntArray) -> IntArray:
    """Return a body's frames at the times of another's."""
    same = np.rint(frames * (reference.frame_time / body.frame_time)).astype(np.intp)
    shown: IntArray = np.minimum(same, len(body.positions) - 1)
    return shown


def _anchors(body: Body, frames: IntArray, view: _View) -> FloatArray:
    """Return what is subtracted from x so that each pose stands about its place, shape (len(frames),)."""
    middle: FloatArray = view.flat(body.positions[frames])[..., 0].mean(axis=1)
    return middle


def _draw_row(axes: Axes, row: list[Body], colors: list[str], *, view: _View, places: FloatArray) -> None:
    reference = row[0]
    frames = key_frames(reference, len(places))
    size = reference.size
    axes.axhline(reference.floor, color=_GROUND, linewidth=1.0, zorder=0)
    anchors = _anchors(reference, frames, view)
    for c, frame in enumerate(frames):
        shift = float(places[c] - anchors[c])
        for body, color in zip(row, colors, strict=True):
            own = _frames_of(body, reference, frames)
            _draw_trail(axes, body, color, view=view, until=int(own[c]), since=int(own[max(0, c - 1)]), shift=shift)
            _draw_body(axes, body, color, flat=view.flat(body.positions[own[c]]), shift=shift)
        text = f"{frame} · {frame * reference.frame_time:.2f} s"
        y = reference.floor - 0.12 * size
        axes.text(places[c], y, text, ha="center", va="top", fontsize=9, color=_QUIET, parse_math=False)
    _draw_names(axes, row, colors)


def _draw_names(axes: Axes, row: list[Body], colors: list[str]) -> None:
    corner = (axes.get_xlim()[0], axes.get_ylim()[1])
    start = 12.0
    for body, color in zip(row, colors, strict=True):
        name = axes.annotate(
            # A file's name need not be text, and XML takes no escapes.
            "".join(letter if letter.isprintable() else "?" for letter in body.label),
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
    from matplotlib.collections import PolyCollection

    shapes = pose_shapes(body, flat, color)
    axes.add_collection(
        PolyCollection(
            [shape.outline + np.array([shift, 0.0]) for shape in shapes],
            facecolors=[shape.fill for shape in shapes],
            edgecolors=[shape.edge for shape in shapes],
            linewidths=0.6,
            joinstyle="round",
            zorder=1,
        ),
        autolim=False,
    )
