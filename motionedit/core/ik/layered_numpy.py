"""The layered solver in numpy: the readable reference, and what runs where nothing could be compiled.

All frames iterate together; those that have converged leave.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.ik.homing import Memory, accelerated, attraction
from motionedit.core.ik.layers import Descent, descend
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.ik.layered_solver import HingeColumns, LayeredSolution, Problem, WeightedTask
    from motionedit.core.ik.tasks import Columns

# Metres at leg length 0.85 m: a layer's error is clamped to this much per iteration.
LARGEST_ERROR = 0.6
# Radians: no joint turns further than this in one iteration.
LARGEST_TURN = 0.5
# Radians and metres: a frame is done when its largest step falls below,
STOP_STEP = 1e-4
# or when the steps to come, by the ratio of the last two, add up to less than this, and the layers are met to that.
STOP_LEFT, STOP_ERROR = 2e-5, 1e-5
# The gain of the attraction: 1 at first, then this factor per iteration.
FULL_GAIN_ITERATIONS = 8
GAIN_DECAY = 0.85
# Over so many last iterations the lower layers' largest error and the gain are halved each time.
ANNEALED_ITERATIONS = 10
# A hinge that leaves its limits is set on them and leaves the system; this many times at most.
LIMIT_ROUNDS = 4
# Radians: so far beyond its limit a hinge is on it.
_ON_LIMIT = 1e-12
# Frames solved together: more would leave the processor's cache.
BLOCK = 1024


def solve(problem: Problem, solution: LayeredSolution, *, in_order: bool) -> None:
    """Solve every frame of `solution` from where it is, in place; see `layered_solver.solve_layers`."""
    count = len(solution.iterations)
    if not in_order:
        for block in range(0, count, BLOCK):
            _iterate(problem, solution, np.arange(block, min(block + BLOCK, count)))
        return
    columns, motion = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    for frame in range(count):
        if frame:
            motion.rotations[frame, columns.joints] = motion.rotations[frame - 1, columns.joints]
            if problem.moves_root:
                motion.translations[frame, root] = motion.translations[frame - 1, root]
        _iterate(problem, solution, np.array([frame]))


def _iterate(problem: Problem, solution: LayeredSolution, frames: IntArray) -> None:
    columns, state = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    first = int(frames[0])
    memory = Memory.empty(len(frames), columns.size)
    moved_before = np.zeros(len(frames))
    for iteration in range(problem.max_iterations):
        here = frames - first
        motion = Motion(state.skeleton, state.rotations[frames], state.translations[frames], state.frame_time)
        poses = forward(motion)
        step, descent = _step(problem, poses, motion, frames, iteration, root, memory, here)
        largest = np.linalg.norm(step[:, :-3].reshape(len(frames), -1, 3), axis=2).max(axis=1, initial=0.0)
        step *= np.minimum(1.0, LARGEST_TURN / np.maximum(largest, LARGEST_TURN))[:, None]
        _apply(state, frames, columns, poses, step, root)
        memory.keep(here, descent, step)
        solution.iterations[frames] = iteration + 1
        solution.ranks[frames] = descent.ranks
        moved = np.maximum(np.minimum(largest, LARGEST_TURN), np.linalg.norm(step[:, -3:], axis=1))
        done = moved < STOP_STEP
        nearly = np.flatnonzero(~done & (_left(moved, moved_before[here]) < STOP_LEFT))
        if len(nearly):
            done[nearly[_are_met(problem, solution, frames[nearly])]] = True
        moved_before[here] = moved
        solution.converged[frames[done]] = True
        frames = frames[~done]
        if not len(frames):
            break


def _left(moved: FloatArray, before: FloatArray) -> FloatArray:
    """Return what the steps to come add up to, from the lengths of the last two, shape (N,): moved r / (1 - r).

    Steps that shrink by a ratio of r = 1/2 and more promise nothing.
    """
    ratio = moved / np.maximum(before, 1e-300)
    shrinking = ratio < 0.5
    left: FloatArray = np.where(shrinking, moved * ratio / np.where(shrinking, 1.0 - ratio, 1.0), np.inf)
    return left


def _are_met(problem: Problem, solution: LayeredSolution, frames: IntArray) -> BoolArray:
    """Return which frames meet every layer, shape (N,)."""
    state = solution.motion
    motion = Motion(state.skeleton, state.rotations[frames], state.translations[frames], state.frame_time)
    poses = forward(motion)
    met = np.ones(len(frames), dtype=np.bool_)
    for layer in problem.layers:
        met &= np.linalg.norm(_evaluated(layer, poses, motion.rotations, frames)[0], axis=1) < STOP_ERROR
    return met


def _apply(
    state: Motion, frames: IntArray, columns: Columns, poses: WorldPoses, step: FloatArray, root: int
) -> None:
    """Turn the column joints by world-axis increments, q <- exp(R_parent^-1 w) q, and shift the root."""
    skeleton, joints = columns.skeleton, columns.joints
    turns = step[:, :-3].reshape(len(frames), -1, 3).copy()
    parents = skeleton.parents[joints]
    inner = parents >= 0
    turns[:, inner] = rot.rotate(rot.conjugate(poses.rotations[:, parents[inner]]), turns[:, inner])
    q = rot.multiply(rot.exp(turns), state.rotations[frames[:, None], joints])
    state.rotations[frames[:, None], joints] = rot.normalize(q)
    if len(skeleton.translated):
        shift, above = step[:, -3:], int(skeleton.parents[columns.root])
        if above >= 0:
            shift = rot.rotate(rot.conjugate(poses.rotations[:, above]), shift)
        state.translations[frames, root] += shift


def _step(
    problem: Problem,
    poses: WorldPoses,
    motion: Motion,
    frames: IntArray,
    iteration: int,
    root: int,
    memory: Memory,
    here: IntArray,
) -> tuple[FloatArray, Descent]:
    """Return the step, shape (N, n), and the descent behind it; hinges that leave their limits are set on them."""
    anneal = 2.0 ** min(0, problem.max_iterations - ANNEALED_ITERATIONS - iteration - 1)
    gain = problem.attraction * GAIN_DECAY ** max(0, iteration + 1 - FULL_GAIN_ITERATIONS) * anneal
    hinges = _Hinges(problem, poses, motion)
    evaluated = [_evaluated(layer, poses, motion.rotations, frames) for layer in problem.layers]
    evaluated = [(e, hinges.on_axes(J)) for e, J in evaluated]
    z = hinges.on_axes(attraction(problem, poses, motion, frames, root)[:, None])[:, 0]
    largest_errors = [LARGEST_ERROR * (1.0 if level == 0 else anneal) for level in range(len(evaluated))]
    everything = np.ones(z.shape, dtype=np.bool_)
    descent = descend(evaluated, z, fixed=np.zeros_like(z), free=everything, largest_errors=largest_errors)
    hinges.keep_limits(evaluated, z, descent, largest_errors, gain)
    step = descent.tasks + gain * descent.home
    fast = descent.tasks + gain * accelerated(memory, here, descent, on_axes=hinges.on_axes)
    within = ~hinges.out_of_limits(fast, descent.free).any(axis=1)
    return np.where(within[:, None], fast, step), descent


def _evaluated(
    layer: Sequence[WeightedTask], poses: WorldPoses, local: FloatArray, frames: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return a layer's weighted errors (N, k) and rows (N, k, n)."""
    parts = [(each.weight, *each.task.evaluate(poses, local, frames)) for each in layer]
    e = np.concatenate([weight * error for weight, error, _ in parts], axis=1)
    J = np.concatenate([weight * rows for weight, _, rows in parts], axis=1)
    return e, J


