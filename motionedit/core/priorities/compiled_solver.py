"""The way into the compiled layered solver: a problem laid out as its buffers, frames shared out among threads.

The records of csrc (`records`, by their names) say how each structure lies in memory, so that it is filled field by
field and no order is kept here.
"""

from __future__ import annotations

from functools import cache, lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core import units
from motionedit.core.compiled import compiled
from motionedit.core.priorities import constants
from motionedit.core.priorities.points import places_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.priorities.problem import (
        CompiledTask,
        HingeColumns,
        LayeredSolution,
        LimitColumns,
        Problem,
        Reference,
        WeightedTask,
    )

# Frames a thread takes at least.
_LEAST_SHARE = 32
_NOWHERE = np.zeros(3)
_CONSTANTS = {"METRES_PER_RADIAN": units.METRES_PER_RADIAN, **vars(constants)}


@dataclass(frozen=True, eq=False)
class Layout:
    """What of a problem does not change from solve to solve: buffers of module.c by their names."""

    buffers: dict[str, NDArray[Any]]

    def with_targets_of(self, problem: Problem) -> Layout:
        """Return the layout with the targets of a problem that has the same tasks."""
        rows = (row for tasks in problem.layers for each in tasks for row in each.task.compiled() or ())
        return Layout(
            {**self.buffers, "targets": np.concatenate([np.zeros(0), *(np.ravel(row.targets) for row in rows)])}
        )


# A task's rows, their layer, and the task with its weight in it.
_Row = tuple["CompiledTask", int, "WeightedTask"]


def layout_of(problem: Problem) -> Layout | None:
    """Return the layout of a problem; None where there is no compiled solver, or what it does not know.

    That is a task of another kind, and a root that moves along one or two axes alone.
    """
    module, knows_root = compiled(), problem.columns.root_is_free or not problem.moves_root
    rows = _rows(problem, module.row_kinds) if module is not None and knows_root else None
    if rows is None:
        return None
    columns, skeleton = problem.columns, problem.columns.skeleton
    masses = next((task.masses for task, _, _ in rows if task.masses is not None), None)
    nodes = _nodes(problem, rows, masses)
    node_of = places_of(nodes, len(skeleton))
    tasks, targets = _tasks(rows, node_of, module.row_kinds)
    return Layout(
        {
            "settings": _settings(problem, nodes, node_of, tasks, targets=len(targets)),
            "constants": _constants(),
            "nodes": _node_records(problem, nodes, node_of, masses),
            "column_nodes": _integers(node_of[columns.joints]),
            "mobility": _numbers(problem.mobility),
            "tasks": tasks,
            "hinges": _hinge_records(problem.hinges),
            "limits": _limit_records(problem.limits),
            "recruited": np.ascontiguousarray([task.recruited.joints for task, _, _ in rows], dtype=np.uint8),
            "targets": targets,
        }
    )


