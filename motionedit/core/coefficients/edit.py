"""The edit by motion principal coefficients: goals at single frames, the whole clip follows ([PC] 4.2, 4.3).

The edited clip is the input plus a displacement in the space of the components, in the input's own timing:

    v'(f) = v(f) + E(s(f)) beta,   beta = alpha - alpha_0

which is eq. (3) with the residual kept inside: beta = 0 is the input itself, and a goal at any frame of the input is
met exactly in the output. `residual="drop"` gives the paper's eq. (3) alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.coefficients.about_goals import components_about
from motionedit.core.coefficients.algorithm_1 import solve_damped
from motionedit.core.coefficients.blame import rivals_of
from motionedit.core.coefficients.evidence import likeliest_share
from motionedit.core.coefficients.goal_chains import columns_behind, columns_of, goal_of
from motionedit.core.coefficients.goals import stacked_errors
from motionedit.core.coefficients.likeliest import likeliest_change
from motionedit.core.coefficients.methods import GaussNewton, Likeliest
from motionedit.core.coefficients.one_more import change_of_alpha, with_one_more
from motionedit.core.coefficients.prior import FADE, change_prior, interpolated
from motionedit.core.coefficients.projection import Projection, with_rows
from motionedit.core.coefficients.solver import CoefficientSolution, solve_goals
from motionedit.core.timeline.interpolation import low_pass, monotone_cubic, natural_spline
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.coefficients.goals import Goal
    from motionedit.core.coefficients.methods import Damped
    from motionedit.core.coefficients.planted_feet import PlantedFoot
    from motionedit.core.coefficients.prior import ChangePrior
    from motionedit.core.motion import Motion
    from motionedit.core.pca.model import MotionModel

Residual = Literal["keep", "drop"]

# Seconds: what the component rows are low-passed by before they are interpolated in time. On a clip finer than the
# timeline their corners would otherwise show as jerk.
COMPONENT_SMOOTHING = 0.040
# Seconds: by what instead, for goals at several frames. To lead from one to the next components are stretched, and of a
# few motions what goes faster than changes between motions fade is mostly their own. Noise that is low-passed by this
# correlates in time as the residual does: a Gaussian with itself is one sqrt(2) times as wide.
SMOOTHING_OF_SEVERAL = FADE / math.sqrt(2.0)

# The residual has the whole pose at each goal's frame, so that what moves together stays together; with more unknowns
# than this only what moves the goals, or a dense matrix of them all would take seconds.
MOST_UNKNOWNS = 1500

# Radians or metres: a displacement below this is rounding, and leaves its joint untouched.
UNTOUCHED = 1e-10


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
    changes : tuple of Change
        One; or one for each frame with goals, in order, where these were solved each by itself.
    coefficients : shape (m,)
        alpha after the edit, of the first change.
    """

    motion: Motion
    touched: BoolArray
    moved: BoolArray
    changes: tuple[Change, ...]
    coefficients: FloatArray

    @property
    def norm(self) -> float | None:
        """The largest norm of a change in standard deviations of the database; None where no prior measures it."""
        return max((change.norm for change in self.changes if change.norm is not None), default=None)

    @property
    def share(self) -> float | None:
        """The largest share of a change's variance that might leave the components; None where no prior has one."""
        return max((change.share for change in self.changes if change.share is not None), default=None)

    @property
    def reasons(self) -> dict[int, str]:
        """Why the solver stopped, for each request by its place among them."""
        return {i: reason for change in self.changes for i, reason in change.reasons.items()}

    @property
    def rivals(self) -> dict[int, tuple[int, ...]]:
        """Of each request that gave way, by its place, those that it gave way to."""
        return {i: rivals for change in self.changes for i, rivals in (change.rivals or {}).items()}


@dataclass(frozen=True, eq=False)
class Change:
    """What a solver found for goals that are solved together.

    Attributes
    ----------
    solution : CoefficientSolution
        Its `change` is beta, with that of `with_one_more` where the clip counts as one more motion.
    reasons : mapping of int to str
        Why it stopped, for each request by its place; ``stood`` of one that was met but for feet that stand.
    frames : tuple of int
        The goals' frames, increasing.
    norm : float or None
        As of the edit.
    residual : shape (K, n) or None
        What leaves the components at those frames, columns of Theta.
    share : float or None
        g of the prior.
    rivals : mapping of int to tuple of int, or None
        Of each request that gave way, by its place, those that it gave way to.
    """

    solution: CoefficientSolution
    reasons: dict[int, str]
    frames: tuple[int, ...]
    norm: float | None = None
    residual: FloatArray | None = None
    share: float | None = None
    rivals: Mapping[int, tuple[int, ...]] | None = None


