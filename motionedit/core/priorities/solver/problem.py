"""What the layered solvers are given and what they return: tasks in layers over the unknowns of many frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from motionedit.core.body.limits import NO_LIMITS
from motionedit.core.measure import WORLD, Measure
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.solver.points import Columns, Point, Recruited


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
    sign : float
        -1 turns its rows and errors around.
    """

    row_kind: str
    recruited: Recruited
    targets: FloatArray
    point: Point | None = None
    base: Point | None = None
    measure: Measure = WORLD
    axis: FloatArray | None = None
    masses: Masses | None = None
    sign: float = 1.0


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
    """A task and its weight in its layer.

    Rows that are `one_sided` ask for J w >= e: they count only where e > 0, or where a step would take them there.
    `apart`, shape (N,), is how far the targets are at most of which the task's are the mean; None: of one alone.
    """

    task: Task
    weight: float
    one_sided: bool = False
    apart: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class HingeColumns:
    """Columns that turn about one axis or two: their `places` (H,), axes (H, 3), and limits (H, 2) in rad.

    `second` (H,) tells which is the second hinge of its column; it follows the first. Axes are in the parent's frame,
    those of second ones in the joint's. A hinge's angle is the one about its axis from `upper`, in the parent's frame,
    to `lower`, in the joint's, shapes (H, 3).
    """

    places: IntArray
    axes: FloatArray
    upper: FloatArray
    lower: FloatArray
    limits: FloatArray
    second: BoolArray


@dataclass(frozen=True, eq=False)
class LimitColumns:
    """Cones of columns that turn about any axis: their `places` (C,), and the rest of `body.limits.Limits`.

    Centres (C, 4), bones `along` (C, 3) in the joints' frames, half ranges `swing` and `twist` (C,) in rad.
    """

    places: IntArray
    centers: FloatArray
    along: FloatArray
    swing: FloatArray
    twist: FloatArray


_NO_LIMITS = LimitColumns(NO_LIMITS.joints, NO_LIMITS.centers, NO_LIMITS.along, NO_LIMITS.swing, NO_LIMITS.twist)


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
    mobility : shape (K + 1,)
        How readily each column turns, and the root shifts: z is as long as its parts over their mobility.
    softness : shape (N, L)
        lambda^2 of layers that give way, (m/rad)^2: such a layer is |e|^2 + lambda^2 |z|^2 made least among its rows. 0
        of layers that shall be met.
    limits : LimitColumns
    ends_early : bool
        Whether frames in which what is missed stays so end before their iterations do: see `annealing`.
    """

    columns: Columns
    moves_root: bool
    layers: tuple[tuple[WeightedTask, ...], ...]
    hinges: HingeColumns
    attraction: float
    max_iterations: int
    mobility: FloatArray
    softness: FloatArray
    limits: LimitColumns = _NO_LIMITS
    ends_early: bool = True


@dataclass(frozen=True, eq=False)
class Reference:
    """What z pulls to: local `rotations` (F, J, 4), and the `root`'s translations (F, 3); None leaves it out of z."""

    rotations: FloatArray
    root: FloatArray | None


@dataclass(eq=False)
class LayeredSolution:
    """What comes out, written in place: the motion, and of its F frames iterations, converged, ranks (F, L).

    `left` (F, L) is the largest error of any row, its weight taken off, before the last step: no step makes more of it.
    """

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    left: FloatArray


def order_of_layers(priorities: Sequence[int]) -> list[int]:
    """Return the distinct priorities, the most important first."""
    return sorted(set(priorities), reverse=True)
