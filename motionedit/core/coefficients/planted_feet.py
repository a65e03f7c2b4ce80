"""How much a change of coefficients moves feet that stand: the mean of J^T J over planted frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import exp_and_left_jacobian
from motionedit.core.kinematics import effector_positions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.contacts import Plant
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import Effector, WorldPoses
    from motionedit.core.pca.model import MotionModel

# Frames of a plant that are looked at, evenly spread: a foot that stands moves alike in the frames between.
_LOOKS = 12


def planted_feet(
    projection: Projection,
    model: MotionModel,
    *,
    poses: WorldPoses,
    plants: Sequence[Plant],
    points: Sequence[Effector],
) -> FloatArray | None:
    """Return the mean of J^T J, shape (m, m), square metres at leg length 0.85 m; None where nothing stands.

    Parameters
    ----------
    poses : WorldPoses
        Of the projected motion.
    plants : sequence of Plant
    points : sequence of Effector
        Heels and toes, as the plants number them.
    """
    total, count = np.zeros((len(model.component_rows),) * 2), 0
    for plant in plants:
        frames = np.unique(np.linspace(plant.start, plant.stop, min(plant.frames, _LOOKS)).astype(np.intp))
        J = _point_rows(projection, model, poses, points[plant.point], frames).reshape(-1, len(total))
        # Each plant by its frames, not by how many of them are looked at.
        total += (plant.frames / len(frames)) * (J.T @ J)
        count += plant.frames
    return total / count if count else None


def _point_rows(
    projection: Projection, model: MotionModel, poses: WorldPoses, point: Effector, frames: IntArray
) -> FloatArray:
    """Return d(position) / d beta of a point at some frames, shape (N, 3, m), metres.

    A change dv of a joint's rotation vector is the world-axis increment R_j J_l(v)^T dv, as in `chain.evaluate`.
    """
    scale, motion = model.space.scale, projection.motion
    column_of = {int(j): k for k, j in enumerate(projection.joints)}
    joints = [int(j) for j in motion.skeleton.chain(point.joint) if int(j) in column_of]
    if not joints:
        return np.zeros((len(frames), 3, len(model.component_rows)))
    columns = [column_of[j] for j in joints]
    places = np.floor(projection.places[frames] + 0.5).astype(np.intp)
    rows = np.moveaxis(model.component_rows[:, places], 0, -1)
    turns = rows[:, 3:].reshape(len(frames), -1, 3, rows.shape[-1])[:, columns]
    v = projection.rows[frames, 3:].reshape(len(frames), -1, 3)[:, columns]
    _, jacobians = exp_and_left_jacobian(v.reshape(-1, 3))
    R = rot.to_matrix(poses.rotations[frames][:, joints])
    increments = R @ jacobians.reshape(*v.shape, 3).swapaxes(-1, -2)
    end = effector_positions(poses.at(slice(None)), point)[frames] if point.offset.any() else poses.positions[frames, point.joint]
    levers = rot.skew(poses.positions[frames][:, joints] - end[:, None]) * scale
    moved: FloatArray = ((levers @ increments) @ turns).sum(axis=1)
    if projection.travel in joints:
        to_world = rot.to_matrix(rot.conjugate(projection.alignment.rotation))
        moved = moved + to_world @ rows[:, :3] / model.space.root_weight
    return moved
