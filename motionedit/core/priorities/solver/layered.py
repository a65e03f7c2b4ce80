"""The layered solver: tasks in strict priority layers over many frames ([PRIO] section 3, made strict).

Per frame and iteration, with Q the orthonormal rows of the layers above:

    A = w J,  b = w e - A dm,  A~ = A - (A Q^T) Q
    dm += sum_r v_r (u_r . b) s_r / (s_r^2 + lambda^2)    over the kept singular triples of A~; all kept v_r join Q
    dm += z - Q^T (Q z)                                   z pulls towards the reference, eq. (1)

The damping lambda is in the step, never in the projector, so a layer cannot disturb those above it to first order;
what it does to second order is annealed away: in the last iterations the steps of lower layers shrink to nothing.

Two solvers do this: `numpy_solver`, the readable reference, with all frames at once, and the compiled one of `csrc`, a
few frames side by side. They agree to rounding. Where a task is one that the compiled one does not know, numpy solves
the whole problem.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.compiled import compiled
from motionedit.core.priorities.solver import compiled_solver
from motionedit.core.priorities.solver.compiled_solver import Layout, layout_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import IntArray
    from motionedit.core.priorities.solver.problem import LayeredSolution, Problem, Reference


@dataclass(frozen=True, eq=False)
class Prepared:
    """A problem, and its layout for the compiled solver; None where numpy solves it."""

    problem: Problem
    layout: Layout | None

    def with_targets_of(self, problem: Problem) -> Prepared:
        """Return the same problem with the targets of another that has the same tasks."""
        return Prepared(problem, None if self.layout is None else self.layout.with_targets_of(problem))


def prepare_problem(problem: Problem) -> Prepared:
    """Return a problem ready to be solved: laid out for the compiled solver, where that runs and knows all tasks."""
    return Prepared(problem, layout_of(problem))


def solve_layers(
    solution: LayeredSolution,
    prepared: Prepared,
    reference: Reference,
    frames: IntArray,
    *,
    levels: IntArray,
    in_order: bool = False,
    threads: int = 1,
) -> None:
    """Move frames of a motion so that the layers are met, each as far as those above it allow; in place.

    Parameters
    ----------
    solution : LayeredSolution
        The motion, where it starts, and what is told of it: zeros at the frames. Those that are converged are known to
        need nothing: they stay as they are.
    reference : Reference
        Of as many frames as the motion.
    frames : shape (N,)
        Which frames the problem is about, each once.
    levels : shape (L,)
        Where the problem's layers stand among those that the solution tells of. Of several at one place the ranks are
        added up, and the largest of what is left stands.
    in_order : bool
        The frames follow each other without a gap, none is converged, and each begins where the one before ended, in
        what the columns move: eq. (4).
    threads : int
        Frames are shared out among so many threads where the compiled solver runs; the result does not depend on it.
    """
    unsolved = ~solution.converged[frames]
    if prepared.layout is None or compiled() is None:
        from motionedit.core.priorities.solver import numpy_solver

        numpy_solver.solve(prepared.problem, solution, reference, frames, levels=levels, in_order=in_order)
    else:
        softness = prepared.problem.softness
        compiled_solver.solve(
            prepared.layout,
            solution,
            reference,
            frames,
            softness=softness,
            levels=levels,
            in_order=in_order,
            threads=threads,
        )
    for level, layer in zip(levels, prepared.problem.layers, strict=True):
        for each in layer:
            if each.apart is not None:
                solution.left[frames, level] += unsolved * each.apart
