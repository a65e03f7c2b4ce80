"""Bodies whose left is on the right, as in clips that were mirrored without their names: by toes and knees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.bends import way_to_toes
from motionedit.core.body.sides import share_to_left
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Anatomy, GivenBody, Leg
    from motionedit.core.kinematics import WorldPoses

_BY_NAMES = (
    "what is taken for left is on the right, as toes and knees point: the heading goes by these; swap left and right "
    "in the names of joints, or body: in a spec says which limbs are left"
)
_BY_BODY = "body: calls left what is on the right, as toes and knees point; the heading goes by body:"

# Of what toes straight ahead would give; all clips that were looked at give 0.84 or more, to the other side.
_CLEARLY = 0.5
_FRAMES = 64  # at most are looked at


def as_it_points(anatomy: Anatomy, poses: WorldPoses, *, first: int, given: GivenBody) -> Anatomy:
    """Return an anatomy that knows, and says, where its left is on the right; what the user says of legs holds."""
    if not _points_back(anatomy, poses, first):
        return anatomy
    told = given.legs is not None
    warning = _BY_BODY if told else _BY_NAMES
    return replace(anatomy, mirrored=not told, warnings=(*anatomy.warnings, warning))


def _points_back(anatomy: Anatomy, poses: WorldPoses, first: int) -> bool:
    """Return whether toes and knees clearly point to where the back is, were the left leg on the left.

    In the median frame from `first` on; the travel does not count, for some walk backwards.
    """
    if anatomy.legs is None:
        return False
    poses = poses.at(slice(first, None, -(-(len(poses.positions) - first) // _FRAMES)))
    places, (left, right) = poses.positions, anatomy.legs
    hips, feet = places[:, left.thigh] + places[:, right.thigh], places[:, left.ankle] + places[:, right.ankle]
    top = hips if anatomy.head is None else 2.0 * places[:, anatomy.head]
    across = places[:, left.thigh] - places[:, right.thigh]
    return share_to_left(across, up=top - feet, ahead=_ahead(poses, left) + _ahead(poses, right)) < -_CLEARLY


def _ahead(poses: WorldPoses, leg: Leg) -> FloatArray:
    """Return where a leg's toe and knee point, shape (F, 3): a straight leg's knee says nothing."""
    thigh, knee, ankle = (poses.positions[:, joint] for joint in leg.joints)
    toes, ahead = way_to_toes(poses, leg), 2.0 * knee - thigh - ankle
    return ahead if toes is None else ahead + toes
