"""The layered solver: tasks in strict priority layers, many frames iterated together ([PRIO] section 3, made strict).

Per frame and iteration, with Q the orthonormal rows of the layers above:

    A = w J,  b = w e - A dm,  A~ = A - (A Q^T) Q
    dm += sum_r v_r (u_r . b) s_r / (s_r^2 + lambda^2)    over the kept singular triples of A~; all kept v_r join Q
    dm += z - Q^T (Q z)                                   z pulls towards the reference, eq. (1)

The damping lambda is in the step, never in the projector, so a layer cannot disturb those above it to first order;
what it does to second order is annealed away: in the last iterations the steps of lower layers shrink to nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.ik.tasks import Columns, Task, posture_error
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray

# Metres at leg length 0.85 m: a layer's error is clamped to this much per iteration.
LARGEST_ERROR = 0.3
# Radians: no joint turns further than this in one iteration.
LARGEST_TURN = 0.5
# Radians and metres: a frame is done when its largest step falls below.
STOP_STEP = 1e-4
# Singular values below this share of the layer's largest (or of `_LEAST_SCALE`) are no freedom.
RANK_TOLERANCE = 1e-4
_LEAST_SCALE = 1e-3
# The gain of the attraction: 1 at first, then this factor per iteration.
_FULL_GAIN_ITERATIONS = 8
_GAIN_DECAY = 0.85
# Over so many last iterations the lower layers' largest error and the gain are halved each time.
_ANNEALED_ITERATIONS = 10
# A hinge that leaves its limits is set on them and leaves the system; this many times at most.
_LIMIT_ROUNDS = 4
# Frames solved together: more would leave the processor's cache.
BLOCK = 1024


@dataclass(frozen=True, eq=False)
class WeightedTask:
    """A task and its weight in its layer."""

    task: Task
    weight: float


@dataclass(frozen=True, eq=False)
class HingeColumns:
    """Columns that turn about one axis: their `places` (H,), axes (H, 3) in the joint, and limits (H, 2) in rad."""

    places: IntArray
    axes: FloatArray
    limits: FloatArray


@dataclass(frozen=True, eq=False)
class Problem:
    """What is solved in F frames: layers, the most important first, over common unknowns.

    Attributes
    ----------
    columns : Columns
    layers : tuple of tuples of WeightedTask
    hinges : HingeColumns
    reference_rotations : shape (F, J, 4)
        Local rotations that z pulls to.
    reference_root : shape (F, 3) or None
        Root translations that z pulls to; None leaves the root out of z.
    attraction : float
        Gain of z.
    max_iterations : int
    """

    columns: Columns
    layers: tuple[tuple[WeightedTask, ...], ...]
    hinges: HingeColumns
    reference_rotations: FloatArray
    reference_root: FloatArray | None
    attraction: float
    max_iterations: int


@dataclass(frozen=True, eq=False)
class LayeredSolution:
    """What came out: the motion, iterations per frame (F,), which frames converged (F,), rank per layer (F, L)."""

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray


def solve_layers(problem: Problem, start: Motion) -> LayeredSolution:
    """Return the frames of `start` moved so that the layers are met, each as far as those above it allow.

    All frames iterate together; those that have converged leave.
    """
    count = len(start)
    solution = _State(
        start.rotations.copy(),
        start.translations.copy(),
        np.zeros(count, dtype=np.intp),
        np.zeros(count, dtype=np.bool_),
        np.zeros((count, len(problem.layers)), dtype=np.intp),
    )
    for block in range(0, count, BLOCK):
        _iterate(problem, start, solution, np.arange(block, min(block + BLOCK, count)))
    motion = Motion(start.skeleton, solution.rotations, solution.translations, start.frame_time)
    return LayeredSolution(motion, solution.iterations, solution.converged, solution.ranks)


@dataclass(frozen=True, eq=False)
class _State:
    rotations: FloatArray
    translations: FloatArray
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray


def _iterate(problem: Problem, start: Motion, state: _State, frames: IntArray) -> None:
    skeleton, columns = start.skeleton, problem.columns
    root = int(np.searchsorted(skeleton.translated, columns.root))
    for iteration in range(problem.max_iterations):
        motion = Motion(skeleton, state.rotations[frames], state.translations[frames], start.frame_time)
        poses = forward(motion)
        step, ranks = _step(problem, poses, motion, frames, iteration, root)
        turns = step[:, :-3].reshape(len(frames), -1, 3)
        largest = np.linalg.norm(turns, axis=2).max(axis=1, initial=0.0)
        scale = np.minimum(1.0, LARGEST_TURN / np.maximum(largest, LARGEST_TURN))
        turns, shift = turns * scale[:, None, None], step[:, -3:] * scale[:, None]
        _apply(state, frames, columns, poses, turns, shift, root)
        state.iterations[frames] = iteration + 1
        state.ranks[frames] = ranks
        moved = np.maximum(largest * scale, np.linalg.norm(shift, axis=1))
        done = moved < STOP_STEP
        state.converged[frames[done]] = True
        frames = frames[~done]
        if not len(frames):
            break


def _apply(
    state: _State,
    frames: IntArray,
    columns: Columns,
    poses: WorldPoses,
    turns: FloatArray,
    shift: FloatArray,
    root: int,
) -> None:
    """Turn the column joints by world-axis increments, q <- exp(R_parent^-1 w) q, and shift the root."""
    skeleton, joints = columns.skeleton, columns.joints
    parents = skeleton.parents[joints]
    inner = parents >= 0
    local = turns.copy()
    inverse = rot.conjugate(poses.rotations[:, parents[inner]])
    local[:, inner] = rot.rotate(inverse, turns[:, inner])
    q = rot.multiply(rot.exp(local), state.rotations[frames[:, None], joints])
    state.rotations[frames[:, None], joints] = rot.normalize(q)
    if len(skeleton.translated):
        above = int(skeleton.parents[columns.root])
        if above >= 0:
            shift = rot.rotate(rot.conjugate(poses.rotations[:, above]), shift)
        state.translations[frames, root] += shift


def _step(
    problem: Problem, poses: WorldPoses, motion: Motion, frames: IntArray, iteration: int, root: int
) -> tuple[FloatArray, IntArray]:
    """Return dm, shape (N, n), and the layers' ranks, shape (N, L); hinges that leave their limits are set on them."""
    evaluated = [_evaluated(layer, poses, motion.rotations, frames) for layer in problem.layers]
    anneal = min(0, problem.max_iterations - _ANNEALED_ITERATIONS - iteration - 1)
    gain = problem.attraction * _GAIN_DECAY ** max(0, iteration + 1 - _FULL_GAIN_ITERATIONS) * 2.0**anneal
    z = gain * _attraction(problem, poses, motion, frames, root)
    largest_errors = [LARGEST_ERROR * (1.0 if level == 0 else 2.0**anneal) for level in range(len(evaluated))]
    hinges = problem.hinges
    axes = _world_axes(problem.columns, hinges, poses)
    evaluated = [(e, _on_axes(J, hinges, axes)) for e, J in evaluated]
    z = _on_axes(z[:, None], hinges, axes)[:, 0]
    dm, ranks = _layered_step(evaluated, z, np.zeros_like(z), np.ones(z.shape, dtype=np.bool_), largest_errors)
    if len(hinges.places):
        _keep_limits(problem, motion, evaluated, z, dm, ranks, axes, largest_errors)
    return dm, ranks


