"""Which side is left: by the names of the joints, or by where the toes point."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import median

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray

_PAIRS = (("left", "right"), ("l", "r"), ("左", "右"))


def side_of_names(a: str, b: str) -> int:
    """Return +1 where `a` is the left one of two names that differ by their side alone, -1 the right, else 0.

    Any place and spelling: ``LeftFoot``, ``foot.L``, ``CC_Base_L_Foot``, ``lFoot``.
    """
    a, b = a.casefold(), b.casefold()
    for left, right in _PAIRS:
        for first, second, side in ((left, right, 1), (right, left, -1)):
            for place in re.finditer(re.escape(first), a):
                if a[: place.start()] + second + a[place.end() :] == b:
                    return side
    return 0


def side_of_chains(names: tuple[str, ...], chains: tuple[tuple[int, ...], tuple[int, ...]]) -> int:
    """Return +1 where the names say that the first chain is the left one, -1 the right, 0 nothing."""
    return int(np.sign(sum(side_of_names(names[a], names[b]) for a, b in zip(*chains, strict=True))))


def side_of_toes(*, across: FloatArray, up: FloatArray, toes: FloatArray) -> int:
    """Return +1 where `across` points to the left of someone whose toes point forward, -1 to the right, else 0.

    `across`, `up` (feet to head) and `toes` (heel to toe) have shape (F, 3), any units.
    """
    share = share_to_left(across, up=up, ahead=toes)
    return 0 if abs(share) < _SURE else int(np.sign(share))


def share_to_left(across: FloatArray, *, up: FloatArray, ahead: FloatArray) -> float:
    """Return how far to the left something points in the median frame: 1 straight there, -1 to the right.

    Left is up x ahead, which need not be square to each other: a part of 1 then. All have shape (F, 3), any units.
    """
    lean = rot.dot(rot.cross(up, ahead), across)
    size = rot.length(up) * rot.length(ahead) * rot.length(across)
    return float(median(lean / np.maximum(size, np.finfo(float).tiny)))


# A tenth of what two feet side by side that point straight ahead would give.
_SURE = 0.1
