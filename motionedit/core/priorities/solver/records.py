"""The records of the compiled solver: joints, tasks, hinges and limits of a problem as csrc has them.

Its `records`, by their names, say how each structure lies in memory, so that it is filled field by field and no order
is kept here.
"""

from __future__ import annotations

from functools import cache, lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core import units
from motionedit.core.arrays import frozen
from motionedit.core.compiled import compiled
from motionedit.core.priorities.solver import constants
from motionedit.core.priorities.solver.points import places_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.measure import Measure
    from motionedit.core.priorities.solver.points import Columns, Point, Recruited
    from motionedit.core.priorities.solver.problem import CompiledTask, HingeColumns, LimitColumns, Problem

_NOWHERE = (0.0, 0.0, 0.0)
_CONSTANTS = {"METRES_PER_RADIAN": units.METRES_PER_RADIAN, **vars(constants)}


@dataclass(frozen=True)
class Row:
    """What of a task is the same for all clips that share a skeleton: its record, by plain values.

    `joint` and `base` are -1 where there is none; `recruited` is a flag for each column.
    """

    kind: int
    layer: int
    one_sided: bool
    weight: float
    counted: tuple[int, ...]
    measure: tuple[tuple[float, ...], ...]
    width: int
    root: bool
    joint: int
    offset: tuple[float, ...]
    base_root: bool
    base: int
    base_offset: tuple[float, ...]
    axis: tuple[float, ...]
    recruited: bytes


# How a body's mass is spread: `Masses`' shares and points, as bytes.
Weights = tuple[bytes, bytes]


# All that a row is made of: its kind, layer, whether it is one-sided, weight, measure, width, recruited unknowns, point
# and base, and axis as bytes.
_Told = tuple[str, int, bool, float, "Measure", int, "Recruited", "Point | None", "Point | None", "bytes | None"]


def tasks_of(problem: Problem, kinds: Sequence[str]) -> tuple[tuple[_Told, ...], list[CompiledTask]] | None:
    """Return what rows are made of, and the tasks that they are of, layer by layer.

    None where one is of no kind that the compiled solver has.
    """
    told: list[_Told] = []
    tasks: list[CompiledTask] = []
    for layer, members in enumerate(problem.layers):
        for each in members:
            for task in each.task.compiled() or (None,):
                if task is None or task.row_kind not in kinds:
                    return None
                weight, width = each.weight * task.sign, task.targets.shape[1]
                axis = None if task.axis is None else np.asarray(task.axis, dtype=np.float64).tobytes()
                about = task.measure, width, task.recruited, task.point, task.base, axis
                told.append((task.row_kind, layer, each.one_sided, weight, *about))
                tasks.append(task)
    return tuple(told), tasks


def _row(told: _Told) -> Row:
    kind, layer, one_sided, weight, measure, width, recruited, point, base, axis = told
    return Row(
        kind=compiled().row_kinds.index(kind),
        layer=layer,
        one_sided=one_sided,
        weight=weight,
        counted=measure.counted,
        measure=tuple(map(tuple, measure.rows.tolist())),
        width=width,
        root=recruited.root if point is None else point.moves_with_root,
        joint=-1 if point is None else point.effector.joint,
        offset=_NOWHERE if point is None else tuple(point.effector.offset.tolist()),
        base_root=base is not None and base.moves_with_root,
        base=-1 if base is None else base.effector.joint,
        base_offset=_NOWHERE if base is None else tuple(base.effector.offset.tolist()),
        axis=_NOWHERE if axis is None else tuple(np.frombuffer(axis).tolist()),
        recruited=recruited.joints.tobytes(),
    )


class Structure(NamedTuple):
    """The records of nodes, the columns' nodes, the records of tasks, and what these recruit.

    `root` is the root's node, -1 where it has no translation; `rows` is how many all tasks have.
    """

    nodes: NDArray[Any]
    column_nodes: IntArray
    tasks: NDArray[Any]
    recruited: NDArray[np.uint8]
    root: int
    rows: int