def _evaluated(
    layer: Sequence[WeightedTask], poses: WorldPoses, local: FloatArray, frames: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return a layer's weighted errors (N, k) and rows (N, k, n)."""
    parts = [(each.weight, *each.task.evaluate(poses, local, frames)) for each in layer]
    e = np.concatenate([weight * error for weight, error, _ in parts], axis=1)
    J = np.concatenate([weight * rows for weight, _, rows in parts], axis=1)
    return e, J


def _attraction(problem: Problem, poses: WorldPoses, motion: Motion, frames: IntArray, root: int) -> FloatArray:
    """Return z, shape (N, n): the increments that bring the column joints back to the reference."""
    columns = problem.columns
    targets = problem.reference_rotations[frames[:, None], columns.joints]
    z = np.zeros((len(frames), columns.size))
    turns = posture_error(columns.skeleton, poses, motion.rotations, joints=columns.joints, targets=targets)
    z[:, :-3] = turns.reshape(len(frames), -1)
    if problem.reference_root is not None and len(columns.skeleton.translated):
        back = problem.reference_root[frames] - motion.translations[:, root]
        above = int(columns.skeleton.parents[columns.root])
        z[:, -3:] = rot.rotate(poses.rotations[:, above], back) if above >= 0 else back
    return z


def _world_axes(columns: Columns, hinges: HingeColumns, poses: WorldPoses) -> FloatArray:
    """Return the hinges' axes in the world, shape (N, H, 3); a turn about an axis leaves it where its parent has it."""
    parents = columns.skeleton.parents[columns.joints[hinges.places]]
    return rot.rotate(
        poses.rotations[:, parents], np.broadcast_to(hinges.axes, (len(poses.rotations), *hinges.axes.shape))
    )


def _on_axes(J: FloatArray, hinges: HingeColumns, axes: FloatArray) -> FloatArray:
    """Return rows, shape (N, k, n), with each hinge's block projected on its axis: J_j <- (J_j a) a^T."""
    if not len(hinges.places):
        return J
    J = J.copy()
    blocks = J[:, :, :-3].reshape(*J.shape[:2], -1, 3)
    along = np.einsum("nkhc,nhc->nkh", blocks[:, :, hinges.places], axes)
    blocks[:, :, hinges.places] = along[..., None] * axes[:, None]
    J[:, :, :-3] = blocks.reshape(*J.shape[:2], -1)
    return J


def _keep_limits(
    problem: Problem,
    motion: Motion,
    evaluated: Sequence[tuple[FloatArray, FloatArray]],
    z: FloatArray,
    dm: FloatArray,
    ranks: IntArray,
    axes: FloatArray,
    largest_errors: Sequence[float],
) -> None:
    """Set hinges that would leave their limits on them, take them out of the system, and solve these frames again."""
    hinges = problem.hinges
    joints = problem.columns.joints[hinges.places]
    angles = np.einsum("nhc,hc->nh", rot.log(motion.rotations[:, joints]), hinges.axes)
    fixed = np.zeros_like(z)
    free = np.ones(z.shape, dtype=np.bool_)
    blocks = 3 * hinges.places[:, None] + np.arange(3)
    for _ in range(_LIMIT_ROUNDS):
        after = angles + np.einsum("nhc,nhc->nh", dm[:, blocks], axes)
        limited = np.clip(after, hinges.limits[:, 0], hinges.limits[:, 1])
        out = (np.abs(after - limited) > 1e-12) & free[:, blocks[:, 0]]
        again = np.flatnonzero(out.any(axis=1))
        if not len(again):
            break
        for h in np.flatnonzero(out.any(axis=0)):
            rows = np.flatnonzero(out[:, h])
            fixed[rows[:, None], blocks[h]] = (limited - angles)[rows, h, None] * axes[rows, h]
            free[rows[:, None], blocks[h]] = False
        part = [(e[again], J[again]) for e, J in evaluated]
        dm[again], ranks[again] = _layered_step(part, z[again], fixed[again], free[again], largest_errors)


def _layered_step(
    evaluated: Sequence[tuple[FloatArray, FloatArray]],
    z: FloatArray,
    fixed: FloatArray,
    free: BoolArray,
    largest_errors: Sequence[float],
) -> tuple[FloatArray, IntArray]:
    """Return dm and ranks of one pass down the layers; unknowns that are not free keep their part of `fixed`."""
    dm = fixed.copy()
    ranks = np.zeros((len(z), len(evaluated)), dtype=np.intp)
    Q: FloatArray | None = None
    for level, ((e, J), largest) in enumerate(zip(evaluated, largest_errors, strict=True)):
        size = np.linalg.norm(e, axis=1, keepdims=True)
        e = e * np.minimum(1.0, largest / np.maximum(size, largest))  # noqa: PLW2901
        b = e - (J @ dm[..., None])[..., 0]
        A = J * free[:, None]
        if Q is not None:
            A = A - (A @ np.swapaxes(Q, 1, 2)) @ Q
        change, rows, ranks[:, level] = _damped_step(A, b, largest)
        dm += change
        Q = rows if Q is None else np.concatenate((Q, rows), axis=1)
    z = z * free
    if Q is not None:
        z = z - (np.swapaxes(Q, 1, 2) @ (Q @ z[..., None]))[..., 0]
    return dm + z, ranks


def _damped_step(A: FloatArray, b: FloatArray, largest: float) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the layer's step (N, n), its orthonormal rows (N, k, n; zero where not kept), and its rank (N,).

    lambda follows the smallest kept singular value and the length of b: none where the step is safe.
    """
    values, vectors = np.linalg.eigh(A @ np.swapaxes(A, 1, 2))
    s = np.sqrt(np.maximum(values, 0.0))
    kept = s > RANK_TOLERANCE * np.maximum(s[:, -1:], _LEAST_SCALE)
    safe = np.where(kept, s, 1.0)
    rows = np.where(kept, 1.0 / safe, 0.0)[..., None] * (np.swapaxes(vectors, 1, 2) @ A)
    least = np.where(kept, s, np.inf).min(axis=1)
    d = np.linalg.norm(b, axis=1) / largest
    damping = np.where(least <= 0.5 * d, 0.5 * d, np.sqrt(np.maximum(least * (d - least), 0.0)))
    damping = np.where((least <= d) & np.isfinite(least), damping, 0.0)
    along = (np.swapaxes(vectors, 1, 2) @ b[..., None])[..., 0]
    weights = np.where(kept, along * safe / (safe**2 + damping[:, None] ** 2), 0.0)
    step: FloatArray = (weights[:, None] @ rows)[:, 0]
    return step, rows, np.count_nonzero(kept, axis=1)
