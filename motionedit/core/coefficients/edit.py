"""The edit by motion principal coefficients: goals at single frames, the whole clip follows ([PC] 4.2, 4.3).

The edited clip is the input plus a displacement in the space of the components, in the input's own timing:

    v'(f) = v(f) + E(s(f)) beta,   beta = alpha - alpha_0

which is eq. (3) with the residual kept inside: beta = 0 is the input itself, and a goal at any frame of the input is
met exactly in the output. `residual="drop"` gives the paper's eq. (3) alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.coefficients.chain import CoefficientChain
from motionedit.core.coefficients.goals import Goal
from motionedit.core.coefficients.projection import Projection, with_rows
from motionedit.core.coefficients.solver import CoefficientSolution, solve_damped, solve_goals
from motionedit.core.measure import WORLD, Measure
from motionedit.core.timeline.interpolation import low_pass, natural_spline
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.kinematics import Effector
    from motionedit.core.motion import Motion
    from motionedit.core.pca.model import MotionModel

Residual = Literal["keep", "drop"]

# Seconds: what the component rows are low-passed by before they are interpolated in time. On a clip finer than the
# timeline their corners would otherwise show as jerk.
COMPONENT_SMOOTHING = 0.040

# Radians or metres: a displacement below this is rounding, and leaves its joint untouched.
UNTOUCHED = 1e-10


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
    """

    frame: int
    effector: Effector
    position: FloatArray | None
    rotation: FloatArray | None
    weight: float = 1.0
    measure: Measure = WORLD


@dataclass(frozen=True)
class GaussNewton:
    """The default solver; `bound` is the largest Mahalanobis norm allowed, None for no bound."""

    bound: float | None


@dataclass(frozen=True)
class Damped:
    """[PC]'s Algorithm 1; `unit` is metres (leg length 0.85 m) of the unit of damping and tolerance."""

    damping: float
    tolerance: float
    max_iterations: int | None
    unit: float


@dataclass(frozen=True, eq=False)
class CoefficientEdit:
    """What an edit did.

    Attributes
    ----------
    motion : Motion
    touched : shape (F, J)
        Which joints' rotations changed at which frames.
    moved : shape (F,)
        Frames at which the travel-carrying joint's translation changed.
    solution : CoefficientSolution
    coefficients : shape (m,)
        alpha after the edit.
    """

    motion: Motion
    touched: BoolArray
    moved: BoolArray
    solution: CoefficientSolution
    coefficients: FloatArray


def edit_by_coefficients(
    projection: Projection,
    model: MotionModel,
    requests: Sequence[GoalRequest],
    *,
    solver: GaussNewton | Damped,
    residual: Residual,
    first: int,
) -> CoefficientEdit:
    """Return the clip edited so that every goal is met, or as nearly as the solver's bound allows.

    Parameters
    ----------
    first : int
        Frames before this one are a rest pose and stay as they are.
    """
    rows, smoothing = base_rows(projection, model, residual=residual)
    goals = [_goal(projection, model, rows, request, smoothing=smoothing) for request in requests]
    solution = _solve(goals, model, solver, start=projection.coefficients)
    displacement = component_displacement(model, solution.change, projection.places, smoothing=smoothing)
    displacement[np.abs(displacement) < UNTOUCHED] = 0.0
    new_rows = rows + displacement
    new_rows[:first] = projection.rows[:first]
    motion = with_rows(projection, model.space, new_rows)
    changed = (new_rows != projection.rows).reshape(len(rows), -1, 3).any(axis=2)
    touched = np.zeros((len(rows), len(motion.skeleton)), dtype=np.bool_)
    touched[:, projection.joints] = changed[:, 1:]
    return CoefficientEdit(
        motion=motion,
        touched=touched,
        moved=changed[:, 0],
        solution=solution,
        coefficients=frozen(projection.coefficients + solution.change),
    )


def base_rows(projection: Projection, model: MotionModel, *, residual: Residual) -> tuple[FloatArray, float]:
    """Return the rows that a displacement is added to, shape (F, n), and the smoothing (s) of the component rows."""
    if residual == "keep":
        return projection.rows, COMPONENT_SMOOTHING
    rebuilt = model.mean_rows + np.tensordot(projection.coefficients, model.component_rows, axes=1)
    return natural_spline(rebuilt, projection.places), 0.0


def component_displacement(
    model: MotionModel, change: FloatArray, places: FloatArray, *, smoothing: float
) -> FloatArray:
    """Return E(s) beta at places s on the timeline, shape (len(places), n)."""
    displacement = np.tensordot(change, model.component_rows, axes=1)
    return natural_spline(low_pass(displacement, sigma=smoothing * model.timeline.frame_rate), places)


def _solve(
    goals: Sequence[Goal], model: MotionModel, solver: GaussNewton | Damped, *, start: FloatArray
) -> CoefficientSolution:
    if not goals:
        return CoefficientSolution(np.zeros(len(start)), 0, (0.0,), "converged")
    if isinstance(solver, GaussNewton):
        variance = model.components.explained_variance
        return solve_goals(goals, explained_variance=variance, start=start, bound=solver.bound)
    return solve_damped(
        goals,
        size=len(start),
        damping=solver.damping,
        tolerance=solver.tolerance,
        max_iterations=solver.max_iterations,
        unit=solver.unit,
    )


def _goal(
    projection: Projection, model: MotionModel, rows: FloatArray, request: GoalRequest, *, smoothing: float
) -> Goal:
    """Return the goal with its chains cut out of the components at its frame: J(E)_tk of [PC], Figure 1."""
    scale = model.space.scale
    ends = [(request.effector.joint, request.effector.offset)]
    if request.measure.base is not None:
        ends.append((request.measure.base, np.zeros(3)))
    chains = [_chain(projection, model, rows[request.frame], request.frame, joint) for joint, _ in ends]
    place = projection.places[request.frame : request.frame + 1]
    components = np.moveaxis(model.component_rows, 0, -1)
    sigma = smoothing * model.timeline.frame_rate
    full = []
    for (_, offset), (chain, columns) in zip(ends, chains, strict=True):
        known = np.flatnonzero(columns >= 0)
        wanted = np.concatenate([np.arange(3), *(3 + 3 * columns[k] + np.arange(3) for k in known)])
        slices = natural_spline(low_pass(components[:, wanted], sigma=sigma), place)[0]
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
    place = {int(j): p for p, j in enumerate(skeleton.translated)}
    translations = np.array(
        [motion.translations[frame, place[j]] if j in place else skeleton.offsets[j] for j in joints]
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
