"""The way into the compiled layered solver: a problem laid out as its buffers, frames shared out among threads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.priorities.solver.records import (
    constants_record,
    hinge_records,
    limit_records,
    settings_of,
    structure_of,
    tasks_of,
)
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.priorities.solver.problem import CompiledTask, LayeredSolution, Problem, Reference

# Frames a thread takes at least.
_LEAST_SHARE = 32
_NOTHING = np.zeros(0)


@dataclass(frozen=True, eq=False)
class Layout:
    """What of a problem does not change from solve to solve: buffers of solve_module.c by their names."""

    buffers: dict[str, NDArray[Any]]

    def with_targets_of(self, problem: Problem) -> Layout:
        """Return the layout with the targets of a problem that has the same tasks."""
        rows = [row for tasks in problem.layers for each in tasks for row in each.task.compiled() or ()]
        return Layout({**self.buffers, "targets": _all_targets(rows)})


def layout_of(problem: Problem) -> Layout | None:
    """Return the layout of a problem; None where there is no compiled solver, or what it does not know.

    That is a task of another kind, and a root that moves along one or two axes alone.
    """
    module, knows_root = compiled(), problem.columns.root_is_free or not problem.moves_root
    found = tasks_of(problem, module.row_kinds) if module is not None and knows_root else None
    if found is None:
        return None
    told, tasks = found
    weights, counts = None, tuple([task.targets.size for task in tasks])
    for task in tasks:
        weights = weights if task.masses is None else task.masses.as_bytes
    structure = structure_of(problem.columns, told, weights, counts=counts)
    targets = _all_targets(tasks)
    return Layout(
        {
            "settings": settings_of(problem, structure, targets=len(targets)),
            "constants": constants_record(),
            "nodes": structure.nodes,
            "column_nodes": structure.column_nodes,
            "mobility": np.ascontiguousarray(problem.mobility),
            "tasks": structure.tasks,
            "hinges": hinge_records(problem.hinges),
            "limits": limit_records(problem.limits),
            "recruited": structure.recruited,
            "targets": targets,
        }
    )


def _all_targets(tasks: Sequence[CompiledTask]) -> FloatArray:
    """Return the targets of all tasks, one after the other."""
    return np.concatenate([task.targets for task in tasks], axis=None, dtype=np.float64) if tasks else np.zeros(0)


def solve(
    layout: Layout,
    solution: LayeredSolution,
    reference: Reference,
    frames: IntArray,
    *,
    softness: FloatArray,
    levels: IntArray,
    in_order: bool,
    threads: int,
) -> None:
    """Solve those `frames` of a motion that are not converged from where they are, as `solve_layers`."""
    count, motion = len(frames), solution.motion
    buffers = {
        **layout.buffers,
        "frames": frames,
        "reference_rotations": np.ascontiguousarray(reference.rotations),
        "reference_root": _NOTHING if reference.root is None else reference.root,
        "softness": softness,
        "levels": levels,
        "rotations": motion.rotations,
        "translations": motion.translations,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "ranks": solution.ranks,
        "left": solution.left,
    }
    shares = 1 if in_order or threads == 1 else max(1, min(threads, count // _LEAST_SHARE))
    if shares == 1:
        compiled().solve(buffers, 0, count, in_order)
        return
    bounds = [count * i // shares for i in range(shares + 1)]

    def run(share: int) -> None:
        compiled().solve(buffers, bounds[share], bounds[share + 1], in_order)

    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(shares) as pool:
        list(pool.map(run, range(shares)))