def solve(
    layout: Layout,
    solution: LayeredSolution,
    reference: Reference,
    frames: IntArray,
    *,
    softness: FloatArray,
    in_order: bool,
    threads: int,
) -> None:
    """Solve those `frames` of a motion that are not converged from where they are, as `solve_layers`."""
    count, motion = len(frames), solution.motion
    buffers = {
        **layout.buffers,
        "frames": _integers(frames),
        "reference_rotations": _numbers(reference.rotations),
        "reference_root": _numbers([] if reference.root is None else reference.root),
        "softness": _numbers(softness),
        "rotations": motion.rotations,
        "translations": motion.translations,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "ranks": solution.ranks,
        "left": solution.left,
    }
    shares = 1 if in_order else max(1, min(threads, count // _LEAST_SHARE))
    bounds = [count * i // shares for i in range(shares + 1)]

    def run(share: int) -> None:
        compiled().solve(buffers, bounds[share], bounds[share + 1], in_order)

    if shares == 1:
        run(0)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(shares) as pool:
        list(pool.map(run, range(shares)))


def _rows(problem: Problem, kinds: Sequence[str]) -> list[_Row] | None:
    """Return the rows of all tasks, layer by layer; None where one is of no kind that the compiled solver has."""
    found: list[_Row] = []
    for layer, tasks in enumerate(problem.layers):
        for each in tasks:
            rows = each.task.compiled()
            if rows is None or any(row.row_kind not in kinds for row in rows):
                return None
            found += [(row, layer, each) for row in rows]
    return found


@cache
def _dtype(structure: str) -> np.dtype[Any]:
    """Return how one of csrc's structures lies in memory."""
    dtype: np.dtype[Any] = np.dtype(compiled().records[structure])
    return dtype


def _records(structure: str, count: int, values: Mapping[str, Any]) -> NDArray[Any]:
    """Return a buffer of a structure's records with some of their fields filled in, the others 0."""
    records = np.zeros(count, dtype=_dtype(structure))
    for name, value in values.items():
        records[name] = value
    return records


def _settings(
    problem: Problem, nodes: IntArray, node_of: IntArray, tasks: NDArray[Any], *, targets: int
) -> NDArray[Any]:
    """Return how many there are of what, and how frames are solved; `targets` is the length of all targets."""
    columns, skeleton = problem.columns, problem.columns.skeleton
    values = {
        "nodes": len(nodes),
        "columns": len(columns.joints),
        "tasks": len(tasks),
        "hinges": len(problem.hinges.places),
        "limits": len(problem.limits.places),
        "layers": len(problem.layers),
        "joints": len(skeleton),
        "translated": len(skeleton.translated),
        "rows": int(tasks["rows"].sum()),
        "targets": targets,
        "root": int(node_of[columns.root]) if len(skeleton.translated) else -1,
        "moves_root": problem.moves_root,
        "max_iterations": problem.max_iterations,
        "attraction": problem.attraction,
    }
    return _records("settings", 1, values)


@cache
def _constants() -> NDArray[Any]:
    """Return the solver's constants: csrc names those that it wants."""
    wanted = compiled().records["constants"]["names"]
    return _records("constants", 1, {name: _CONSTANTS[name.upper()] for name in wanted})


def _node_records(problem: Problem, nodes: IntArray, node_of: IntArray, masses: Masses | None) -> NDArray[Any]:
    skeleton = problem.columns.skeleton
    parents = skeleton.parents[nodes]
    values = {
        "joint": nodes,
        "parent": np.where(parents >= 0, node_of[parents], -1),
        "translation": skeleton.translation_places[nodes],
        "column": problem.columns.places[nodes],
        "offset": skeleton.offsets[nodes],
    }
    if masses is not None:
        values |= {"share": masses.shares[nodes], "center": masses.points[nodes]}
    return _records("nodes", len(nodes), values)


@lru_cache(maxsize=4)
def _hinge_records(hinges: HingeColumns) -> NDArray[Any]:
    values = {
        "column": hinges.places,
        "second": hinges.second,
        "axis": hinges.axes,
        "upper": hinges.upper,
        "lower": hinges.lower,
        "limits": hinges.limits,
    }
    return _records("hinges", len(hinges.places), values)


@lru_cache(maxsize=4)
def _limit_records(limits: LimitColumns) -> NDArray[Any]:
    halves = np.stack([limits.swing, limits.twist], axis=1)
    values = {
        "column": limits.places,
        "center": limits.centers,
        "along": limits.along,
        "middle": rot.rotate(limits.centers, limits.along),
        "halves": halves,
        "least": np.cos(0.5 * np.minimum(halves.min(axis=1), np.pi)),
    }
    return _records("limits", len(limits.places), values)


def _tasks(rows: Sequence[_Row], node_of: IntArray, kinds: Sequence[str]) -> tuple[NDArray[Any], FloatArray]:
    """Return the records of all tasks, and their targets one after the other."""
    tasks = [task for task, _, _ in rows]
    points, bases = [task.point for task in tasks], [task.base for task in tasks]
    given = [np.ravel(task.targets) for task in tasks]
    # Field by field: record by record takes several times as long.
    values: dict[str, Any] = {
        "kind": [kinds.index(task.row_kind) for task in tasks],
        "layer": [layer for _, layer, _ in rows],
        "one_sided": [weighted.one_sided for _, _, weighted in rows],
        "weight": [weighted.weight * task.sign for task, _, weighted in rows],
        "rows": [len(task.measure.counted) for task in tasks],
        "root": [task.recruited.root if task.point is None else task.point.moves_with_root for task in tasks],
        "base_root": [base is not None and base.moves_with_root for base in bases],
        "node": [-1 if point is None else node_of[point.effector.joint] for point in points],
        "base": [-1 if base is None else node_of[base.effector.joint] for base in bases],
        "offset": [_NOWHERE if point is None else point.effector.offset for point in points],
        "base_offset": [_NOWHERE if base is None else base.effector.offset for base in bases],
        "axis": [_NOWHERE if task.axis is None else task.axis for task in tasks],
        "width": [task.targets.shape[1] for task in tasks],
        "targets": [0, *accumulate(len(each) for each in given)][:-1],
    }
    records = _records("tasks", len(rows), values)
    axes, measures = records["axes"], records["measure"]
    for place, task in enumerate(tasks):
        counted = task.measure.counted
        axes[place, : len(counted)], measures[place, : len(counted)] = counted, task.measure.rows
    return records, np.concatenate([np.zeros(0), *given])


def _integers(values: Any) -> IntArray:  # noqa: ANN401  whatever numpy takes
    return np.ascontiguousarray(values, dtype=np.int64)


def _numbers(values: Any) -> FloatArray:  # noqa: ANN401  whatever numpy takes
    return np.ascontiguousarray(values, dtype=np.float64)


def _nodes(problem: Problem, rows: Sequence[_Row], masses: Masses | None) -> IntArray:
    """Return the joints that matter, growing: columns, effectors, bases, what carries mass, and all above them."""
    skeleton = problem.columns.skeleton
    needed = np.zeros(len(skeleton), dtype=np.bool_)
    needed[problem.columns.joints] = True
    points = [point for task, _, _ in rows for point in (task.point, task.base) if point is not None]
    needed[[point.effector.joint for point in points]] = True
    if len(skeleton.translated):
        needed[problem.columns.root] = True
    if masses is not None:
        needed[masses.shares > 0.0] = True
    for joint in range(len(skeleton) - 1, 0, -1):
        if needed[joint]:
            needed[skeleton.parents[joint]] = True
    return np.flatnonzero(needed)
