"""The layered solver: tasks in strict priority layers over many frames ([PRIO] section 3, made strict).

Per frame and iteration, with Q the orthonormal rows of the layers above:

    A = w J,  b = w e - A dm,  A~ = A - (A Q^T) Q
    dm += sum_r v_r (u_r . b) s_r / (s_r^2 + lambda^2)    over the kept singular triples of A~; all kept v_r join Q
    dm += z - Q^T (Q z)                                   z pulls towards the reference, eq. (1)

The damping lambda is in the step, never in the projector, so a layer cannot disturb those above it to first order;
what it does to second order is annealed away: in the last iterations the steps of lower layers shrink to nothing.

Two solvers do this: `layered_numpy`, the readable reference, with all frames at once, and the compiled one of `csrc`, a
few frames side by side. They agree to rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.compiled import compiled
from motionedit.core.priorities import compiled_solver as kernel
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.tasks import Columns, Task


@dataclass(frozen=True, eq=False)
class WeightedTask:
    """A task and its weight in its layer."""

    task: Task
    weight: float


@dataclass(frozen=True, eq=False)
class HingeColumns:
    """Columns that turn about one axis: their `places` (H,), axes (H, 3) in the joint, and limits (H, 2) in rad."""

    places: IntArray
    axes: FloatArray
    limits: FloatArray


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
    layout : kernel.Layout or None
        The problem as the compiled solver has it, where it was laid out before.
    """

    columns: Columns
    moves_root: bool
    layers: tuple[tuple[WeightedTask, ...], ...]
    hinges: HingeColumns
    attraction: float
    max_iterations: int
    layout: kernel.Layout | None = None


@dataclass(frozen=True, eq=False)
class Reference:
    """What z pulls to: local `rotations` (F, J, 4), and the `root`'s translations (F, 3); None leaves it out of z."""

    rotations: FloatArray
    root: FloatArray | None


@dataclass(frozen=True, eq=False)
class LayeredSolution:
    """What came out: the motion, and of its N frames that were solved iterations (N,), converged (N,), ranks (N, L)."""

    motion: Motion
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray


def solve_layers(
    problem: Problem,
    motion: Motion,
    reference: Reference,
    frames: IntArray,
    *,
    done: BoolArray | None = None,
    in_order: bool = False,
    threads: int = 1,
) -> LayeredSolution:
    """Move frames of a motion so that the layers are met, each as far as those above it allow.

    Parameters
    ----------
    motion : Motion
        The caller's own: it is changed in place, so that of a long one there is no copy.
    reference : Reference
        Of as many frames as the motion.
    frames : shape (N,)
        Which frames the problem is about.
    done : shape (N,), optional
        Frames that are known to need nothing: they stay as they are, converged, without iterations and ranks.
    in_order : bool
        The frames follow each other without a gap, none is `done`, and each begins where the one before ended, in what
        the columns move: eq. (4).
    threads : int
        Frames are shared out among so many threads where the compiled solver runs; the result does not depend on it.
    """
    solution = LayeredSolution(
        motion,
        np.zeros(len(frames), dtype=np.int64),
        np.zeros(len(frames), dtype=np.bool_) if done is None else done.copy(),
        np.zeros((len(frames), len(problem.layers)), dtype=np.int64),
    )
    if compiled() is None:
        from motionedit.core.priorities import numpy_solver as layered_numpy

        layered_numpy.solve(problem, solution, reference, frames, in_order=in_order)
    else:
        kernel.solve(problem, solution, reference, frames, in_order=in_order, threads=threads)
    return solution
