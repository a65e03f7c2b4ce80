"""How a body looks somewhere by itself: about the vertical with its neck, its back and its hips, its head level.

The least turn that takes a look elsewhere is about one axis, square to where it looks before and after. Where that is
aside and up the head rolls, and the back leans with it. A body turns about the vertical, the neck twice as far as the
back until they are near the end of their ranges, and raises or lowers what is on its chest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.blocks import frame_blocks
from motionedit.core.body.bones import below
from motionedit.core.body.ground import reference_axes
from motionedit.core.smooth import no_more_than, smooth_share
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# The neck's share of a turn about the vertical: in takes in which heads turn, twice what the back does.
_NECK = 2.0 / 3.0
# Radians that neck and back turn at most, aside and up: of what is more, what carries them turns the rest.
_MOST_OF_NECK, _MOST_OF_BACK = np.radians(50.0), np.radians(40.0)
# Cosines of a look's height between which it begins to have a side: straight up it has none.
_STEEP, _LEVEL = 0.2, 0.5
# Radians aside between which it ceases to have one: what is behind may be looked at over either shoulder.
_ASIDE, _BEHIND = np.radians(140.0), np.radians(170.0)
_SHORTEST = 1e-12


@dataclass(frozen=True, eq=False)
class Gaze:
    """What of a body looks: joints of the `head` and what is on it, of the `neck`, these among them, and the `back`.

    The `trunk` are all from the root to the head; `up` is the unit vector up, shape (3,).
    """

    head: frozenset[int]
    neck: frozenset[int]
    back: frozenset[int]
    trunk: frozenset[int]
    up: FloatArray

    def turned(
        self,
        motion: Motion,
        frames: slice,
        chain: Sequence[int],
        weights: FloatArray,
        looks: FloatArray,
        goals: FloatArray,
    ) -> FloatArray:
        """Return local rotations of a chain, shape (n, k, 4), by which a body looks elsewhere at n frames of a motion.

        Parameters
        ----------
        chain : sequence of int
            k joints, from the root to one of the head.
        weights : shape (k,)
            How readily each turns beside others of the neck, of the back, or of what is below it.
        looks, goals : shape (n, 3)
            Where it looks, and where it shall, directions in the world.
        """
        chain, local = list(chain), motion.rotations[frames]
        found: FloatArray = np.empty((len(looks), len(chain), 4))
        # Of a long motion no turns are made that are not needed yet.
        for block in frame_blocks(len(looks)):
            turns = self._turns(chain, weights, looks[block], goals[block])
            world = local[block][:, chain]
            for k in range(1, len(chain)):
                world[:, k] = rot.multiply(world[:, k - 1], world[:, k])
            world = rot.multiply(turns, world)
            world[:, 1:] = rot.between(world[:, :-1], world[:, 1:])
            found[block] = world
        return found

    def _turns(self, chain: list[int], weights: FloatArray, looks: FloatArray, goals: FloatArray) -> FloatArray:
        """Return how far a chain's joints are turned in the world, shape (n, k, 4)."""
        aside, raised = _apart(looks, goals, self.up)
        parts = [np.array([joint in part for joint in chain]) for part in (self.neck, self.back)]
        shares = [_shares(weights, of) for of in (*parts, ~(parts[0] | parts[1]))]
        neck, up = no_more_than(_MOST_OF_NECK, _NECK * aside, raised)
        back, bent = no_more_than(_MOST_OF_BACK, aside - neck, raised - up)
        yaw = np.stack((neck, back, aside - neck - back), axis=1) @ shares
        pitch = np.stack((up, bent, raised - up - bent), axis=1) @ shares
        side = rot.cross(looks, np.broadcast_to(self.up, looks.shape))
        side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), _SHORTEST)
        return rot.multiply(
            rot.exp(np.cumsum(yaw, axis=1)[..., None] * self.up),
            rot.exp(np.cumsum(pitch, axis=1)[..., None] * side[:, None]),
        )


def gaze_of(skeleton: Skeleton, anatomy: Anatomy, *, up: FloatArray) -> Gaze | None:
    """Return what of a body looks; None where it has no head on a chest."""
    head, chest, pelvis = anatomy.head, anatomy.chest, anatomy.pelvis
    if head is None or chest is None:
        return None
    on_head = frozenset(np.flatnonzero(below(skeleton, head)).tolist())
    below_back = [] if pelvis is None else skeleton.chain(pelvis).tolist()
    back = frozenset(skeleton.chain(chest).tolist()).difference(below_back)
    trunk = on_head.union(skeleton.chain(head).tolist())
    return Gaze(on_head, on_head.union(skeleton.between(chest, head)), back, trunk, up)


def _apart(looks: FloatArray, goals: FloatArray, up: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far goals are aside of where it looks, and how much higher, rad, shapes (n,); 0 where that is no way.

    It is none where one of them is steep, or a goal behind.
    """
    aside, height, flat = zip(*(_angles(directions, up) for directions in (looks, goals)), strict=True)
    way: FloatArray = np.remainder(aside[1] - aside[0] + np.pi, 2.0 * np.pi) - np.pi
    share = smooth_share(np.minimum(*flat), _STEEP, _LEVEL) * smooth_share(np.abs(way), _BEHIND, _ASIDE)
    return share * way, share * (height[1] - height[0])


def _angles(directions: FloatArray, up: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how far aside and how high directions are, rad, and the cosine of the latter, shapes (n,)."""
    left, height, forward = reference_axes(up) @ directions.T
    flat = np.hypot(left, forward)
    return np.arctan2(left, forward), np.arctan2(height, flat), flat / np.maximum(np.hypot(flat, height), _SHORTEST)


def _shares(weights: FloatArray, part: BoolArray) -> FloatArray:
    """Return how joints of a part share its turn, shape (k,): all of it, or none where nothing of it may turn."""
    own = weights * part
    return own / max(float(own.sum()), _SHORTEST)
