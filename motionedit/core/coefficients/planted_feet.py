"""How a change of pose moves feet that stand: Jacobians of heels and toes at frames of their plants."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import exp_and_left_jacobian
from motionedit.core.kinematics import WorldPoses, effector_positions
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.contacts import Plant
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import Effector
    from motionedit.core.pca.coordinates import PoseSpace

# Seconds between the frames of a plant that are looked at: a foot that stands moves alike in the frames between.
_LOOKS = 0.05
# Metres at leg length 0.85 m: a point that is so far off counts as one standard deviation. The legs put it back at
# little cost, but for hips that go further than they reach; a foot that is firm has hips that do not.
LOOSE, FIRM = 0.12, 0.01


@dataclass(frozen=True, eq=False)
class PlantedFoot:
    """A point of a foot at N frames of a plant.

    Attributes
    ----------
    frames : shape (N,)
    columns : shape (c,)
        Of Theta, those that move it.
    rows : shape (N, 3, c)
        d(position) / d Theta, metres at leg length 0.85 m, along the world's axes.
    seconds : float
        For how long each of the N frames stands.
    deviation : float
        How far off counts as one standard deviation, metres at leg length 0.85 m.
    """

    frames: IntArray
    columns: IntArray
    rows: FloatArray
    seconds: float
    deviation: float = LOOSE


def planted_feet(
    projection: Projection,
    space: PoseSpace,
    *,
    poses: WorldPoses,
    plants: Sequence[Plant],
    points: Sequence[Effector],
    deviation: float = LOOSE,
) -> tuple[PlantedFoot, ...]:
    """Return the points of feet that stand, one for each plant.

    Parameters
    ----------
    poses : WorldPoses
        Of the projected motion.
    points : sequence of Effector
        Heels and toes, as the plants number them.
    deviation : float
        As of `PlantedFoot`.
    """
    frame_time, feet = projection.motion.frame_time, []
    for plant in plants:
        seconds = plant.frames * frame_time
        looks = min(plant.frames, 1 + int(seconds / _LOOKS))
        # At least a frame apart: none comes twice.
        frames = np.linspace(plant.start, plant.stop, looks).astype(np.intp)
        columns, rows = _point_rows(projection, space, poses, points[plant.point], frames)
        feet.append(PlantedFoot(frames, columns, rows, seconds / len(frames), deviation))
    return tuple(feet)


def _point_rows(
    projection: Projection, space: PoseSpace, poses: WorldPoses, point: Effector, frames: IntArray
) -> tuple[IntArray, FloatArray]:
    """Return the columns of Theta that move a point, and d(position) / d Theta at some frames.

    A change dv of a joint's rotation vector is the world-axis increment R_j J_l(v)^T dv, as in `chain.evaluate`.
    """
    chain = projection.motion.skeleton.chain(point.joint)
    known = np.flatnonzero(np.isin(projection.joints, chain))
    joints = projection.joints[known]
    v = projection.rows[frames, 3:].reshape(len(frames), -1, 3)[:, known]
    _, jacobians = exp_and_left_jacobian(v.reshape(-1, 3))
    here = poses.at(frames)
    increments = rot.to_matrix(here.rotations[:, joints]) @ jacobians.reshape(*v.shape, 3).swapaxes(-1, -2)
    levers = rot.skew(here.positions[:, joints] - effector_positions(here, point)[:, None])
    turns = np.swapaxes(space.scale * (levers @ increments), 1, 2).reshape(len(frames), 3, -1)
    columns = (3 + 3 * known[:, None] + np.arange(3)).ravel()
    if projection.travel not in chain:
        return columns, turns
    to_world = rot.to_matrix(rot.conjugate(projection.alignment.rotation)) / space.root_weight
    travel = np.broadcast_to(to_world, (len(frames), 3, 3))
    return np.concatenate((np.arange(3), columns)), np.concatenate((travel, turns), axis=2)
