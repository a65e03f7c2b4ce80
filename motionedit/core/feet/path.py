"""The way a body goes, changed: where and by how much a new path takes it, and turns it, at every frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion
from motionedit.core.timeline.interpolation import low_pass
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.feet.stance import Stance
    from motionedit.core.kinematics import WorldPoses

# Seconds over which a path's direction is told: the body sways from step to step.
_LOOKS = 0.25
# Of a leg a second: a body that is as slow has no direction; it is turned by half of what a fast one is.
_SLOW = 0.4


@dataclass(frozen=True, eq=False)
class NewPath:
    """A path that takes a body along: `places` (F, 3) of the old one, `shift` (F, 3), and its `heading` (F,), rad.

    The heading is how far the new path is turned from the old one about `up`, shape (3,).
    """

    places: FloatArray
    shift: FloatArray
    heading: FloatArray
    up: FloatArray

    @property
    def turns(self) -> FloatArray:
        """The turns about up, quaternions (F, 4)."""
        return rot.exp(self.heading[:, None] * self.up)


def new_path(
    places: FloatArray, shift: FloatArray, *, up: FloatArray, leg: float, frame_time: float, first: int = 0
) -> NewPath:
    """Return a path whose places (F, 3) are shifted, (F, 3), and by how much that turns it.

    The old velocity's conjugate times the new one, complex numbers on the ground, has the turn as its argument: of unit
    length it is averaged over a step, and as 1, no turn, where the slower of both is slow and so has no direction.

    Parameters
    ----------
    leg : float
        A leg's length.
    first : int
        The first frame after a rest pose; earlier ones are not turned.
    """
    heading = np.zeros(len(places))
    if len(places) - first > 1:
        sigma = _LOOKS / frame_time
        before, after = (
            _on_ground(low_pass(np.gradient(way[first:], frame_time, axis=0), sigma=sigma), up)
            for way in (places, places + shift)
        )
        product = before.conj() * after
        slower = np.minimum(np.abs(before), np.abs(after)) / (_SLOW * leg)
        share = slower**4 / (slower**4 + 1.0)
        way = share * product / np.maximum(np.abs(product), np.finfo(float).tiny) + (1.0 - share)
        smooth = low_pass(np.stack((way.imag, way.real), axis=1), sigma=sigma)
        heading[first:] = np.unwrap(np.arctan2(smooth[:, 0], smooth[:, 1]))
    return NewPath(places, shift, heading, up)


def _on_ground(ways: FloatArray, up: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Return ways (F, 3) on the ground as complex numbers (F,), turned to the left by a positive angle about up."""
    front = np.roll(np.abs(up), 1)
    return ways @ front + 1j * (ways @ np.cross(up, front))


def carried(stance: Stance, path: NewPath) -> Stance:
    """Return a stance each of whose stands is moved and turned, as a whole, by the mean of what its frames are."""
    heel, toe, turn = stance.heel_place.copy(), stance.toe_place.copy(), stance.turn.copy()
    for stand in np.unique(stance.whole[stance.whole >= 0]):
        here = stance.whole == stand
        about = np.where(stance.heel[here, None], heel[here], toe[here]).mean(axis=0)
        frames = path.places[here]
        moved = (frames + path.shift[here] + rot.rotate(path.turns[here], about - frames)).mean(axis=0)
        turned = rot.exp(path.heading[here].mean() * path.up)
        heel[here] = moved + rot.rotate(turned, heel[here] - about)
        toe[here] = moved + rot.rotate(turned, toe[here] - about)
        turn[here] = rot.multiply(turned, turn[here])
    return replace(stance, heel_place=heel, toe_place=toe, turn=turn)


def turned(motion: Motion, path: NewPath, poses: WorldPoses, travel: int) -> Motion:
    """Return a motion whose travel is turned with the path; `poses` are its world transforms."""
    parent = int(motion.skeleton.parents[travel])
    world = rot.multiply(path.turns, poses.rotations[:, travel])
    rotations = motion.rotations.copy()
    rotations[:, travel] = world if parent < 0 else rot.between(poses.rotations[:, parent], world)
    return Motion(motion.skeleton, frozen(rotations), motion.translations, motion.frame_time)
