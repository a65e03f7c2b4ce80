"""What of groups of frames is the same for all clips that share a skeleton and what is asked of it."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.blocks import BLOCK_FRAMES
from motionedit.core.priorities.solver.points import columns_of
from motionedit.core.priorities.solver.problem import order_of_layers
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from motionedit.core.arrays import IntArray
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.solver.points import Columns
    from motionedit.core.skeleton import Skeleton


def frames_together(active: NDArray[np.int8]) -> tuple[tuple[tuple[int, ...], IntArray], ...]:
    """Return which constraints are active together anywhere, and the frames where they are so alike.

    `active`, shape (F, C), is 0 where a constraint is not active; frames are alike where all its numbers are.
    """
    find = _together_again if len(active) <= BLOCK_FRAMES else _together
    return find(active.tobytes(), active.shape)


def _together(active: bytes, shape: tuple[int, ...]) -> tuple[tuple[tuple[int, ...], IntArray], ...]:
    rows = np.frombuffer(active, dtype=np.int8).reshape(shape)
    together: dict[tuple[int, ...], list[IntArray]] = {}
    for run in np.split(np.arange(len(rows)), np.flatnonzero((rows[1:] != rows[:-1]).any(axis=1)) + 1):
        together.setdefault(tuple(rows[run[0]].tolist()), []).append(run)
    return tuple(
        (tuple(i for i, there in enumerate(key) if there), frozen(np.concatenate(together[key])))
        for key in sorted(together)
        if any(key)
    )


# The clips of a folder are mostly as long, and asked for the same.
_together_again = lru_cache(maxsize=16)(_together)


@dataclass(frozen=True, eq=False)
class Plan:
    """What of a group is the same for all clips that share a skeleton and what is asked of it.

    `layers` are the places of constraints among the group's members, `levels` (L,) as `Group` has them, `weights` those
    of each layer's constraints within it.
    """

    columns: Columns
    moves_root: bool
    layers: tuple[tuple[int, ...], ...]
    levels: IntArray
    weights: tuple[tuple[float, ...], ...]


@lru_cache(maxsize=32)
def plan_of(
    skeleton: Skeleton,
    root: int,
    recruits: tuple[Recruits, ...],
    shares: tuple[tuple[int, float, bool], ...],
    priorities: tuple[int, ...],
) -> Plan:
    """Return the plan of a group, of what its members may move and their `shares`: priority, weight, are they soft."""
    joints = frozenset().union(*(each.joints for each in recruits))
    # Of one priority, what gives way is a layer below what is met.
    places = [(-priority, is_soft) for priority, _, is_soft in shares]
    order, levels = sorted(set(places)), order_of_layers(priorities)
    layers = tuple(tuple(k for k, place in enumerate(places) if place == layer) for layer in order)
    # Weights say how a layer is shared: the step's damping and softness are in metres and radians of the largest.
    largest = [max(shares[k][1] for k in layer) for layer in layers]
    return Plan(
        columns_of(skeleton, joints, root),
        any(each.root for each in recruits),
        layers,
        frozen(np.array([levels.index(-priority) for priority, _ in order], dtype=np.int64)),
        tuple(tuple(shares[k][1] / most for k in layer) for layer, most in zip(layers, largest, strict=True)),
    )
