"""The way into the compiled layered solver: a problem laid out as plain arrays, frames shared out among threads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.priorities.tasks import (
    AimTask,
    CenterOfMassTask,
    OrientationTask,
    Point,
    PoseTask,
    PositionTask,
    PostureTask,
)
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.priorities.solver import LayeredSolution, Problem, Reference
    from motionedit.core.priorities.tasks import Task

# Frames a thread takes at least.
_LEAST_SHARE = 32

_POSITION, _ORIENTATION, _CENTER_OF_MASS, _AIM, _POSTURE = range(5)


@dataclass(frozen=True, eq=False)
class Layout:
    """What of a problem does not change from solve to solve, as buffers of module.c, in its order."""

    sizes: tuple[int, ...]
    nodes: tuple[NDArray[Any], ...]
    tasks: tuple[NDArray[Any], ...]
    hinges: tuple[NDArray[Any], ...]
    targets: FloatArray

    @classmethod
    def of(cls, problem: Problem) -> Layout:
        """Return the layout of a problem."""
        return _layout(problem)


def solve(
    problem: Problem,
    solution: LayeredSolution,
    reference: Reference,
    frames: IntArray,
    *,
    in_order: bool,
    threads: int,
) -> None:
    """Solve those `frames` of a motion that are not converged from where they are, as `solve_layers`."""
    count, motion = len(frames), solution.motion
    layout = problem.layout or Layout.of(problem)
    pulls_root = reference.root is not None
    arrays = (
        _integers(
            (
                *(count, *layout.sizes, in_order, problem.moves_root, pulls_root),
                *(problem.max_iterations, len(motion)),
            )
        ),
        *layout.nodes,
        *layout.tasks,
        layout.targets,
        *layout.hinges,
        _integers(frames),
        _numbers(reference.rotations),
        _numbers([] if reference.root is None else reference.root),
        *(motion.rotations, motion.translations, solution.iterations, solution.converged, solution.ranks),
    )
    shares = 1 if in_order else max(1, min(threads, count // _LEAST_SHARE))
    bounds = [count * i // shares for i in range(shares + 1)]

    def run(share: int) -> None:
        compiled().solve(*arrays, problem.attraction, bounds[share], bounds[share + 1])

    if shares == 1:
        run(0)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(shares) as pool:
        list(pool.map(run, range(shares)))


def _targets(problem: Problem) -> FloatArray:
    """Return the targets of all tasks in the order of their rows, one after the other."""
    parts = [part for tasks in problem.layers for each in tasks for part in _targets_of(each.task)]
    return np.concatenate([np.zeros(0), *(np.ravel(part) for part in parts if part is not None)])


def _targets_of(task: Task) -> Iterator[FloatArray | None]:
    if isinstance(task, PoseTask):
        yield from (task.position.targets, task.orientation.targets)
    elif isinstance(task, PostureTask):
        yield from np.moveaxis(task.targets, 1, 0)
    elif isinstance(task, PositionTask | OrientationTask | AimTask | CenterOfMassTask):
        yield task.targets
    else:
        raise TypeError(f"the compiled solver does not know {type(task).__name__}")


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
    width: int = 3


def _rows_of(task: Task, layer: int, weight: float) -> Iterator[_Row]:
    if isinstance(task, PoseTask):
        yield from _rows_of(task.position, layer, weight)
        yield from _rows_of(task.orientation, layer, weight)
    elif isinstance(task, PositionTask):
        yield _Row(
            **_point(_POSITION, task.point, task.base, layer, weight),
            axes=task.axes,
            measure=task.measure[list(task.axes)],
        )
    elif isinstance(task, OrientationTask):
        yield _Row(**_point(_ORIENTATION, task.point, task.base, layer, weight), width=4)
    elif isinstance(task, AimTask):
        width = 0 if task.targets is None else 3
        yield _Row(**_point(_AIM, task.point, task.base, layer, weight), axis=task.axis, width=width)
    elif isinstance(task, CenterOfMassTask):
        yield _Row(
            _CENTER_OF_MASS,
            layer,
            weight,
            task.recruited.joints,
            root=task.recruited.root,
            axes=task.axes,
            measure=task.measure[list(task.axes)],
        )
    elif isinstance(task, PostureTask):
        for place in task.places:
            own = np.arange(len(task.columns.joints)) == place
            joint = int(task.columns.joints[place])
            yield _Row(_POSTURE, layer, weight, own, joint=joint, width=4)


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


def _layout(problem: Problem) -> Layout:
    columns, skeleton, hinges = problem.columns, problem.columns.skeleton, problem.hinges
    rows = [
        row
        for layer, tasks in enumerate(problem.layers)
        for each in tasks
        for row in _rows_of(each.task, layer, each.weight)
    ]
    masses = _masses(problem)
    nodes = _nodes(problem, rows, masses)
    node_of = _places(nodes, len(skeleton))
    column_of = _places(columns.joints, len(skeleton))
    translation_of = _places(skeleton.translated, len(skeleton))
    parents = skeleton.parents[nodes]
    above = np.where(parents >= 0, node_of[parents], -1)
    shares = np.zeros(len(nodes)) if masses is None else masses.shares[nodes]
    centers = np.zeros((len(nodes), 3)) if masses is None else masses.points[nodes]
    root = int(node_of[columns.root]) if len(skeleton.translated) else -1
    return Layout(
        sizes=(
            *(len(nodes), len(columns.joints), len(rows), len(hinges.places), len(problem.layers)),
            *(len(skeleton), len(skeleton.translated), root),
        ),
        nodes=(
            _integers(np.stack((nodes, above, translation_of[nodes], column_of[nodes]), axis=1)),
            _numbers(np.column_stack((skeleton.offsets[nodes], shares, centers))),
            _integers(node_of[columns.joints]),
        ),
        tasks=(
            _integers([_task_integers(row, node_of) for row in rows]),
            _numbers([_task_numbers(row) for row in rows]),
            np.ascontiguousarray([row.recruited for row in rows], dtype=np.uint8),
        ),
        hinges=(_integers(hinges.places), _numbers(np.concatenate((hinges.axes, hinges.limits), axis=1))),
        targets=_targets(problem),
    )


def _places(joints: IntArray, count: int) -> IntArray:
    """Return each joint's place among some of them, shape (count,); -1 where it is none of them."""
    places = np.full(count, -1)
    places[joints] = np.arange(len(joints))
    return places


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
    node = -1 if row.joint < 0 else int(node_of[row.joint])
    base = -1 if row.base < 0 else int(node_of[row.base])
    return [row.kind, row.layer, len(row.axes), node, base, row.root, row.base_root, *axes, row.width]


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
