"""One step of the layered solver in numpy: frames that are solved together go down the layers, within their limits."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.priorities.solver.cones import Cones
from motionedit.core.priorities.solver.constants import (
    FULL_GAIN_ITERATIONS,
    GAIN_DECAY,
    HASTY_ITERATIONS,
    LARGEST_ERROR,
    LARGEST_SOFT_ERROR,
)
from motionedit.core.priorities.solver.homing import Memory, accelerated, attraction
from motionedit.core.priorities.solver.layers import Descent, descend
from motionedit.core.priorities.solver.one_sided import Evaluated, Rows, Sides
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.solver.annealing import Annealing
    from motionedit.core.priorities.solver.hinged import Hinges
    from motionedit.core.priorities.solver.problem import Problem, Reference, WeightedTask


@dataclass(frozen=True, eq=False)
class Block:
    """Frames from `first` on that iterate together, with what they remember."""

    problem: Problem
    reference: Reference
    memory: Memory
    sides: Sides
    annealing: Annealing
    first: int
    limited: bool

    @cached_property
    def mobility(self) -> FloatArray:
        """Of every unknown, shape (n,)."""
        return np.repeat(self.problem.mobility, 3)


@dataclass(frozen=True, eq=False)
class Pose:
    """Where N `frames` of a block are."""

    frames: IntArray
    motion: Motion
    world: WorldPoses

    @classmethod
    def of(cls, state: Motion, frames: IntArray) -> Pose:
        """Return where a motion has some of its frames."""
        motion = state.at(frames)
        return cls(frames, motion, forward(motion))

    def at(self, these: BoolArray) -> Pose:
        """Return some of the frames."""
        return Pose(self.frames[these], self.motion.at(these), self.world.at(these))


def step_of(block: Block, pose: Pose, hinges: Hinges, iteration: int) -> tuple[FloatArray, Descent]:
    """Return the step, shape (N, n), and the descent behind it; hinges that leave their limits are set on them."""
    problem = block.problem
    evaluated, softness = [evaluated_layer(layer, pose) for layer in problem.layers], problem.softness[pose.frames]
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


def evaluated_layer(layer: Sequence[WeightedTask], pose: Pose) -> Evaluated:
    """Return a layer's weighted errors and rows."""
    local = pose.motion.rotations
    parts = [(each.weight, *each.task.evaluate(pose.world, local, pose.frames)) for each in layer]
    e = np.concatenate([weight * error for weight, error, _ in parts], axis=1)
    J = np.concatenate([weight * rows for weight, _, rows in parts], axis=1)
    one_sided = np.repeat([each.one_sided for each in layer], [error.shape[1] for _, error, _ in parts])
    return Evaluated(e, J, one_sided)


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


def _shifts(problem: Problem, pose: Pose, J: FloatArray) -> FloatArray:
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
