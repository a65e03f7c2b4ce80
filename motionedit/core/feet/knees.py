"""A knee's angle and the way from hip to ankle, each from the other: nearly straight, the angle is what eases."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.feet.correction import eased
from motionedit.core.feet.pelvis import smooth_cover
from motionedit.core.smooth import smooth_share
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

# Rad: below the first angle a knee is nearly straight, a millimetre at the ankle being a centimetre there; above the
# second it is bent.
_STRAIGHT_TO_BENT = np.radians(15.0), np.radians(40.0)
# Rad: a straight knee that a lowered pelvis would bend by this is bent by half of it.
_TO_BENT = np.radians(4.0)
_TURNS = 0.05  # s before and after for which a leg counts as nearly straight
# Rad: no knee is bent back by what it does not need; it straightens by its own angle, rounded off over this, at most.
_SLACK = np.radians(2.0)
_ORDER = 2  # the third difference would go on too far in what a knee at its straightest was about
_BENDS = 0.024  # s: how slowly the correction of a knee bends


@dataclass(frozen=True, eq=False)
class Knee:
    """A knee that turns about its own axis.

    |upper + turned lower|^2 = fixed + turning * cos(angle), the angle being 0 where the leg is longest.

    Attributes
    ----------
    axis : shape (F, 3)
        Unit axis in the world about which the knee bends further.
    angle : shape (F,), rad
        How far it is bent in the motion; below 0 it is bent back.
    fixed, turning : shape (F,)
        Squares of a length.
    """

    axis: FloatArray
    angle: FloatArray
    fixed: FloatArray
    turning: FloatArray

    def way(self, angle: FloatArray) -> FloatArray:
        """Return the way from hip to ankle at an angle, shape (F,)."""
        return np.sqrt(np.maximum(self.fixed + self.turning * np.cos(angle), 0.0))

    def bent(self, way: FloatArray) -> FloatArray:
        """Return the angle, 0 to pi, at a way from hip to ankle, shape (F,); 0 where it is longer than the leg."""
        cosine = (way**2 - self.fixed) / np.maximum(self.turning, np.finfo(float).tiny)
        return np.arccos(np.clip(cosine, -1.0, 1.0))

    def lowered(self, way: FloatArray) -> FloatArray:
        """Return the angle at a way that a lowered pelvis has made shorter, shape (F,); its own where it has not.

        With x its own angle and y the one at that way, x + d^2 / (d^2 + a^2) (y - x), d^2 = y^2 - x^2: one that is bent
        back comes forward, smoothly as it passes through straight, also where the pelvis hardly bends it. A leg that is
        above its hip, from which a lower pelvis goes away, comes down with it.
        """
        own, bent = self.angle, self.bent(way)
        by = np.maximum(bent**2 - own**2, 0.0)
        angle: FloatArray = own + by / (by + _TO_BENT**2) * (bent - own)
        return angle


def knee_of(skeleton: Skeleton, poses: WorldPoses, leg: Leg, bend: Bend) -> Knee:
    """Return a leg's knee in a motion.

    u . R v = (u . a)(v . a) + C cos x + S sin x, with u, v the bones, a the axis; it is longest at x = atan2(S, C).
    """
    hip, knee, ankle = (poses.positions[:, j] for j in leg.joints)
    upper, lower = knee - hip, ankle - knee
    axis = rot.rotate(poses.rotations[:, skeleton.parents[leg.knee]], np.broadcast_to(bend.axis, upper.shape))
    along = rot.dot(upper, axis) * rot.dot(lower, axis)
    cosine = rot.dot(upper, lower) - along
    sine = rot.dot(upper, rot.cross(axis, lower))
    squares = rot.dot(upper, upper) + rot.dot(lower, lower)
    return Knee(axis, -np.arctan2(sine, cosine), squares + 2.0 * along, 2.0 * np.hypot(cosine, sine))


def eased_ways(
    knee: Knee,
    hip: FloatArray,
    before: FloatArray,
    ankle: FloatArray,
    *,
    known: BoolArray,
    back: BoolArray,
    frame_time: float,
) -> tuple[FloatArray, BoolArray]:
    """Return how far ankles shall be from hips, shape (F,), and whether the knee is bent back then, shape (F,).

    A bent leg's as they are; one that is nearly straight then has its knee's angle eased from where it is `known`. One
    that was straight and is bent now has not: angles that it bent by are long ways for it, and would throw its foot.

    Parameters
    ----------
    hip, before, ankle : shape (F, 3)
        The hips, the ankles before they were corrected, and where they are now.
    known, back : shape (F,)
        Where the ankle stays where it is, and where its knee is bent back there.
    """
    ways = rot.length(ankle - hip)
    own, now = knee.lowered(rot.length(before - hip)), np.where(back, -1.0, 1.0) * knee.bent(ways)
    slack = 0.5 * (own + np.hypot(own, _SLACK))
    change = _unfolded(now - own, slack)
    change = _folded(eased(change[:, None], known, frame_time, bends=_BENDS, order=_ORDER)[:, 0], slack)
    angle = own + change
    straight = 1.0 - (1.0 - straightness(angle)) * (1.0 - straightness(now))
    share = np.where(known, 0.0, smooth_cover(straight, frame_time, ease=_TURNS))
    return ways + share * (knee.way(angle) - ways), (share > 0.5) & (angle < 0.0)


def _unfolded(change: FloatArray, slack: FloatArray) -> FloatArray:
    """Return what eases, u, of which `_folded` makes changes of angles, shape (F,); -2 slack of one below -slack.

    A knee that the leg is too short for is straight within a frame or two. The way from hip to ankle goes as the square
    of the angle, and u with the way; what grew without end there would overshoot as far once it eases.
    """
    left = np.maximum(1.0 + np.minimum(change, 0.0) / slack, 0.0)
    return np.maximum(change, 0.0) + 2.0 * slack * (np.sqrt(left) - 1.0)


def _folded(u: FloatArray, slack: FloatArray) -> FloatArray:
    """Return changes of angles, shape (F,): u where it bends a knee, and u + u^2 / (4 slack), never below -slack."""
    down = np.clip(u, -2.0 * slack, 0.0)
    return np.maximum(u, 0.0) + down + down**2 / (4.0 * slack)


def straightness(angle: FloatArray) -> FloatArray:
    """Return how nearly straight a knee is, shape (F,): 1 below 15 degrees, 0 above 40, smoothly."""
    return 1.0 - smooth_share(np.abs(angle), *_STRAIGHT_TO_BENT)