def edit_by_coefficients(
    projection: Projection,
    model: MotionModel,
    requests: Sequence[GoalRequest],
    *,
    solver: Likeliest | GaussNewton | Damped,
    residual: Residual,
    first: int,
    per_goal: bool = False,
) -> CoefficientEdit:
    """Return the clip edited so that every goal is met, or as nearly as the solver's bound allows.

    Parameters
    ----------
    first : int
        Frames before this one are a rest pose and stay as they are.
    per_goal : bool
        Solve each frame that has goals by itself, and interpolate the coefficients between them over time.
    """
    rows, smoothing = base_rows(projection, model, residual=residual)
    places = list(range(len(requests)))
    frames = sorted({request.frame for request in requests})
    groups = [[i for i in places if requests[i].frame == frame] for frame in frames] if per_goal else [places]
    columns = columns_behind(projection, requests)
    known = joined = model
    if isinstance(solver, Likeliest):
        together = 1 if per_goal else len(frames)
        if together * model.space.size <= MOST_UNKNOWNS:
            columns = np.arange(model.space.size)
        columns = columns[~np.isin(columns, columns_of(projection, solver.still))]
        if together > 1 and residual == "keep":
            smoothing = SMOOTHING_OF_SEVERAL
        if solver.one_more:
            model = joined = with_one_more(known, projection.deviation)
        if frames:
            model = components_about(
                model,
                projection.places[frames],
                believed=solver.believed,
                heading=solver.heading,
                position=solver.position,
            )
    given = _Given(projection, model, rows, smoothing, columns, solver)
    changes = tuple(_solve(given, requests, group) for group in groups) or (_solve(given, requests, places),)
    displacement = _displacement(given, changes)
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
        changes=changes,
        coefficients=frozen(projection.coefficients + change_of_alpha(changes[0].solution.change, known, joined)),
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


@dataclass(frozen=True, eq=False)
class _Given:
    """What all goals of an edit share: `rows` and `smoothing` of `base_rows`, and the `columns` behind the goals."""

    projection: Projection
    model: MotionModel
    rows: FloatArray
    smoothing: float
    columns: IntArray
    solver: Likeliest | GaussNewton | Damped


def _displacement(given: _Given, changes: Sequence[Change]) -> FloatArray:
    """Return what the changes add to the rows, shape (F, n)."""
    model, places = given.model, given.projection.places
    if len(changes) == 1:
        displacement = component_displacement(model, changes[0].solution.change, places, smoothing=given.smoothing)
    else:
        # Between the goals' frames the coefficients follow a monotone cubic; each frame has its own.
        at = np.array([float(change.frames[0]) for change in changes])
        betas = np.stack([change.solution.change for change in changes])
        frames = np.arange(len(places), dtype=np.float64)
        over_time = np.stack([monotone_cubic(at, track, frames) for track in betas.T], axis=1)
        displacement = np.zeros_like(given.rows)
        for beta, component in zip(over_time.T, np.eye(len(model.component_rows)), strict=True):
            displacement += beta[:, None] * component_displacement(model, component, places, smoothing=given.smoothing)
    residuals = [change.residual for change in changes if change.residual is not None]
    if residuals:
        frames_of = np.array([frame for change in changes for frame in change.frames], dtype=np.intp)
        faded = interpolated(np.concatenate(residuals), frames_of, len(places), given.projection.motion.frame_time)
        displacement[:, given.columns] += faded
    return displacement


def _solve(given: _Given, requests: Sequence[GoalRequest], group: Sequence[int]) -> Change:
    """Return the change that meets some of the requests, by their places."""
    projection, model, solver = given.projection, given.model, given.solver
    size = len(model.components.explained_variance)
    if not group:
        return Change(CoefficientSolution(np.zeros(size), 0, (0.0,), "converged"), {}, ())
    frames = tuple(sorted({requests[i].frame for i in group}))
    if isinstance(solver, Likeliest):
        return _likeliest(given, requests, group, frames, solver)
    goals = [goal_of(projection, model, given.rows, requests[i], smoothing=given.smoothing) for i in group]
    if isinstance(solver, GaussNewton):
        variance = model.components.explained_variance
        found = solve_goals(goals, explained_variance=variance, start=projection.coefficients, bound=solver.bound)
    else:
        found = solve_damped(
            goals,
            size=size,
            damping=solver.damping,
            tolerance=solver.tolerance,
            max_iterations=solver.max_iterations,
            unit=solver.unit,
        )
    return Change(found, dict.fromkeys(group, found.reason), frames)


def _likeliest(
    given: _Given, requests: Sequence[GoalRequest], group: Sequence[int], frames: tuple[int, ...], solver: Likeliest
) -> Change:
    projection, model = given.projection, given.model

    def prior_of(share: float, *, feet: Sequence[PlantedFoot]) -> ChangePrior:
        return change_prior(projection, model, frames=frames, columns=given.columns, share=share, feet=feet)

    def goals_of(places: Sequence[int], prior: ChangePrior) -> list[Goal]:
        return [
            goal_of(projection, model, given.rows, requests[i], smoothing=given.smoothing, prior=prior) for i in places
        ]

    share = solver.share
    if solver.most is not None and len(frames) > 1:
        apart = prior_of(share, feet=())
        error, jacobian = stacked_errors(goals_of(group, apart), np.zeros(apart.size))
        share = likeliest_share(error, jacobian, components=len(apart.deviations), share=share, most=solver.most)
    prior = prior_of(share, feet=solver.feet)
    layers = [
        [i for i in group if requests[i].priority == priority]
        for priority in sorted({requests[i].priority for i in group}, reverse=True)
    ]
    goals = [goals_of(layer, prior) for layer in layers]
    found = likeliest_change(goals, size=prior.size, bound=solver.bound)
    reasons = {i: reason for layer, reason in zip(layers, found.reasons, strict=True) for i in layer}
    places = [i for layer in layers for i in layer]
    blamed = rivals_of(goals, found, size=prior.size, bound=solver.bound)
    rivals = {places[k]: tuple(sorted(places[other] for other in others)) for k, others in blamed.items()}
    beta = prior.coefficients(found.change)
    return Change(
        CoefficientSolution(beta, found.iterations, found.history, found.reason),
        reasons | dict.fromkeys(rivals, "gave way"),
        frames,
        float(np.linalg.norm(found.change)),
        prior.residual(found.change),
        share,
        rivals,
    )
