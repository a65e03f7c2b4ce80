"""The layered solver in numpy: the readable reference, and what runs where nothing could be compiled.

All frames iterate together; those that have converged leave.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.constants import (
    ANNEALED_ITERATIONS,
    FULL_GAIN_ITERATIONS,
    GAIN_DECAY,
    HASTY_ITERATIONS,
    LARGEST_ERROR,
    LARGEST_RATIO,
    LARGEST_TURN,
    LIMIT_ROUNDS,
    ON_LIMIT,
    STOP_ERROR,
    STOP_LEFT,
    STOP_STEP,
)
from motionedit.core.priorities.homing import Memory, accelerated, attraction
from motionedit.core.priorities.layers import Descent, descend
from motionedit.core.priorities.problem import Reference
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.priorities.points import Columns
    from motionedit.core.priorities.problem import LayeredSolution, Problem, WeightedTask

# Frames solved together: more would leave the processor's cache.
BLOCK = 1024


def solve(
    problem: Problem, solution: LayeredSolution, reference: Reference, frames: IntArray, *, in_order: bool
) -> None:
    """Solve those `frames` of a motion that are not converged from where they are, as `solve_layers`."""
    whole = solution.motion
    part = Motion(whole.skeleton, whole.rotations[frames], whole.translations[frames], whole.frame_time)
    root = None if reference.root is None else reference.root[frames]
    _solve(problem, replace(solution, motion=part), Reference(reference.rotations[frames], root), in_order=in_order)
    whole.rotations[frames], whole.translations[frames] = part.rotations, part.translations


def _solve(problem: Problem, solution: LayeredSolution, reference: Reference, *, in_order: bool) -> None:
    """Solve every frame of `solution` that is not converged, in place."""
    count = len(solution.iterations)
    if not in_order:
        for block in range(0, count, BLOCK):
            frames = np.arange(block, min(block + BLOCK, count))
            _iterate(problem, solution, reference, frames[~solution.converged[frames]])
        return
    columns, motion = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    for frame in range(count):
        if frame:
            motion.rotations[frame, columns.joints] = motion.rotations[frame - 1, columns.joints]
            if problem.moves_root:
                motion.translations[frame, root] = motion.translations[frame - 1, root]
        _iterate(problem, solution, reference, np.array([frame]))


@dataclass(frozen=True, eq=False)
class _Block:
    """Frames from `first` on that iterate together, with what they remember; `root` is its place among translations."""

    problem: Problem
    reference: Reference
    memory: Memory
    first: int
    root: int


@dataclass(frozen=True, eq=False)
class _Pose:
    """Where N `frames` of a block are."""

    frames: IntArray
    motion: Motion
    world: WorldPoses

    @classmethod
    def of(cls, state: Motion, frames: IntArray) -> _Pose:
        motion = Motion(state.skeleton, state.rotations[frames], state.translations[frames], state.frame_time)
        return cls(frames, motion, forward(motion))


def _iterate(problem: Problem, solution: LayeredSolution, reference: Reference, frames: IntArray) -> None:
    columns, state = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    if not len(frames):
        return
    first, count = int(frames[0]), int(frames[-1] - frames[0]) + 1
    block = _Block(problem, reference, Memory.empty(count, columns.size), first, root)
    memory, moved_before = block.memory, np.zeros(count)
    for iteration in range(problem.max_iterations):
        here = frames - block.first
        pose = _Pose.of(state, frames)
        hinges = _Hinges(problem, pose)
        step, descent = _step(block, pose, hinges, iteration)
        largest = np.linalg.norm(step[:, :-3].reshape(len(frames), -1, 3), axis=2).max(axis=1, initial=0.0)
        step *= np.minimum(1.0, LARGEST_TURN / np.maximum(largest, LARGEST_TURN))[:, None]
        _apply(state, columns, pose, hinges.in_world(step), root)
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

    Steps that shrink by a larger ratio than `LARGEST_RATIO` promise nothing.
    """
    ratio = moved / np.maximum(before, 1e-300)
    shrinking = ratio < LARGEST_RATIO
    left: FloatArray = np.where(shrinking, moved * ratio / np.where(shrinking, 1.0 - ratio, 1.0), np.inf)
    return left


