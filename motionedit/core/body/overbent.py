"""Knees and elbows that an edit bends further than a body does, back or shut, and that are held where these end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.bends import Bend

# How a bend comes to a limit: s log(1 + exp(b / s)) in place of b, which without it would stop dead there.
_SOFT = float(np.radians(5.0))
_ROUNDING = 1e-9  # rad
# Where bones that are a hand's width thick lie on each other, unless the input bends them further. Captured elbows go
# beyond the 150 degrees of a hinge.
_SHUT = float(np.radians(165.0))


@dataclass(frozen=True, eq=False)
class HeldBends:
    """A motion, and the joints that were turned for it."""

    motion: Motion
    joints: tuple[int, ...]


def hold_bends(motion: Motion, bends: Sequence[Bend], *, first: int) -> HeldBends:
    """Return an edited motion whose knees and elbows bend within their limits.

    b' = b + (c(b) - b) (1 - exp(-(b - b0)^2 / s^2)) about the axis of the bend, b the edit's and b0 the input's, c(b) =
    l + s log(1 + exp((b - l) / s)) at the lower limit l, and the same at the upper: where an edit changes nothing, nor
    does this. Limbs that are never beyond stay as they are.

    Parameters
    ----------
    bends : sequence of Bend
        The input's, of the same `first`.
    first : int
        Frames before it are a rest pose, and stay.
    """
    rotations, turned = motion.rotations.copy(), []
    for bend in bends:
        now = _bent(bend.angles_in(rotations[first:]))
        least, most = bend.bent
        low, high = min(0.0, least), max(_SHUT, most)
        if ((low - _ROUNDING <= now) & (now <= high + _ROUNDING)).all():
            continue
        more = (_held(now, low, high) - now) * -np.expm1(-(((now - _bent(bend.angles)) / _SOFT) ** 2))
        turn = rot.exp(more[:, None] * bend.axis)
        rotations[first:, bend.joint] = rot.multiply(turn, rotations[first:, bend.joint])
        turned.append(bend.joint)
    return HeldBends(Motion(motion.skeleton, frozen(rotations), motion.translations, motion.frame_time), tuple(turned))


def _bent(angles: FloatArray) -> FloatArray:
    """Return how far a limb is bent, shape (F,), rad: from a quarter turn back to three forward."""
    bent: FloatArray = np.where(angles < -0.5 * np.pi, angles + 2.0 * np.pi, angles)
    return bent


def _held(angles: FloatArray, low: float, high: float) -> FloatArray:
    """Return angles that come to a limit softly, and stay within."""
    above = low + _SOFT * np.logaddexp(0.0, (angles - low) / _SOFT)
    held: FloatArray = high - _SOFT * np.logaddexp(0.0, (high - above) / _SOFT)
    return held
