"""The layered solver in numpy: the readable reference, and what runs where nothing could be compiled.

All frames iterate together; those that have converged leave.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.solver.annealing import Annealing
from motionedit.core.priorities.solver.cones import are_beyond
from motionedit.core.priorities.solver.constants import (
    LARGEST_RATIO,
    LARGEST_TURN,
    MET_WITHOUT_LIMITS,
    STOP_ERROR,
    STOP_LEFT,
    STOP_STEP,
)
from motionedit.core.priorities.solver.hinged import Hinges
from motionedit.core.priorities.solver.homing import Memory
from motionedit.core.priorities.solver.numpy_step import Block, Pose, evaluated_layer, step_of
from motionedit.core.priorities.solver.one_sided import Sides
from motionedit.core.priorities.solver.problem import LayeredSolution, Reference
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.solver.points import Columns
    from motionedit.core.priorities.solver.problem import Problem

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
    root = columns.skeleton.translation_places[columns.root]
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


def _iterate(
    problem: Problem, solution: LayeredSolution, reference: Reference, frames: IntArray, *, limited: bool
) -> None:
    columns, state = problem.columns, solution.motion
    root = columns.skeleton.translation_places[columns.root]
    if not len(frames):
        return
    first, count = int(frames[0]), int(frames[-1] - frames[0]) + 1
    annealing = Annealing(
        count, len(problem.layers), problem.max_iterations, ends_early=problem.ends_early and not limited
    )
    block = Block(problem, reference, Memory.empty(count, columns.size), Sides(count), annealing, first, limited)
    memory, moved_before = block.memory, np.zeros(count)
    for iteration in range(problem.max_iterations):
        here = frames - block.first
        pose = Pose.of(state, frames)
        hinges = Hinges(problem, pose.motion.rotations, pose.world)
        step, descent = step_of(block, pose, hinges, iteration)
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
            now = Pose.of(state, frames[nearly])
            met = _are_met(problem, now)
            solution.left[frames[nearly]] = _largest_left(problem, now)
            done[nearly[met]] = True
        moved_before[here] = moved
        solution.converged[frames[done]] = True
        over = ~done & annealing.are_over(here, problem.softness[frames], iteration)
        if over.any():
            solution.left[frames[over]] = _largest_left(problem, Pose.of(state, frames[over]))
        frames = frames[~(done | over)]
        if not len(frames):
            return
    solution.left[frames] = _largest_left(problem, Pose.of(state, frames))


def _left(moved: FloatArray, before: FloatArray) -> FloatArray:
    """Return what the steps to come add up to, from the lengths of the last two, shape (N,): moved r / (1 - r).

    Steps that shrink by a larger ratio than `LARGEST_RATIO` promise nothing.
    """
    ratio = moved / np.maximum(before, 1e-300)
    shrinking = ratio < LARGEST_RATIO
    left: FloatArray = np.where(shrinking, moved * ratio / np.where(shrinking, 1.0 - ratio, 1.0), np.inf)
    return left


def _largest_left(problem: Problem, pose: Pose) -> FloatArray:
    """Return the largest error of any row of each layer, its weight taken off, shape (N, L)."""
    left = np.zeros((len(pose.frames), len(problem.layers)))
    for level, layer in enumerate(problem.layers):
        for each in layer:
            found = evaluated_layer([replace(each, weight=1.0)], pose).left
            left[:, level] = np.maximum(left[:, level], np.abs(found).max(axis=1, initial=0.0))
    return left


def _are_met(problem: Problem, pose: Pose) -> BoolArray:
    """Return which frames meet every layer, shape (N,)."""
    errors = [evaluated_layer(layer, pose).left for layer in problem.layers]
    met: BoolArray = np.all([np.linalg.norm(e, axis=1) < STOP_ERROR for e in errors], axis=0)
    return met


def _apply(state: Motion, columns: Columns, pose: Pose, step: FloatArray, root: int) -> None:
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