def _are_met(problem: Problem, solution: LayeredSolution, frames: IntArray) -> BoolArray:
    """Return which frames meet every layer, shape (N,)."""
    pose = _Pose.of(solution.motion, frames)
    errors = [_evaluated(layer, pose)[0] for layer in problem.layers]
    met: BoolArray = np.all([np.linalg.norm(e, axis=1) < STOP_ERROR for e in errors], axis=0)
    return met


def _apply(state: Motion, columns: Columns, pose: _Pose, step: FloatArray, root: int) -> None:
    """Turn the column joints by world-axis increments, q <- exp(R_parent^-1 w) q, and shift the root."""
    skeleton, joints, frames = columns.skeleton, columns.joints, pose.frames
    turns = step[:, :-3].reshape(len(frames), -1, 3).copy()
    parents = skeleton.parents[joints]
    inner = parents >= 0
    turns[:, inner] = rot.rotate(rot.conjugate(pose.world.rotations[:, parents[inner]]), turns[:, inner])
    q = rot.multiply(rot.exp(turns), state.rotations[frames[:, None], joints])
    state.rotations[frames[:, None], joints] = rot.normalize(q)
    if len(skeleton.translated):
        shift, above = step[:, -3:], int(skeleton.parents[columns.root])
        if above >= 0:
            shift = rot.rotate(rot.conjugate(pose.world.rotations[:, above]), shift)
        state.translations[frames, root] += shift


def _step(block: _Block, pose: _Pose, hinges: _Hinges, iteration: int) -> tuple[FloatArray, Descent]:
    """Return the step, shape (N, n), and the descent behind it; hinges that leave their limits are set on them."""
    problem = block.problem
    anneal = 2.0 ** min(0, problem.max_iterations - ANNEALED_ITERATIONS - iteration - 1)
    gain = problem.attraction * GAIN_DECAY ** max(0, iteration + 1 - FULL_GAIN_ITERATIONS) * anneal
    evaluated = [_evaluated(layer, pose) for layer in problem.layers]
    evaluated = [(e, _shifts(problem, pose, hinges.on_axes(J))) for e, J in evaluated]
    z = attraction(problem.columns, block.reference, pose.world, pose.motion, pose.frames)
    z = _shifts(problem, pose, hinges.on_axes(z[:, None]))[:, 0]
    largest_errors = [LARGEST_ERROR * (1.0 if level == 0 else anneal) for level in range(len(evaluated))]
    everything = np.ones(z.shape, dtype=np.bool_)
    down = partial(descend, largest_errors=largest_errors, steady=iteration >= HASTY_ITERATIONS)
    descent = down(evaluated, z, fixed=np.zeros_like(z), free=everything)
    hinges.keep_limits(evaluated, z, descent, down, gain)
    step = descent.tasks + gain * descent.home
    home = accelerated(block.memory, pose.frames - block.first, descent)
    fast = descent.tasks + gain * home
    outside = hinges.out_of_limits(fast, descent.free).any(axis=1, keepdims=True)
    return np.where(outside, step, fast), descent


def _shifts(problem: Problem, pose: _Pose, J: FloatArray) -> FloatArray:
    """Return rows, shape (N, k, n), with what they have of the root's shift along the axes that its channels have."""
    columns = problem.columns
    if columns.root_is_free:
        return J
    along = np.zeros((len(J), 3, 3))
    kept = columns.skeleton.position_axes[columns.root]
    along[:, kept, kept] = 1.0
    above = int(columns.skeleton.parents[columns.root])
    if above >= 0:
        turn = rot.to_matrix(pose.world.rotations[:, above])
        along = turn @ along @ np.swapaxes(turn, 1, 2)
    J = J.copy()
    J[:, :, -3:] = J[:, :, -3:] @ along
    return J


