"""What the layered solvers are given and what they return: tasks in layers over the unknowns of many frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from motionedit.core.measure import WORLD, Measure
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.points import Columns, Point, Recruited


@dataclass(frozen=True, eq=False)
class CompiledTask:
    """A task as csrc knows it: rows of one kind there, see `Task` in layered.h.

    Attributes
    ----------
    row_kind : str
        A name in the table of csrc/row_kinds.c.
    recruited : Recruited
    targets : shape (N, width)
    point, base : Point or None
        What moves, and what it is seen from.
    measure : Measure
        Along what, and which axes count.
    axis : shape (3,)
        A direction in the point's joint.
    masses : Masses or None
        Where the kind weighs the body.
    """

    row_kind: str
    recruited: Recruited
    targets: FloatArray
    point: Point | None = None
    base: Point | None = None
    measure: Measure = WORLD
    axis: FloatArray | None = None
    masses: Masses | None = None


class Task(Protocol):
    """A constraint over the frames that are solved together.

    A task of k rows over N frames gives e, shape (N, k), and J, shape (N, k, n). The n = 3 K + 3 unknowns of a frame
    are world-axis increments w of K column joints (a joint's world rotation becomes exp(w) R), then the root's
    translation. Lengths are normalised metres; radians of orientation rows count as `METRES_PER_RADIAN`.
    """

    def evaluate(self, poses: WorldPoses, local: FloatArray, frames: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return (e, J) at frames of the task, shapes (N, k) and (N, k, n).

        Parameters
        ----------
        poses : WorldPoses
            Of the N frames.
        local : shape (N, J, 4)
            Their local rotations.
        frames : shape (N,)
            Which of the task's own frames these are.
        """

    def compiled(self) -> Sequence[CompiledTask] | None:
        """Return the task's rows for the compiled solver, in the order of `evaluate`'s; None: it has none for it."""


@dataclass(frozen=True, eq=False)
class WeightedTask:
    """A task and its weight in its layer."""

    task: Task
    weight: float


@dataclass(frozen=True, eq=False)
class HingeColumns:
    """Columns that turn about one axis or two: their `places` (H,), axes (H, 3) in the joint, and limits (H, 2) in rad.

    `second` (H,) tells which is the second hinge of its column; it follows the first.
    """

    places: IntArray
    axes: FloatArray
    limits: FloatArray
    second: BoolArray


@dataclass(frozen=True, eq=False)
class Problem:
    """What is solved in N frames: layers, the most important first, over common unknowns.

    Attributes
    ----------
    columns : Columns
    moves_root : bool
        Whether any task may move the root's translation.
    layers : tuple of tuples of WeightedTask
    hinges : HingeColumns
    attraction : float
        Gain of z.
    max_iterations : int
    """

    columns: Columns
    moves_root: bool
    layers: tuple[tuple[WeightedTask, ...], ...]
    hinges: HingeColumns
    attraction: float
    max_iterations: int


@dataclass(frozen=True, eq=False)
class Reference:
    """What z pulls to: local `rotations` (F, J, 4), and the `root`'s translations (F, 3); None leaves it out of z."""

    rotations: FloatArray
    root: FloatArray | None


@dataclass(eq=False)
class LayeredSolution:
    """What comes out, written in place: the motion, and of its N frames iterations, converged, ranks (N, L)."""

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray


def order_of_layers(priorities: Sequence[int]) -> list[int]:
    """Return the distinct priorities, the most important first."""
    return sorted(set(priorities), reverse=True)
