"""One pose as flat shapes from far to near: what a contact sheet draws of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.report.preview.body import Body, Limb, Side

    FloatArray = NDArray[np.float64]

_ROUND = np.linspace(0.5 * np.pi, 1.5 * np.pi, 9)
_Color = tuple[float, ...]


class Shape(NamedTuple):
    """A filled outline, shape (N, 2), with red, green and blue from 0 to 1."""

    outline: FloatArray
    fill: _Color
    edge: _Color


def pose_shapes(body: Body, flat: FloatArray, color: str) -> list[Shape]:
    """Return the shapes of one pose, in the order in which to draw them.

    Parameters
    ----------
    flat : shape (P, 3)
        The body's points: right, up, towards the eye.
    color : str
        Such as ``#2a78bd``; the left side is drawn paler, the right side deeper.
    """
    found: list[tuple[float, FloatArray, Side]] = []
    for limb in body.limbs:
        a, b = flat[limb.start], flat[limb.end]
        found.append((float(a[2] + b[2]) / 2.0, _limb_outline(a[:2], b[:2], limb), limb.side))
    for hull in body.hulls:
        points = flat[list(hull.points)]
        # Pushed back a little: an arm at the side lies before the chest.
        depth = float(points[:, 2].mean()) - 0.03 * body.size
        found.append((depth, _hull_outline(points[:, :2], np.array(hull.radii)), "middle"))
    for ball in body.balls:
        outline = _hull_outline(flat[[ball.point], :2], np.array([ball.radius]))
        found.append((float(flat[ball.point, 2]), outline, "right" if ball.part == "nose" else "middle"))
    found.sort(key=lambda shape: shape[0])
    tones = {side: _tones(color, side) for side in ("left", "middle", "right")}
    return [Shape(outline, *tones[side]) for _, outline, side in found]


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


def _tones(color: str, side: Side) -> tuple[_Color, _Color]:
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