@lru_cache(maxsize=32)
def structure_of(
    columns: Columns, told: tuple[_Told, ...], weights: Weights | None, *, counts: tuple[int, ...]
) -> Structure:
    """Return what of a layout is the same for all clips that share a skeleton; `counts` are the numbers of targets."""
    rows = [_row(each) for each in told]
    shares = np.zeros(len(columns.skeleton)) if weights is None else np.frombuffer(weights[0])
    nodes = _nodes(columns, rows, shares)
    node_of = places_of(nodes, len(columns.skeleton))
    recruited = np.frombuffer(b"".join(row.recruited for row in rows), dtype=np.uint8)
    column_nodes = np.ascontiguousarray(node_of[columns.joints], dtype=np.int64)
    records, tasks = _node_records(columns, nodes, node_of, weights), _tasks(rows, node_of)
    tasks["targets"] = [0, *accumulate(counts)][:-1]
    root = int(node_of[columns.root]) if len(columns.skeleton.translated) else -1
    count = sum(len(row.counted) for row in rows)
    return Structure(frozen(records), frozen(column_nodes), frozen(tasks), recruited, root, count)


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


def settings_of(problem: Problem, structure: Structure, *, targets: int) -> NDArray[Any]:
    """Return how many there are of what, and how frames are solved; `targets` is the length of all targets."""
    columns, skeleton = problem.columns, problem.columns.skeleton
    return _settings(
        nodes=len(structure.nodes),
        columns=len(columns.joints),
        tasks=len(structure.tasks),
        hinges=len(problem.hinges.places),
        limits=len(problem.limits.places),
        layers=len(problem.layers),
        joints=len(skeleton),
        translated=len(skeleton.translated),
        rows=structure.rows,
        targets=targets,
        root=structure.root,
        moves_root=problem.moves_root,
        max_iterations=problem.max_iterations,
        ends_early=problem.ends_early,
        attraction=problem.attraction,
    )


@lru_cache(maxsize=32)
def _settings(**values: float) -> NDArray[Any]:
    return frozen(_records("settings", 1, values))


@cache
def constants_record() -> NDArray[Any]:
    """Return the solver's constants: csrc names those that it wants."""
    wanted = compiled().records["constants"]["names"]
    return _records("constants", 1, {name: _CONSTANTS[name.upper()] for name in wanted})


def _node_records(columns: Columns, nodes: IntArray, node_of: IntArray, weights: Weights | None) -> NDArray[Any]:
    skeleton = columns.skeleton
    parents = skeleton.parents[nodes]
    values = {
        "joint": nodes,
        "parent": np.where(parents >= 0, node_of[parents], -1),
        "translation": skeleton.translation_places[nodes],
        "column": columns.places[nodes],
        "offset": skeleton.offsets[nodes],
    }
    if weights is not None:
        shares, points = (np.frombuffer(each) for each in weights)
        values |= {"share": shares[nodes], "center": points.reshape(-1, 3)[nodes]}
    return _records("nodes", len(nodes), values)


@lru_cache(maxsize=4)
def hinge_records(hinges: HingeColumns) -> NDArray[Any]:
    """Return the records of hinges."""
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
def limit_records(limits: LimitColumns) -> NDArray[Any]:
    """Return the records of limits."""
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


def _tasks(rows: Sequence[Row], node_of: IntArray) -> NDArray[Any]:
    """Return the records of all tasks."""
    # Field by field: record by record takes several times as long.
    values: dict[str, Any] = {
        **{
            name: [getattr(row, name) for row in rows]
            for name in ("kind", "layer", "one_sided", "weight", "root", "base_root", "offset", "base_offset", "axis")
        },
        "rows": [len(row.counted) for row in rows],
        "node": [-1 if row.joint < 0 else node_of[row.joint] for row in rows],
        "base": [-1 if row.base < 0 else node_of[row.base] for row in rows],
        "width": [row.width for row in rows],
    }
    records = _records("tasks", len(rows), values)
    axes, measures = records["axes"], records["measure"]
    for place, row in enumerate(rows):
        axes[place, : len(row.counted)], measures[place, : len(row.counted)] = row.counted, row.measure
    return records


def _nodes(columns: Columns, rows: Sequence[Row], shares: FloatArray) -> IntArray:
    """Return the joints that matter, growing: columns, effectors, bases, what carries mass, and all above them."""
    skeleton = columns.skeleton
    needed = shares > 0.0
    needed[columns.joints] = True
    needed[[joint for row in rows for joint in (row.joint, row.base) if joint >= 0]] = True
    if len(skeleton.translated):
        needed[columns.root] = True
    for joint in range(len(skeleton) - 1, 0, -1):
        if needed[joint]:
            needed[skeleton.parents[joint]] = True
    return np.flatnonzero(needed)
