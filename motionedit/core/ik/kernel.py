"""The way into the compiled layered solver: a problem laid out as plain arrays, and frames shared out among threads."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.ik.tasks import (
    AimTask,
    CenterOfMassTask,
    OrientationTask,
    Point,
    PoseTask,
    PositionTask,
    PostureTask,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.center_of_mass import Masses
    from motionedit.core.ik.layered_solver import LayeredSolution, Problem
    from motionedit.core.ik.tasks import Recruited, Task

# Set to ``numpy``, it keeps the compiled solver out, as where none could be built.
CHOICE = "MOTIONEDIT_SOLVER"
# Frames a thread takes at least.
_LEAST_SHARE = 32

_POSITION, _ORIENTATION, _CENTER_OF_MASS, _AIM, _POSTURE = range(5)


@cache
def _compiled() -> Any:  # noqa: ANN401  a module without types
    try:
        from motionedit.core.ik import _layered
    except ImportError:
        return None
    return _layered


def is_used() -> bool:
    """Return whether the compiled solver is there and wanted."""
    return os.environ.get(CHOICE) != "numpy" and _compiled() is not None


def name() -> str:
    """Return which solver runs: ``compiled`` or ``numpy``."""
    return "compiled" if is_used() else "numpy"


def solve(problem: Problem, solution: LayeredSolution, *, in_order: bool, threads: int) -> None:
    """Solve every frame of `solution` from where it is, in place; see `layered_solver.solve_layers`."""
    count = len(solution.iterations)
    arrays = _arrays(problem, solution, in_order=in_order)
    shares = 1 if in_order else max(1, min(threads, count // _LEAST_SHARE))
    bounds = [count * i // shares for i in range(shares + 1)]

    def run(share: int) -> None:
        _compiled().solve(*arrays, problem.attraction, bounds[share], bounds[share + 1])

    if shares == 1:
        run(0)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(shares) as pool:
        list(pool.map(run, range(shares)))


@dataclass(frozen=True, eq=False)
class _Row:
    """A task as the kernel has it: see `Task` in layered.h."""

    kind: int
    layer: int
    weight: float
    recruited: BoolArray
    joint: int = -1
    base: int = -1
    root: bool = False
    base_root: bool = False
    axes: tuple[int, ...] = (0, 1, 2)
    offset: FloatArray | None = None
    measure: FloatArray | None = None
    axis: FloatArray | None = None
    targets: FloatArray | None = None


def _rows_of(task: Task, layer: int, weight: float) -> Iterator[_Row]:
    if isinstance(task, PoseTask):
        yield from _rows_of(task.position, layer, weight)
        yield from _rows_of(task.orientation, layer, weight)
    elif isinstance(task, PositionTask):
        yield _Row(
            **_point(_POSITION, task.point, task.base, layer, weight),
            axes=task.axes,
            measure=task.measure[list(task.axes)],
            targets=task.targets,
        )
    elif isinstance(task, OrientationTask):
        yield _Row(**_point(_ORIENTATION, task.point, task.base, layer, weight), targets=task.targets)
    elif isinstance(task, AimTask):
        yield _Row(**_point(_AIM, task.point, task.base, layer, weight), axis=task.axis, targets=task.targets)
    elif isinstance(task, CenterOfMassTask):
        yield _Row(
            _CENTER_OF_MASS,
            layer,
            weight,
            task.recruited.joints,
            root=task.recruited.root,
            axes=task.axes,
            measure=task.measure[list(task.axes)],
            targets=task.targets,
        )
    elif isinstance(task, PostureTask):
        for i, place in enumerate(task.places):
            own = np.arange(len(task.columns.joints)) == place
            joint = int(task.columns.joints[place])
            yield _Row(_POSTURE, layer, weight, own, joint=joint, targets=task.targets[:, i])
    else:
        raise TypeError(f"the compiled solver does not know {type(task).__name__}")


def _point(kind: int, point: Point, base: Point | None, layer: int, weight: float) -> dict[str, Any]:
    return {
        "kind": kind,
        "layer": layer,
        "weight": weight,
        "recruited": point.recruited.joints,
        "joint": point.effector.joint,
        "base": -1 if base is None else base.effector.joint,
        "root": point.moves_with_root,
        "base_root": base is not None and base.moves_with_root,
        "offset": point.effector.offset,
    }


def _arrays(problem: Problem, solution: LayeredSolution, *, in_order: bool) -> tuple[FloatArray | IntArray, ...]:
    """Return the buffers of module.c, in its order."""
    columns, skeleton, motion = problem.columns, problem.columns.skeleton, solution.motion
    rows = [
        row
        for layer, tasks in enumerate(problem.layers)
        for each in tasks
        for row in _rows_of(each.task, layer, each.weight)
    ]
    masses = _masses(problem)
    nodes = _nodes(problem, rows, masses)
    node_of = np.full(len(skeleton), -1)
    node_of[nodes] = np.arange(len(nodes))
    column_of = np.full(len(skeleton), -1)
    column_of[columns.joints] = np.arange(len(columns.joints))
    place_of = np.full(len(skeleton), -1)
    place_of[skeleton.translated] = np.arange(len(skeleton.translated))
    parents = skeleton.parents[nodes]
    node_integers = np.stack(
        (nodes, np.where(parents >= 0, node_of[parents], -1), place_of[nodes], column_of[nodes]), axis=1
    )
    shares = np.zeros((len(nodes), 1)) if masses is None else masses.shares[nodes, None]
    centers = np.zeros((len(nodes), 3)) if masses is None else masses.points[nodes]
    travels = len(skeleton.translated) > 0
    hinges = problem.hinges
    sizes = (
        *(len(motion), len(nodes), len(columns.joints), len(rows), len(hinges.places), len(problem.layers)),
        *(len(skeleton), len(skeleton.translated), int(node_of[columns.root]) if travels else -1),
        *(in_order, problem.moves_root, problem.reference_root is not None, problem.max_iterations),
    )
    return (
        _integers(sizes),
        _integers(node_integers),
        _numbers(np.concatenate((skeleton.offsets[nodes], shares, centers), axis=1)),
        _integers(node_of[columns.joints]),
        _integers([_task_integers(row, node_of) for row in rows]),
        _numbers([_task_numbers(row) for row in rows]),
        _numbers(np.concatenate([np.ravel(row.targets) for row in rows if row.targets is not None] or [[]])),
        np.ascontiguousarray([row.recruited for row in rows], dtype=np.uint8),
        _integers(hinges.places),
        _numbers(np.concatenate((hinges.axes, hinges.limits), axis=1)),
        _numbers(problem.reference_rotations),
        _numbers([] if problem.reference_root is None else problem.reference_root),
        *(motion.rotations, motion.translations, solution.iterations, solution.converged, solution.ranks),
    )


def _integers(values: Any) -> IntArray:  # noqa: ANN401  whatever numpy takes
    return np.ascontiguousarray(values, dtype=np.int64)


def _numbers(values: Any) -> FloatArray:  # noqa: ANN401  whatever numpy takes
    return np.ascontiguousarray(values, dtype=np.float64)


def _masses(problem: Problem) -> Masses | None:
    tasks = (each.task for layer in problem.layers for each in layer)
    return next((task.masses for task in tasks if isinstance(task, CenterOfMassTask)), None)


def _nodes(problem: Problem, rows: list[_Row], masses: Masses | None) -> IntArray:
    """Return the joints that matter, growing: columns, effectors, bases, what carries mass, and all above them."""
    skeleton = problem.columns.skeleton
    needed = np.zeros(len(skeleton), dtype=np.bool_)
    needed[problem.columns.joints] = True
    needed[[joint for row in rows for joint in (row.joint, row.base) if joint >= 0]] = True
    if len(skeleton.translated):
        needed[problem.columns.root] = True
    if masses is not None:
        needed[masses.shares > 0.0] = True
    for joint in range(len(skeleton) - 1, 0, -1):
        if needed[joint]:
            needed[skeleton.parents[joint]] = True
    return np.flatnonzero(needed)


def _task_integers(row: _Row, node_of: IntArray) -> list[int]:
    axes = [*row.axes, 0, 0, 0][:3]
    width = 0 if row.targets is None else row.targets.shape[-1]
    node = -1 if row.joint < 0 else int(node_of[row.joint])
    base = -1 if row.base < 0 else int(node_of[row.base])
    return [row.kind, row.layer, len(row.axes), node, base, row.root, row.base_root, *axes, width, 0]


def _task_numbers(row: _Row) -> FloatArray:
    numbers = np.zeros(16)
    numbers[0] = row.weight
    if row.offset is not None:
        numbers[1:4] = row.offset
    if row.measure is not None:
        numbers[4 : 4 + row.measure.size] = row.measure.ravel()
    if row.axis is not None:
        numbers[13:16] = row.axis
    return numbers
