"""The center of mass of a body over all frames, and the centres of its subtrees ([PRIO] section 4.3)."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.blocks import frame_blocks
from motionedit.core.body.in_one_loop import carried, read_off
from motionedit.core.body.segments import Laid, Pose, lay_by_length, lay_given, lay_human
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.skeleton import Skeleton

_FRAMES = 256  # at most are looked at for a clip's mean pose
_NOT_HUMAN = (
    "the skeleton is not a human's: for the center of mass each bone weighs as much as it is long; "
    "'masses' in the spec takes kilograms by joint"
)


@dataclass(frozen=True, eq=False)
class Masses:
    """How a body's mass is spread over J joints.

    Attributes
    ----------
    skeleton : Skeleton
        Whose joints these are.
    shares : shape (J,)
        Mass that moves with each joint over the whole; they sum to 1.
    points : shape (J, 3), clip units
        Its centre in the joint's frame.
    is_human : bool
        Whether the table of body segments could be laid on the skeleton.
    warnings : tuple of str
        Lines for the user.
    """

    skeleton: Skeleton
    shares: FloatArray
    points: FloatArray
    is_human: bool
    warnings: tuple[str, ...] = ()

    @cached_property
    def carriers(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """The C joints that mass moves with, shape (C,), with their shares (C,) and points (C, 3)."""
        joints = frozen(np.flatnonzero(self.shares))
        return joints, frozen(self.shares[joints]), frozen(self.points[joints])

    @cached_property
    def as_bytes(self) -> tuple[bytes, bytes]:
        """The shares and points, for keys."""
        return self.shares.tobytes(), self.points.tobytes()


def find_masses(
    skeleton: Skeleton,
    anatomy: Anatomy,
    *,
    rotations: FloatArray | None = None,
    given: Mapping[int, float] | None = None,
) -> Masses:
    """Return the masses of a skeleton's joints.

    On a human skeleton the segments of de Leva (1996), mean of women and men, laid on by the tree and a pose alone;
    names and what a hand holds do not matter. On others in proportion to bone length, with a warning.

    Parameters
    ----------
    rotations : shape (F, J, 4), optional
        Of a clip's frames; its mean pose tells how bones stand to each other, whatever axes its joints have. Default:
        the skeleton's zero pose.
    given : mapping from joints to kg, optional
        Replaces the table: joints that are not in it weigh nothing. Each mass sits where the table has that joint's,
        or in the middle of the joint's bones where the table has none.

    Raises
    ------
    ValueError
        When the given masses are negative, not finite, or all zero.
    """
    posed = np.tile(rot.IDENTITY, (len(skeleton), 1)) if rotations is None else _mean_rotations(rotations)
    human = _lay_posed(skeleton, anatomy, posed)
    laid = lay_by_length(skeleton) if human is None else human
    if given:
        weights = np.array(list(given.values()))
        if not (np.all(np.isfinite(weights)) and np.all(weights >= 0.0) and np.any(weights > 0.0)):
            raise ValueError("masses must be 0 or more, and not 0 for all joints")
        laid = lay_given(laid, given, elsewhere=lay_by_length(skeleton))
    return Masses(
        skeleton=skeleton,
        shares=frozen(laid.mass / laid.mass.sum()),
        points=laid.points,
        is_human=human is not None,
        warnings=() if human is not None or given else (_NOT_HUMAN,),
    )


@lru_cache(maxsize=4)
def scaled_masses(masses: Masses, skeleton: Skeleton, factor: float) -> Masses:
    """Return masses on a skeleton whose lengths are a factor times those of theirs."""
    return replace(masses, skeleton=skeleton, points=frozen(masses.points * factor))


def _mean_rotations(rotations: FloatArray) -> FloatArray:
    """Return the mean of each joint's rotations over some frames, (F, J, 4), shape (J, 4)."""
    shown = rotations[:: max(1, -(-len(rotations) // _FRAMES))]
    return rot.mean_of_products(shown.transpose(1, 2, 0) @ shown.transpose(1, 0, 2))


def _lay_posed(skeleton: Skeleton, anatomy: Anatomy, rotations: FloatArray) -> Laid | None:
    """Return what `lay_human` has in the pose of joints' rotations, (J, 4), with the centres in the joints' frames."""
    still = skeleton.offsets[skeleton.translated]
    world = forward(Motion(skeleton, rotations[None], still[None], 1.0))
    places, turns = world.positions[0], world.rotations[0]
    joints = [site.joint for site in skeleton.end_sites]
    ends = rot.rotate(turns[joints], np.reshape([site.offset for site in skeleton.end_sites], (-1, 3)))
    laid = lay_human(Pose(skeleton, list(places), list(places[joints] + ends)), anatomy)
    if laid is None:
        return None
    points = np.where(laid.mass[:, None] > 0.0, rot.unrotate(turns, laid.points - places), 0.0)
    return Laid(laid.mass, frozen(points))


def center_of_mass(poses: WorldPoses, masses: Masses) -> FloatArray:
    """Return c = sum m_j (p_j + R_j c_j) / M, the center of mass in the world, shape (F, 3), clip units."""
    carriers, shares, points = masses.carriers
    where = poses.positions, poses.rotations, carriers
    center = read_off("center", *where, points, shares, shape=(len(poses.positions), 3))
    if center is not None:
        return center
    center = np.empty((len(poses.positions), 3))
    # Block by block: what is carried takes more memory on its way than the world transforms of a long motion.
    for block in frame_blocks(len(center)):
        center[block] = shares @ carried(poses.at(block), carriers, points)
    return center


def subtree_centers(poses: WorldPoses, masses: Masses) -> tuple[FloatArray, FloatArray]:
    """Return the centre of all mass at and below each joint, and its share of the whole.

    Returns
    -------
    centers : shape (F, J, 3), clip units
        In the world; the joint's own position where nothing at or below it weighs.
    shares : shape (J,)
        1 at the root.
    """
    walk = masses.skeleton.level_order
    shares = masses.shares[walk.joints]
    carriers = np.flatnonzero(shares)
    # Joint by joint first, so that a level is added to its parents in whole rows.
    moments = np.zeros((len(shares), len(poses.positions), 3))
    places = carried(poses, walk.joints[carriers], masses.points[walk.joints[carriers]])
    moments[carriers] = places.swapaxes(0, 1) * shares[carriers, None, None]
    for start, stop in reversed(walk.levels):
        np.add.at(moments, walk.parents[start:stop], moments[start:stop])
        np.add.at(shares, walk.parents[start:stop], shares[start:stop])
    heavy = np.flatnonzero(shares)
    centers = poses.positions.copy()
    centers[:, walk.joints[heavy]] = (moments[heavy] / shares[heavy, None, None]).swapaxes(0, 1)
    below = np.empty_like(shares)
    below[walk.joints] = shares
    return centers, below