def _evaluated(layer: Sequence[WeightedTask], pose: _Pose) -> tuple[FloatArray, FloatArray]:
    """Return a layer's weighted errors (N, k) and rows (N, k, n)."""
    local = pose.motion.rotations
    parts = [(each.weight, *each.task.evaluate(pose.world, local, pose.frames)) for each in layer]
    e = np.concatenate([weight * error for weight, error, _ in parts], axis=1)
    J = np.concatenate([weight * rows for weight, _, rows in parts], axis=1)
    return e, J


class _Hinges:
    """The hinges of N frames: world axes (N, H, 3), angles (N, H) in rad, their columns' unknowns `blocks` (H, 3).

    Of a column's three unknowns the first is the turn about its hinge's axis, the second about that of its second
    hinge, if any; the others stay 0. `turns` (H,) is the unknown that is each hinge's turn.
    """

    def __init__(self, problem: Problem, pose: _Pose) -> None:
        hinges = problem.hinges
        joints = problem.columns.joints[hinges.places]
        parents = problem.columns.skeleton.parents[joints]
        inner = parents >= 0
        # A turn about an axis leaves it where the parent has it; the second of two is where the joint itself has it.
        self.axes = np.repeat(hinges.axes[None], len(pose.frames), axis=0)
        carriers = np.where(hinges.second, joints, parents)
        carried = inner | hinges.second
        self.axes[:, carried] = rot.rotate(pose.world.rotations[:, carriers[carried]], self.axes[:, carried])
        self.angles = np.einsum("nhc,hc->nh", rot.log(pose.motion.rotations[:, joints]), hinges.axes)
        self.limits = hinges.limits
        self.places = hinges.places
        self.blocks = 3 * hinges.places[:, None] + np.arange(3)
        self.turns = 3 * hinges.places + hinges.second
        self.pairs = np.flatnonzero(hinges.second)

    def on_axes(self, J: FloatArray) -> FloatArray:
        """Return rows, shape (N, k, n), with what they have along each hinge's axis in its first unknown."""
        if not len(self.places):
            return J
        J = J.copy()
        along = np.einsum("nkhc,nhc->nkh", J[:, :, self.blocks], self.axes)
        J[:, :, self.blocks] = 0.0
        J[:, :, self.turns] = along
        return J

    def in_world(self, step: FloatArray) -> FloatArray:
        """Return a step, shape (N, n), with each hinge's turn as a world-axis increment."""
        if not len(self.places):
            return step
        turns = step[:, self.turns, None] * self.axes
        step = step.copy()
        step[:, self.blocks] = turns
        for second in self.pairs:
            # The first hinge turns what the second has turned: exactly so, or the joint would leave its two channels.
            both = rot.multiply(rot.exp(turns[:, second - 1]), rot.exp(turns[:, second]))
            step[:, self.blocks[second]] = rot.log(both)
        return step

    def out_of_limits(self, step: FloatArray, free: BoolArray) -> BoolArray:
        """Return which free hinges a step (N, n) would take beyond their limits, shape (N, H)."""
        after = self._after(step)
        out: BoolArray = (np.abs(after - self._limited(after)) > ON_LIMIT) & free[:, self.turns]
        return out

    def keep_limits(
        self,
        evaluated: Sequence[tuple[FloatArray, FloatArray]],
        z: FloatArray,
        descent: Descent,
        down: Callable[..., Descent],
        gain: float,
    ) -> None:
        """Set hinges that would leave their limits on them, take them out of the system, and go `down` again."""
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
                fixed[rows, self.turns[h]] = onto[rows, h]
                free[rows, self.turns[h]] = False
            part = [(e[again], J[again]) for e, J in evaluated]
            new = down(part, z[again], fixed=fixed[again], free=free[again])
            descent.replace_rows(again, new)

    def _after(self, step: FloatArray) -> FloatArray:
        after: FloatArray = self.angles + step[:, self.turns]
        return after

    def _limited(self, angles: FloatArray) -> FloatArray:
        limited: FloatArray = np.clip(angles, self.limits[:, 0], self.limits[:, 1])
        return limited
