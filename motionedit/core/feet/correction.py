"""A correction that is known while a foot stands, and eases between: as smooth as it can be, and near to nothing."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen, runs
from motionedit.core.blocks import BLOCK_FRAMES

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray

# Seconds: how slowly a correction bends. The third difference weighs (BENDS / dt)^6 in its square,
BENDS = 0.02
# the correction itself so much: it fades to nothing within `BENDS` / _FADES^(1/6), half of it in 0.1 s.
_FADES = 0.01
# Seconds from what is known after which it has faded away.
_FADED = 1.2


def eased(
    values: FloatArray,
    known: BoolArray,
    frame_time: float,
    *,
    bends: float = BENDS,
    order: int = 3,
) -> FloatArray:
    """Return a correction at all frames, shape (F, k), from its values at those that are `known`, shape (F,).

    The others make sum (tau / dt)^6 |third difference|^2 + 0.01 |c|^2 least; what is known stands to the
    bit. All zeros where nothing is known.

    Parameters
    ----------
    bends : float
        tau, seconds.
    order : int
        Of the difference: 2 goes on less far in what it was about.
    """
    found = np.where(known[:, None], values, 0.0)
    if not known.any():
        return found
    reach = max(order, round(_FADED / frame_time))
    weight = (bends / frame_time) ** (2 * order)
    # Of a short clip several corrections are known at the same frames.
    find = _stretches_again if len(known) <= BLOCK_FRAMES else _stretches
    for stretch, mask in find(known.tobytes(), reach, order):
        part = found[stretch]
        part[~mask] = _extension(mask.tobytes(), weight, order) @ part[mask]
    return found


def _stretches(given: bytes, reach: int, order: int) -> tuple[tuple[slice, BoolArray], ...]:
    """Return the stretches that are solved by themselves, each with something known and something not, and what is.

    They end within runs of at least `order` known frames, or where the correction has faded away.
    """
    known = np.frombuffer(given, dtype=np.bool_)
    fixed = known.copy()
    at = np.flatnonzero(known)
    distance = np.full(len(known), len(known))
    frames = np.arange(len(known))
    after = np.searchsorted(at, frames)
    for nearest in (at[np.clip(after, 0, len(at) - 1)], at[np.clip(after - 1, 0, len(at) - 1)]):
        distance = np.minimum(distance, np.abs(frames - nearest))
    fixed |= distance > reach
    # The first frames of a third difference all of which are fixed part the problem.
    found: list[tuple[int, int, int]] = []
    for first, last in runs(~fixed):
        begin, end = max(first - order, 0), min(last + 1 + order, len(known))
        if found and first - found[-1][2] <= order:
            found[-1] = (found[-1][0], end, last)
        else:
            found.append((begin, end, last))
    return tuple((slice(begin, end), known[begin:end]) for begin, end, _ in found)


_stretches_again = lru_cache(maxsize=16)(_stretches)


@lru_cache(maxsize=512)
def _extension(mask: bytes, weight: float, order: int) -> FloatArray:
    """Return the matrix that makes the unknown frames of a stretch from its known ones; many stretches share it."""
    known = np.frombuffer(mask, dtype=np.bool_)
    difference = np.diff(np.eye(len(known)), n=order, axis=0)
    normal = weight * difference.T @ difference + _FADES * np.eye(len(known))
    return frozen(np.asarray(np.linalg.solve(normal[np.ix_(~known, ~known)], -normal[np.ix_(~known, known)])))
