"""Rotations between two others: spherical interpolation along the shorter arc."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.rotations import parts_of

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray

# Tangent of half an arc below which a line will do for it: there sin(x) is x to the last bit.
_STRAIGHT = 0.5e-8


def slerp(a: FloatArray, b: FloatArray, t: FloatArray) -> FloatArray:
    """Return the rotation at fraction t of the shorter arc from a to b, shape (..., 4); t has shape (...)."""
    aw, ax, ay, az = parts_of(a)
    bw, bx, by, bz = parts_of(b)
    cosine = aw * bw + ax * bx + ay * by + az * bz
    whole, rest, way = _arc_tangents(cosine, t)
    straight = whole < _STRAIGHT
    sine = np.where(straight, 1.0, whole / (1.0 + whole * whole))
    first = np.where(straight, 1.0 - t, rest / (1.0 + rest * rest) / sine)
    second = np.copysign(np.where(straight, t, way / (1.0 + way * way) / sine), cosine)
    between: FloatArray = first[..., None] * a + second[..., None] * b
    return between


def slerp_frames(rotations: FloatArray, frames: IntArray, t: FloatArray) -> FloatArray:
    """Return the rotations at fractions t (N,) of the ways from `frames` (N,) to the ones after, shape (N, J, 4).

    `rotations`, shape (F, J, 4), are those of all frames; there is nothing after the last one.
    """
    kernel = compiled()
    if kernel is None:
        return slerp(rotations[frames], rotations[np.minimum(frames + 1, len(rotations) - 1)], t[:, None])
    ways = ways_of(kernel, rotations, frames, t)
    turned = np.empty((*ways.parts.shape[1:], 4))
    kernel.sampled_turns(ways.rotations, turned.shape[1], ways.frames, ways.t, ways.parts, turned)
    return turned


class Ways(NamedTuple):
    """Ways (N,) from frames of `rotations` (F, J, 4) to the ones after, as the compiled part takes them.

    The last two of `parts`, shape (3, N, J), are the weights of both ends.
    """

    rotations: FloatArray
    frames: IntArray
    t: FloatArray
    parts: FloatArray


def ways_of(kernel: Any, rotations: FloatArray, frames: IntArray, t: FloatArray) -> Ways:  # noqa: ANN401  as `compiled`
    """Return the ways to fractions t (N,) from frames (N,) to the ones after; arguments as of `slerp_frames`."""
    rotations, t = np.ascontiguousarray(rotations, np.float64), np.ascontiguousarray(t, np.float64)
    frames, joints = np.ascontiguousarray(frames, np.int64), rotations.shape[1]
    cosines, parts = np.empty((len(t), joints)), np.empty((3, len(t), joints))
    kernel.arc_cosines(rotations, joints, frames, t, cosines, parts[0])
    np.arccos(parts[0], out=parts[0])
    kernel.arc_parts(t, joints, parts)
    np.tan(parts, out=parts)
    kernel.arc_weights(t, joints, cosines, _STRAIGHT, parts)
    return Ways(rotations, frames, t, parts)


def _arc_tangents(cosine: FloatArray, t: FloatArray) -> FloatArray:
    """Return the tangents of half an arc, of half of what is left of it at t, and of half its way to t, (3, ...).

    Of a cosine (...) between quaternions. A sine 2 u / (1 + u^2) by its tangent costs a quarter of numpy's own.
    """
    tangents = np.empty((3, *np.broadcast_shapes(cosine.shape, t.shape)))
    half = 0.5 * np.arccos(np.minimum(np.abs(cosine), 1.0))
    tangents[0] = half
    np.multiply(1.0 - t, half, out=tangents[1, ...])
    np.multiply(t, half, out=tangents[2, ...])
    return np.tan(tangents, out=tangents)
