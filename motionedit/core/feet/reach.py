"""How far from its hip an ankle may be, and the heels that come up where it would be farther."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.feet.stance import runs

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.feet.knees import Knee
    from motionedit.core.feet.stance import Foot, Stance
    from motionedit.core.kinematics import WorldPoses

# A leg is stretched to this share of its length, or as far as it is already: nearer to straight, a millimetre at the
# ankle is a centimetre at the knee.
REACH = 0.994
# Of a leg: a heel comes up where the pelvis would have to come down by more.
LOWERED = 0.02
_LEAST = float(np.radians(5.0))  # rad
_ROUNDING = 1e-9


def stretch(poses: WorldPoses, foot: Foot) -> tuple[FloatArray, FloatArray]:
    """Return the way from hip to ankle, and the leg's length, shape (F,) each."""
    hip, knee, ankle = (poses.positions[:, j] for j in (foot.leg.thigh, foot.leg.knee, foot.leg.ankle))
    return rot.length(ankle - hip), rot.length(knee - hip) + rot.length(ankle - knee)


def reach_of(poses: WorldPoses, foot: Foot) -> FloatArray:
    """Return how far from its hip an ankle may be, shape (F,): a share of the leg, or as far as it is already."""
    way, length = stretch(poses, foot)
    return np.maximum(REACH * length, way)


def reach_bent(poses: WorldPoses, foot: Foot, knee: Knee, places: FloatArray) -> FloatArray:
    """Return how far from its hip an ankle may be that goes to places (F, 3), shape (F,): as `reach_of`.

    But no farther than leaves a knee 5 degrees: closer to straight it would shake, or bend back. That brings it nearer
    to the hip by no more than the ankle is off its place: one that is there may be as straight as it is.
    """
    way, _ = stretch(poses, foot)
    off = np.linalg.norm(places - poses.positions[:, foot.leg.ankle], axis=1)
    bent = knee.way(np.full(len(way), _LEAST))
    reach: FloatArray = np.minimum(reach_of(poses, foot), np.maximum(bent, way - off))
    return reach


def released(stance: Stance, hip: FloatArray, reach: FloatArray) -> Stance:
    """Return a stance whose heels come up once the hip (F, 3) is out of their reach (F,), where the toe stays down.

    A body that goes on over its foot ends a heel's plant; a strain that passes is the pelvis' to bear.
    """
    far = stance.flat & (rot.length(hip - stance.heel_place) > reach * (1.0 + _ROUNDING))
    if not far.any():
        return stance
    heel = stance.heel.copy()
    for start, stop in runs(stance.flat):
        if far[stop] and not stance.heel[stop + 1 : stop + 2].any():
            near = np.flatnonzero(~far[start : stop + 1])
            heel[start + (int(near[-1]) + 1 if len(near) else 0) : stop + 1] = False
    return replace(stance, heel=heel)
