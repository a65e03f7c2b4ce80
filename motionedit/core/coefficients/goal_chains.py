"""The goals of an edit with their chains cut out of the components at their frames: J(E)_tk of [PC], Figure 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.coefficients.chain import CoefficientChain
from motionedit.core.coefficients.goals import Goal
from motionedit.core.measure import WORLD, Measure
from motionedit.core.timeline.interpolation import spline_weights
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.coefficients.prior import ChangePrior
    from motionedit.core.coefficients.projection import Projection
    from motionedit.core.kinematics import Effector
    from motionedit.core.pca.model import MotionModel


@dataclass(frozen=True, eq=False)
class GoalRequest:
    """A goal as asked for, in clip units.

    Attributes
    ----------
    frame : int
        Frame of the projected motion.
    effector : Effector
    position : shape (3,) or None
        As it is measured.
    rotation : shape (4,) or None
    weight : float
    measure : Measure
        What position and rotation are measured in.
    priority : int
        Larger is more important.
    """

    frame: int
    effector: Effector
    position: FloatArray | None
    rotation: FloatArray | None
    weight: float = 1.0
    measure: Measure = WORLD
    priority: int = 1


def goal_of(
    projection: Projection,
    model: MotionModel,
    rows: FloatArray,
    request: GoalRequest,
    *,
    smoothing: float,
    prior: ChangePrior | None = None,
) -> Goal:
    """Return the goal of a request.

    Parameters
    ----------
    rows : shape (F, n)
        Theta of every frame where nothing is changed.
    smoothing : float
        Seconds by which component rows are low-passed.
    prior : ChangePrior, optional
        The goal's unknowns are then its y; without it they are the change of coefficients.
    """
    scale = model.space.scale
    ends = _ends(request)
    chains = [_chain(projection, model, rows[request.frame], request.frame, joint) for joint, _ in ends]
    place, sigma = float(projection.places[request.frame]), smoothing * model.timeline.frame_rate
    first, weights = spline_weights(model.timeline.frames, place, sigma=sigma)
    components = (weights @ model.component_rows[:, first : first + len(weights)]).T
    full = []
    for (_, offset), (chain, columns) in zip(ends, chains, strict=True):
        known = np.flatnonzero(columns >= 0)
        wanted = np.concatenate([np.arange(3), *(3 + 3 * columns[k] + np.arange(3) for k in known)])
        slices = components[wanted]
        if prior is not None:
            slices = prior.rows_of(slices, wanted, request.frame)
        rotation_rows = np.zeros((len(columns), 3, slices.shape[1]))
        rotation_rows[known] = slices[3:].reshape(len(known), 3, -1)
        carries = projection.travel == chain.joints[0]
        travel_rows = slices[:3] / model.space.root_weight if carries else np.zeros_like(slices[:3])
        full.append(replace(chain.fixed, rows=rotation_rows, travel_rows=travel_rows, offset=offset * scale))
    return Goal(
        chain=full[0],
        position=None if request.position is None else request.position * scale,
        rotation=None if request.rotation is None else rot.to_matrix(request.rotation),
        weight=request.weight,
        measure=request.measure,
        base=full[1] if len(full) > 1 else None,
    )


def columns_behind(projection: Projection, requests: Sequence[GoalRequest]) -> IntArray:
    """Return the columns of Theta that move the effectors of requests, or what they are measured in, increasing."""
    skeleton = projection.motion.skeleton
    return columns_of(
        projection, [int(j) for request in requests for end, _ in _ends(request) for j in skeleton.chain(end)]
    )


def columns_of(projection: Projection, joints: Sequence[int]) -> IntArray:
    """Return the columns of Theta that hold joints' rotations, with the travel where its joint is among them."""
    known = np.flatnonzero(np.isin(projection.joints, list(joints)))
    travel = np.arange(3 if projection.travel in joints else 0)
    return np.concatenate((travel, (3 + 3 * known[:, None] + np.arange(3)).ravel())).astype(np.intp)


def _ends(request: GoalRequest) -> list[tuple[int, FloatArray]]:
    """Return the joints that a goal is about, the effector's and that of its measure, with the point in each."""
    ends = [(request.effector.joint, request.effector.offset)]
    return ends if request.measure.base is None else [*ends, (request.measure.base, np.zeros(3))]


@dataclass(frozen=True, eq=False)
class _PosedChain:
    joints: tuple[int, ...]
    fixed: CoefficientChain


def _chain(
    projection: Projection, model: MotionModel, row: FloatArray, frame: int, joint: int
) -> tuple[_PosedChain, IntArray]:
    """Return the chain to a joint, posed by a row of Theta, and each joint's column in the space (-1: none)."""
    motion, space = projection.motion, model.space
    skeleton = motion.skeleton
    joints = [int(j) for j in skeleton.chain(joint)]
    base_rotation, base_position = np.eye(3), np.zeros(3)
    carries = projection.travel in joints
    if carries:
        joints = joints[joints.index(projection.travel) :]
        base_rotation = rot.to_matrix(rot.conjugate(projection.alignment.rotation))
        base_position = projection.alignment.origin * space.scale
    places = skeleton.translation_places.tolist()
    translations = np.array(
        [motion.translations[frame, places[j]] if places[j] >= 0 else skeleton.offsets[j] for j in joints]
    )
    translations *= space.scale
    if carries:
        translations[0] = row[:3] / space.root_weight
    column_of = {int(j): k for k, j in enumerate(projection.joints)}
    columns = np.array([column_of.get(j, -1) for j in joints], dtype=np.intp)
    references = rot.to_matrix(motion.rotations[frame, joints])
    vectors = np.zeros((len(joints), 3))
    known = np.flatnonzero(columns >= 0)
    references[known] = rot.to_matrix(space.references[columns[known]])
    vectors[known] = row[3:].reshape(-1, 3)[columns[known]]
    empty = np.zeros((0, 0))
    fixed = CoefficientChain(base_rotation, base_position, translations, references, vectors, empty, empty, np.zeros(3))
    return _PosedChain(tuple(joints), fixed), columns
