"""How far from its hip an ankle may be, and the heels that come up where it would be farther."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import runs
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.feet.knees import Knee
    from motionedit.core.feet.stance import Foot, Stance
    from motionedit.core.kinematics import WorldPoses

# A leg is stretched to this share of its length, or as far as it is already: nearer to straight, a millimetre at the
# ankle is a centimetre at the knee.
REACH = 0.994
# Of a leg: a heel comes up where the pelvis would have to come down by more.
LOWERED = 0.02
LOWERED_ON_PATH = 0.04  # where a path is longer than the old one, and steps with it
# Of a leg: how far a pelvis calms knees at most, where feet keep their own places, and where they go to another's.
CALMS_OWN, CALMS_ANOTHER = 0.01, 1.0
_LEAST = float(np.radians(5.0))  # rad
ROUNDING = 1e-9  # of a reach
# Rad/s, rad/s^2, and times what it did about then: a knee that would bend faster beside a heel that stands, or that
# would turn round more sharply, is bent more.
_CALM, _SHARP, _FASTER = float(np.radians(300.0)), float(np.radians(9000.0)), 1.5
_ABOUT_THEN = 0.05  # s before and after
_MOST = float(np.radians(60.0))  # rad: a knee that is bent so far is calm


def stretch(poses: WorldPoses, leg: Leg) -> tuple[FloatArray, FloatArray]:
    """Return how far it is from hip to ankle, and how long the leg is, shape (F,) each."""
    hip, knee, ankle = (poses.positions[:, j] for j in leg.joints)
    return rot.length(ankle - hip), rot.length(knee - hip) + rot.length(ankle - knee)


def reach_of(poses: WorldPoses, foot: Foot) -> FloatArray:
    """Return how far from its hip an ankle may be, shape (F,): a share of the leg, or as far as it is already."""
    way, length = stretch(poses, foot.leg)
    return np.maximum(REACH * length, way)


def reach_bent(poses: WorldPoses, foot: Foot, knee: Knee, places: FloatArray) -> FloatArray:
    """Return how far from its hip an ankle may be that goes to places (F, 3), shape (F,): as `reach_of`.

    But no farther than leaves a knee 5 degrees: closer to straight it would shake, or bend back. That brings it nearer
    to the hip by no more than the ankle is off its place: one that is there may be as straight as it is.
    """
    way, _ = stretch(poses, foot.leg)
    off = rot.length(places - poses.positions[:, foot.leg.ankle])
    bent = knee.way(np.full(len(way), _LEAST))
    reach: FloatArray = np.minimum(reach_of(poses, foot), np.maximum(bent, way - off))
    return reach


def reach_calm(
    poses: WorldPoses, foot: Foot, knee: Knee, stance: Stance, frame_time: float, *, calms: float
) -> FloatArray:
    """Return how far from its hip a heel that stands may be, shape (F,): as `reach_bent`, but no knee shakes.

    w^2 = fixed + turning cos x, so that w w' = -turning sin(x) x' / 2, and w w'' = -turning sin(x) x'' / 2 at x' = 0:
    the straighter a knee, the faster it bends as its hip comes nearer, and the more sharply it turns round where the
    hip comes no farther. A leg that sets its heel down all but straight kicks, and one over which the hip rises and
    sinks snaps straight and open again; this is how bent it is to be.

    Parameters
    ----------
    calms : float
        Of a leg: so much nearer to the hip than it would be, at most.
    """
    way, length = stretch(poses, foot.leg)
    far = rot.length(stance.heel_place - poses.positions[:, foot.leg.thigh])
    off = rot.length(stance.heel_place - poses.positions[:, foot.leg.ankle])
    stands = stance.heel[1:] & stance.heel[:-1] & (stance.whole[1:] == stance.whole[:-1])
    closing = _of_both_sides(np.abs(np.diff(far)), stands)
    curving = _all_frames(np.where(stands[1:] & stands[:-1], np.maximum(-np.diff(far, n=2), 0.0), 0.0), len(far))
    own = _of_both_sides(np.abs(np.diff(knee.angle)), np.ones(len(far) - 1, dtype=np.bool_))
    own_curving = _all_frames(np.abs(np.diff(knee.angle, n=2)), len(far))
    fastest = np.maximum(_FASTER * _about_then(own, frame_time), _CALM * frame_time)
    sharpest = np.maximum(_FASTER * _about_then(own_curving, frame_time), _SHARP * frame_time**2)
    most = np.maximum(closing / fastest, curving / sharpest)
    sine = 2.0 * far * most / np.maximum(knee.turning, np.finfo(float).tiny)
    calm = knee.way(np.arcsin(np.minimum(sine, np.sin(_MOST))))
    calm = np.maximum(calm, np.maximum(far - calms * length, way - off))
    reach: FloatArray = np.minimum(reach_bent(poses, foot, knee, stance.heel_place), calm)
    return reach


def _all_frames(inner: FloatArray, count: int) -> FloatArray:
    """Return what is told of all frames but the first and the last as of all, shape (count,): 0 at these."""
    return np.pad(inner, 1)[:count]


def _about_then(values: FloatArray, frame_time: float) -> FloatArray:
    """Return the largest of the values (F,) about each frame, shape (F,)."""
    around = round(_ABOUT_THEN / frame_time)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, around, mode="edge"), 2 * around + 1)
    largest: FloatArray = windows.max(axis=1)
    return largest


def _of_both_sides(steps: FloatArray, there: BoolArray) -> FloatArray:
    """Return the mean of the steps into and out of each frame, shape (F,), of those F - 1 that are there."""
    total, count = np.zeros(len(steps) + 1), np.zeros(len(steps) + 1)
    given = np.where(there, steps, 0.0)
    for side in (slice(None, -1), slice(1, None)):
        total[side] += given
        count[side] += there
    mean: FloatArray = total / np.maximum(count, 1.0)
    return mean


def released(stance: Stance, hip: FloatArray, reach: FloatArray) -> Stance:
    """Return a stance whose heels come up once the hip (F, 3) is out of their reach (F,), where the toe stays down.

    A body that goes on over its foot ends a heel's plant; a strain that passes is the pelvis' to bear.
    """
    far = stance.flat & (rot.length(hip - stance.heel_place) > reach * (1.0 + ROUNDING))
    if not far.any():
        return stance
    heel = stance.heel.copy()
    for start, stop in runs(stance.flat):
        if far[stop] and not stance.heel[stop + 1 : stop + 2].any():
            near = np.flatnonzero(~far[start : stop + 1])
            heel[start + (int(near[-1]) + 1 if len(near) else 0) : stop + 1] = False
    return replace(stance, heel=heel)


def handed_on(stance: Stance, after: Stance) -> Stance:
    """Return a stance after heels were released, in which each foot comes from heel to toe by both, for one frame.

    Or it would jump from the one's place to the other's.
    """
    on_heel = np.pad(after.heel & ~after.toe, (1, 0))[:-1]
    return replace(after, heel=after.heel | (on_heel & stance.flat))
