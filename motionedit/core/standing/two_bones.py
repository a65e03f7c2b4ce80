"""A leg of two bones that brings its ankle to a place: the knee bends about its own axis, then the hip turns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

# How much the plane in which a leg bends over the whole clip counts beside that of a frame, whose weight is the sine of
# its bend. Where an edit straightens a leg, noise turns its plane about; bent again, its knee would kick sideways.
_STRAIGHT = 1.0
# Cosine of the least bend (2 degrees) of a leg that is stretched: straight, it has no side to bend to.
_LEAST_BEND = float(np.cos(np.radians(2.0)))
# A leg comes to rest before it is straight where it is corrected by more than this share of its length; where it is
# hardly corrected it stays as it is.
_FULLY = 1e-2


def bent_to(
    hip: FloatArray, knee: FloatArray, ankle: FloatArray, target: FloatArray, thigh: FloatArray, *, soft: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the world turns of shank (about the knee) and of the whole leg (about the hip), quaternions (F, 4).

    First the shank is turned, then thigh and shank together; the ankle is then at the target, or as near as the leg is
    long.

    Parameters
    ----------
    hip, knee, ankle, target : shape (F, 3)
    thigh : shape (F, 4)
        World rotation of the thigh, in whose frame the knee's axis is steady.
    soft : shape (F,)
        How much of the cosine of its bend a leg takes to come to rest before it is straight.
    """
    t, s = knee - hip, ankle - knee
    n = _axes(t, s, thigh)
    # |t + R(n, phi) s|^2 = d^2 is B cos(phi) + C sin(phi) = K.
    along = _dot(n, s) * _dot(n, t)
    B, C = _dot(t, s) - along, _dot(t, np.cross(n, s))
    wanted = target - hip
    K = 0.5 * (_dot(wanted, wanted) - _dot(t, t) - _dot(s, s)) - along
    most = np.hypot(B, C)
    straightest = np.arctan2(C, B)
    # A leg that is straighter than that in the input may stay so.
    limit = np.maximum(_LEAST_BEND, np.cos(straightest))
    corrected = _length(target - ankle) / (_FULLY * (_length(t) + _length(s)))
    cosine = _saturated(K / np.where(most > 0.0, most, 1.0), limit, soft * -np.expm1(-corrected))
    bend = np.arccos(np.clip(cosine, -1.0, 1.0))
    turn = rot.exp(n * (straightest + bend)[:, None])
    reached = t + rot.rotate(turn, s)
    return turn, _between(reached, wanted)


def _saturated(x: FloatArray, limit: FloatArray, width: FloatArray) -> FloatArray:
    """Return x, but smoothly no more than its limit: where a knee locks at once, it kicks."""
    width = np.maximum(width, 1e-12)
    over = np.maximum(x - limit + width, 0.0)
    return np.where(over > 0.0, limit - width * np.exp(-over / width), x)


def _axes(t: FloatArray, s: FloatArray, thigh: FloatArray) -> FloatArray:
    """Return the unit axes about which the knee bends more, shape (F, 3).

    Where a capture has a knee a few degrees past straight it bends forward all the same: turned about the axis of such
    a frame, it would bend backward for the while, and kick.
    """
    normal = np.cross(t, s) / (_length(t) * _length(s))[:, None]
    local = rot.rotate(rot.conjugate(thigh), normal).sum(axis=0)
    steady = rot.rotate(thigh, np.broadcast_to(local / max(float(np.linalg.norm(local)), 1e-12), t.shape))
    along = _dot(normal, steady)
    n = normal + (np.abs(along) - along + _STRAIGHT)[:, None] * steady
    return n / np.maximum(_length(n), 1e-12)[:, None]


def _between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the smallest turns that bring directions a to directions b, shape (F, 4)."""
    a, b = a / _length(a)[:, None], b / _length(b)[:, None]
    q = np.concatenate((1.0 + _dot(a, b)[:, None], np.cross(a, b)), axis=1)
    turn: FloatArray = q / np.linalg.norm(q, axis=1, keepdims=True)
    return turn


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    product: FloatArray = np.einsum("fi,fi->f", a, b)
    return product


def _length(a: FloatArray) -> FloatArray:
    return np.sqrt(_dot(a, a))
