"""The layered solver in numpy: the readable reference, and what runs where nothing could be compiled.

All frames iterate together; those that have converged leave.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.priorities.annealing import Annealing
from motionedit.core.priorities.cones import Cones, are_beyond
from motionedit.core.priorities.constants import (
    FULL_GAIN_ITERATIONS,
    GAIN_DECAY,
    HASTY_ITERATIONS,
    LARGEST_ERROR,
    LARGEST_RATIO,
    LARGEST_SOFT_ERROR,
    LARGEST_TURN,
    MET_WITHOUT_LIMITS,
    STOP_ERROR,
    STOP_LEFT,
    STOP_STEP,
)
from motionedit.core.priorities.hinged import Hinges
from motionedit.core.priorities.homing import Memory, accelerated, attraction
from motionedit.core.priorities.layers import Descent, descend
from motionedit.core.priorities.one_sided import Evaluated, Rows, Sides
from motionedit.core.priorities.problem import LayeredSolution, Reference
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.points import Columns
    from motionedit.core.priorities.problem import Problem, WeightedTask

# Frames solved together: more would leave the processor's cache.
BLOCK = 1024


def solve(
    problem: Problem,
    solution: LayeredSolution,
    reference: Reference,
    frames: IntArray,
    *,
    levels: IntArray,
    in_order: bool,
) -> None:
    """Solve those `frames` of a motion that are not converged from where they are, as `solve_layers`."""
    whole, shape = solution.motion, (len(frames), len(problem.layers))
    part = LayeredSolution(
        whole.at(frames),
        np.zeros(shape[0], dtype=np.int64),
        solution.converged[frames],
        np.zeros(shape, dtype=np.int64),
        np.zeros(shape),
    )
    root = None if reference.root is None else reference.root[frames]
    _solve(problem, part, Reference(reference.rotations[frames], root), in_order=in_order)
    whole.rotations[frames], whole.translations[frames] = part.motion.rotations, part.motion.translations
    solution.iterations[frames], solution.converged[frames] = part.iterations, part.converged
    # Of one priority there may be two layers.
    for layer, level in enumerate(levels.tolist()):
        solution.ranks[frames, level] += part.ranks[:, layer]
        solution.left[frames, level] = np.maximum(solution.left[frames, level], part.left[:, layer])


def _solve(problem: Problem, solution: LayeredSolution, reference: Reference, *, in_order: bool) -> None:
    """Solve every frame of `solution` that is not converged, in place."""
    count = len(solution.iterations)
    if not in_order:
        for block in range(0, count, BLOCK):
            frames = np.arange(block, min(block + BLOCK, count))
            _within_limits(problem, solution, reference, frames[~solution.converged[frames]])
        return
    columns, motion = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    for frame in range(count):
        if frame:
            motion.rotations[frame, columns.joints] = motion.rotations[frame - 1, columns.joints]
            if problem.moves_root:
                motion.translations[frame, root] = motion.translations[frame - 1, root]
        _within_limits(problem, solution, reference, np.array([frame]))


def _within_limits(problem: Problem, solution: LayeredSolution, reference: Reference, frames: IntArray) -> None:
    """Solve frames without limits of joints, and those whose solutions are beyond them on with these."""
    _iterate(problem, solution, reference, frames, limited=False)
    joints = problem.columns.joints[problem.limits.places]
    if not len(joints) or not len(frames):
        return
    left = np.where(problem.softness[frames] > 0.0, 0.0, solution.left[frames]).max(axis=1, initial=0.0)
    passed = are_beyond(problem.limits, solution.motion.rotations[frames[:, None], joints])
    beyond = frames[passed & (left <= MET_WITHOUT_LIMITS)]
    before = solution.iterations[beyond]
    solution.converged[beyond] = False
    _iterate(problem, solution, reference, beyond, limited=True)
    solution.iterations[beyond] += before


@dataclass(frozen=True, eq=False)
class _Block:
    """Frames from `first` on that iterate together, with what they remember; `root` is its place among translations."""

    problem: Problem
    reference: Reference
    memory: Memory
    sides: Sides
    annealing: Annealing
    first: int
    root: int
    limited: bool

    @cached_property
    def mobility(self) -> FloatArray:
        """Of every unknown, shape (n,)."""
        return np.repeat(self.problem.mobility, 3)


@dataclass(frozen=True, eq=False)
class _Pose:
    """Where N `frames` of a block are."""

    frames: IntArray
    motion: Motion
    world: WorldPoses

    @classmethod
    def of(cls, state: Motion, frames: IntArray) -> _Pose:
        motion = state.at(frames)
        return cls(frames, motion, forward(motion))

    def at(self, these: BoolArray) -> _Pose:
        """Return some of the frames."""
        motion, world = self.motion, self.world
        part = motion.at(these)
        return _Pose(self.frames[these], part, WorldPoses(world.positions[these], world.rotations[these]))


def _iterate(
    problem: Problem, solution: LayeredSolution, reference: Reference, frames: IntArray, *, limited: bool
) -> None:
    columns, state = problem.columns, solution.motion
    root = int(np.searchsorted(columns.skeleton.translated, columns.root))
    if not len(frames):
        return
    first, count = int(frames[0]), int(frames[-1] - frames[0]) + 1
    annealing = Annealing(
        count, len(problem.layers), problem.max_iterations, ends_early=problem.ends_early and not limited
    )
    block = _Block(problem, reference, Memory.empty(count, columns.size), Sides(count), annealing, first, root, limited)
    memory, moved_before = block.memory, np.zeros(count)
    for iteration in range(problem.max_iterations):
        here = frames - block.first
        pose = _Pose.of(state, frames)
        hinges = Hinges(problem, pose.motion.rotations, pose.world)
        step, descent = _step(block, pose, hinges, iteration)
        turns = (step * block.mobility)[:, :-3].reshape(len(frames), -1, 3)
        largest = np.linalg.norm(turns, axis=2).max(axis=1, initial=0.0)
        step *= np.minimum(1.0, LARGEST_TURN / np.maximum(largest, LARGEST_TURN))[:, None]
        _apply(state, columns, pose, hinges.in_world(step * block.mobility), root)
        memory.keep(here, descent, step)
        solution.iterations[frames] = iteration + 1
        solution.ranks[frames] = descent.ranks
        moved = np.maximum(np.minimum(largest, LARGEST_TURN), np.linalg.norm((step * block.mobility)[:, -3:], axis=1))
        done = moved < STOP_STEP
        nearly = np.flatnonzero(~done & (_left(moved, moved_before[here]) < STOP_LEFT))
        if done.any():
            solution.left[frames[done]] = _largest_left(problem, pose.at(done))
        if len(nearly):
            now = _Pose.of(state, frames[nearly])
            met = _are_met(problem, now)
            solution.left[frames[nearly]] = _largest_left(problem, now)
            done[nearly[met]] = True
        moved_before[here] = moved
        solution.converged[frames[done]] = True
        over = ~done & annealing.are_over(here, problem.softness[frames], iteration)
        if over.any():
            solution.left[frames[over]] = _largest_left(problem, _Pose.of(state, frames[over]))
        frames = frames[~(done | over)]
        if not len(frames):
            return
    solution.left[frames] = _largest_left(problem, _Pose.of(state, frames))


def _left(moved: FloatArray, before: FloatArray) -> FloatArray:
    """Return what the steps to come add up to, from the lengths of the last two, shape (N,): moved r / (1 - r).

    Steps that shrink by a larger ratio than `LARGEST_RATIO` promise nothing.
    """
    ratio = moved / np.maximum(before, 1e-300)
    shrinking = ratio < LARGEST_RATIO
    left: FloatArray = np.where(shrinking, moved * ratio / np.where(shrinking, 1.0 - ratio, 1.0), np.inf)
    return left


def _largest_left(problem: Problem, pose: _Pose) -> FloatArray:
    """Return the largest error of any row of each layer, its weight taken off, shape (N, L)."""
    left = np.zeros((len(pose.frames), len(problem.layers)))
    for level, layer in enumerate(problem.layers):
        for each in layer:
            found = _evaluated([replace(each, weight=1.0)], pose).left
            left[:, level] = np.maximum(left[:, level], np.abs(found).max(axis=1, initial=0.0))
    return left


def _are_met(problem: Problem, pose: _Pose) -> BoolArray:
    """Return which frames meet every layer, shape (N,)."""
    errors = [_evaluated(layer, pose).left for layer in problem.layers]
    met: BoolArray = np.all([np.linalg.norm(e, axis=1) < STOP_ERROR for e in errors], axis=0)
    return met


def _apply(state: Motion, columns: Columns, pose: _Pose, step: FloatArray, root: int) -> None:
    """Turn the column joints by world-axis increments, q <- exp(R_parent^-1 w) q, and shift the root."""
    skeleton, joints, frames = columns.skeleton, columns.joints, pose.frames
    turns = step[:, :-3].reshape(len(frames), -1, 3).copy()
    parents = skeleton.parents[joints]
    inner = parents >= 0
    turns[:, inner] = rot.unrotate(pose.world.rotations[:, parents[inner]], turns[:, inner])
    q = rot.multiply(rot.exp(turns), state.rotations[frames[:, None], joints])
    state.rotations[frames[:, None], joints] = rot.normalize(q)
    if len(skeleton.translated):
        shift, above = step[:, -3:], int(skeleton.parents[columns.root])
        if above >= 0:
            shift = rot.unrotate(pose.world.rotations[:, above], shift)
        state.translations[frames, root] += shift


def _step(block: _Block, pose: _Pose, hinges: Hinges, iteration: int) -> tuple[FloatArray, Descent]:
    """Return the step, shape (N, n), and the descent behind it; hinges that leave their limits are set on them."""
    problem = block.problem
    evaluated, softness = [_evaluated(layer, pose) for layer in problem.layers], problem.softness[pose.frames]
    lengths = np.stack([np.linalg.norm(each.left, axis=1) for each in evaluated], axis=1)
    here = pose.frames - block.first
    anneal = block.annealing.factors(here, lengths, softness, iteration)[:, None]
    gain = problem.attraction * GAIN_DECAY ** max(0, iteration + 1 - FULL_GAIN_ITERATIONS) * anneal
    rows = Rows(
        [replace(each, J=block.mobility * _shifts(problem, pose, hinges.on_axes(each.J))) for each in evaluated]
    )
    z = attraction(problem.columns, block.reference, pose.world, pose.motion, pose.frames)
    z = _shifts(problem, pose, hinges.on_axes(z[:, None]))[:, 0] / block.mobility
    met = LARGEST_ERROR * np.where(np.arange(len(evaluated)) == 0, 1.0, anneal)
    way = _Way(np.where(softness > 0.0, LARGEST_SOFT_ERROR, met), softness, iteration >= HASTY_ITERATIONS)
    everything = np.ones(z.shape, dtype=np.bool_)
    whole = np.arange(len(z))
    none = np.zeros((len(z), 0, z.shape[1]))
    descent = way.down(whole, rows.taking_part(whole), z, fixed=np.zeros_like(z), free=everything, limits=none)
    cones = Cones(problem, pose.motion.rotations, pose.world) if block.limited else None
    hinges.keep_limits(rows, cones, z, descent, way.down, gain)
    step = descent.tasks + gain * descent.home
    home = accelerated(block.memory, here, descent)
    fast = descent.tasks + gain * home
    outside = hinges.out_of_limits(fast, descent.free).any(axis=1)
    active = rows.active if cones is None else np.concatenate((rows.active, cones.active), axis=1)
    outside |= rows.lacks(fast).any(axis=1) | ~block.sides.unchanged(here, active)
    if cones is not None:
        outside |= (cones.beyond(fast) > 0.0).any(axis=1)
    return np.where(outside[:, None], step, fast), descent


@dataclass(frozen=True, eq=False)
class _Way:
    """How frames of a block go down the layers: b_max (N,) and softness (N,) of each, and whether steps are steady."""

    largest_errors: FloatArray
    softness: FloatArray
    steady: bool

    def down(
        self,
        rows: IntArray,
        evaluated: Sequence[tuple[FloatArray, FloatArray]],
        z: FloatArray,
        *,
        fixed: FloatArray,
        free: BoolArray,
        limits: FloatArray,
    ) -> Descent:
        """Return a pass down the layers of some rows of the block."""
        return descend(
            evaluated,
            z,
            fixed=fixed,
            free=free,
            largest_errors=list(self.largest_errors[rows].T),
            steady=self.steady,
            softness=self.softness[rows],
            limits=limits,
        )


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


def _evaluated(layer: Sequence[WeightedTask], pose: _Pose) -> Evaluated:
    """Return a layer's weighted errors and rows."""
    local = pose.motion.rotations
    parts = [(each.weight, *each.task.evaluate(pose.world, local, pose.frames)) for each in layer]
    e = np.concatenate([weight * error for weight, error, _ in parts], axis=1)
    J = np.concatenate([weight * rows for weight, _, rows in parts], axis=1)
    one_sided = np.repeat([each.one_sided for each in layer], [error.shape[1] for _, error, _ in parts])
    return Evaluated(e, J, one_sided)
