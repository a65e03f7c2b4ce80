"""Packs bodies and the page's own HTML, CSS and JavaScript into one file that works from a disk."""

from __future__ import annotations

import base64
import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from motionedit.report.preview.body import Body
    from motionedit.report.preview.marks import Curve, Edit, Mark

# In the order of the page's script: each file uses what stands before it.
_SCRIPTS = ("data.js", "camera.js", "floor.js", "figure.js", "goals.js", "scene.js", "lanes.js", "controls.js")
_INT16_MAX = 32767


def page(bodies: Sequence[Body], *, title: str, edits: Sequence[Edit] = ()) -> bytes:
    """Return the whole HTML page, UTF-8; the same bytes for the same bodies and edits."""
    folder = files(__package__ or "motionedit.report.preview")
    read = {name: (folder / name).read_text("utf-8") for name in ("page.html", "style.css", *_SCRIPTS)}
    parts = {
        "{{title}}": _escaped(title),
        "{{style}}": read["style.css"],
        "{{data}}": _json([_record(body) for body in bodies]),
        "{{edits}}": _json([_edit(edit) for edit in edits]),
        "{{script}}": "".join(read[name] for name in _SCRIPTS),
    }
    # Cut at the marks of the template itself, so that a mark inside a clip's name is never filled in.
    html = read["page.html"]
    pieces: list[str] = []
    for mark in sorted(parts, key=html.index):
        before, html = html.split(mark, 1)
        pieces += (before, parts[mark])
    # Names of files need not be text.
    return "".join((*pieces, html)).encode("utf-8", "replace")


def packed(positions: NDArray[np.float64]) -> tuple[str, str, float]:
    """Return world positions as base64 text.

    Each frame's points are 16-bit steps from their own centre, so that the precision is that of the body's extent
    (0.05 mm for four metres), however far it walks; the centres are single-precision floats.

    Parameters
    ----------
    positions : shape (F, P, 3)

    Returns
    -------
    centers : str
        Little-endian float32, shape (F, 3).
    steps : str
        Little-endian int16, shape (F, P, 3).
    step : float
        Length of one step: position = center + step * steps.
    """
    low, high = positions.min(axis=1), positions.max(axis=1)
    # The stored centre, not the exact one, is what the page adds: the steps take up its rounding.
    centers = (0.5 * (low + high)).astype("<f4")
    local = positions - centers[:, None].astype(np.float64)
    step = float(np.abs(local).max()) / _INT16_MAX or 1.0
    steps = np.rint(local / step).astype("<i2")
    return _base64(centers), _base64(steps), step


def _record(body: Body) -> dict[str, Any]:
    centers, steps, step = packed(body.positions)
    return {
        "label": body.label,
        "names": body.names,
        "frames": len(body.positions),
        "frameTime": body.frame_time,
        "first": body.first,
        "limbs": [(limb.start, limb.end, *map(_short, limb.radii), limb.side[0]) for limb in body.limbs],
        "hulls": [(hull.points, tuple(map(_short, hull.radii))) for hull in body.hulls],
        "balls": [(ball.point, _short(ball.radius), ball.part) for ball in body.balls],
        "trails": body.trails,
        "size": _short(body.size),
        "forward": tuple(map(_short, body.forward)),
        "axes": body.axes,
        "scale": _short(body.scale),
        "floor": _short(body.floor),
        "centers": centers,
        "steps": steps,
        "step": step,
    }


def _edit(edit: Edit) -> dict[str, Any]:
    return {
        "clip": edit.body,
        "status": edit.status,
        "message": edit.message or "",
        "unit": edit.unit or "",
        "marks": [_mark(mark) for mark in edit.marks],
    }


def _mark(mark: Mark) -> dict[str, Any]:
    return {
        "name": mark.name,
        "kind": mark.kind,
        "symbol": mark.symbol,
        "looks": mark.looks,
        "instant": mark.instant,
        "priority": mark.priority,
        "status": mark.status,
        "gaveWayTo": mark.gave_way_to,
        "first": mark.first,
        "last": mark.last,
        "spans": [(span.mode, span.first, span.last) for span in mark.spans],
        "places": None if mark.places is None else _base64(mark.places.astype("<f4")),
        "lengths": _curve(mark.lengths),
        "angles": _curve(mark.angles),
        "points": mark.points,
    }


def _curve(curve: Curve | None) -> dict[str, Any] | None:
    if curve is None:
        return None
    tolerance = None if curve.tolerance is None else _short(curve.tolerance)
    return {"values": _base64(curve.values.astype("<f4")), "tolerance": tolerance}


def _short(value: float) -> float:
    return float(f"{value:.5g}")


def _base64(array: NDArray[Any]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")


def _json(data: object) -> str:
    # A name such as "</script>" must not end the element that holds the data.
    text = json.dumps(data, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