class _Hinges:
    """The hinges of N frames: world axes (N, H, 3), angles (N, H) in rad, and their unknowns `blocks` (H, 3)."""

    def __init__(self, problem: Problem, poses: WorldPoses, motion: Motion) -> None:
        hinges = problem.hinges
        joints = problem.columns.joints[hinges.places]
        parents = problem.columns.skeleton.parents[joints]
        inner = parents >= 0
        # A turn about an axis leaves it where the parent has it.
        self.axes = np.repeat(hinges.axes[None], len(motion), axis=0)
        self.axes[:, inner] = rot.rotate(poses.rotations[:, parents[inner]], self.axes[:, inner])
        self.angles = np.einsum("nhc,hc->nh", rot.log(motion.rotations[:, joints]), hinges.axes)
        self.limits = hinges.limits
        self.places = hinges.places
        self.blocks = 3 * hinges.places[:, None] + np.arange(3)

    def on_axes(self, J: FloatArray) -> FloatArray:
        """Return rows, shape (N, k, n), with each hinge's block projected on its axis: J_j <- (J_j a) a^T."""
        if not len(self.places):
            return J
        J = J.copy()
        blocks = J[:, :, :-3].reshape(*J.shape[:2], -1, 3)
        along = np.einsum("nkhc,nhc->nkh", blocks[:, :, self.places], self.axes)
        blocks[:, :, self.places] = along[..., None] * self.axes[:, None]
        J[:, :, :-3] = blocks.reshape(*J.shape[:2], -1)
        return J

    def out_of_limits(self, step: FloatArray, free: BoolArray) -> BoolArray:
        """Return which free hinges a step (N, n) would take beyond their limits, shape (N, H)."""
        after = self._after(step)
        out: BoolArray = (np.abs(after - self._limited(after)) > _ON_LIMIT) & free[:, self.blocks[:, 0]]
        return out

    def keep_limits(
        self,
        evaluated: Sequence[tuple[FloatArray, FloatArray]],
        z: FloatArray,
        descent: Descent,
        largest_errors: Sequence[float],
        gain: float,
    ) -> None:
        """Set hinges that would leave their limits on them, take them out of the system, and descend again."""
        if not len(self.places):
            return
        fixed, free = np.zeros_like(z), descent.free.copy()
        for _ in range(LIMIT_ROUNDS):
            step = descent.tasks + gain * descent.home
            out = self.out_of_limits(step, free)
            again = np.flatnonzero(out.any(axis=1))
            if not len(again):
                break
            onto = self._limited(self._after(step)) - self.angles
            for h in np.flatnonzero(out.any(axis=0)):
                rows = np.flatnonzero(out[:, h])
                fixed[rows[:, None], self.blocks[h]] = onto[rows, h, None] * self.axes[rows, h]
                free[rows[:, None], self.blocks[h]] = False
            part = [(e[again], J[again]) for e, J in evaluated]
            new = descend(part, z[again], fixed=fixed[again], free=free[again], largest_errors=largest_errors)
            descent.replace_rows(again, new)

    def _after(self, step: FloatArray) -> FloatArray:
        after: FloatArray = self.angles + np.einsum("nhc,nhc->nh", step[:, self.blocks], self.axes)
        return after

    def _limited(self, angles: FloatArray) -> FloatArray:
        limited: FloatArray = np.clip(angles, self.limits[:, 0], self.limits[:, 1])
        return limited
