"""Groups of frames: where the same constraints are active, frames are one problem."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.ik.layered_solver import HingeColumns, Problem, WeightedTask
from motionedit.core.ik.tasks import CenterOfMassTask

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import IntArray
    from motionedit.core.editing.constraints import Targets
    from motionedit.core.hinges import Hinge


@dataclass(frozen=True, eq=False)
class Group:
    """Frames at which the same constraints are active, which are solved together.

    Attributes
    ----------
    frames : shape (n,)
    levels : shape (L,)
        Where the problem's layers stand among those of the whole edit.
    problem : Problem
    following : pairs of (layer, place in the layer) and constraint
        Tasks whose targets depend on the edited motion.
    """

    frames: IntArray
    levels: IntArray
    problem: Problem
    following: tuple[tuple[int, int, int], ...]

    def with_targets(self, targets: Sequence[Targets]) -> Problem:
        """Return the problem with new targets for the tasks that follow the edited motion."""
        if not self.following:
            return self.problem
        layers = [list(layer) for layer in self.problem.layers]
        for layer, place, constraint in self.following:
            each, new = layers[layer][place], targets[constraint]
            if isinstance(each.task, CenterOfMassTask) and new.positions is not None:
                task = replace(each.task, targets=new.positions[self.frames - new.first])
                layers[layer][place] = WeightedTask(task, each.weight)
        problem = replace(self.problem, layers=tuple(map(tuple, layers)))
        layout = self.problem.layout
        return problem if layout is None else replace(problem, layout=layout.with_targets(problem))


def hinge_columns(hinges: Sequence[Hinge], joints: IntArray) -> HingeColumns:
    """Return the hinges among the columns, which are `joints`."""
    here = [hinge for hinge in hinges if hinge.joint in set(map(int, joints))]
    return HingeColumns(
        places=np.searchsorted(joints, np.array([hinge.joint for hinge in here], dtype=np.intp)),
        axes=np.array([hinge.axis for hinge in here]).reshape(-1, 3),
        limits=np.array([hinge.limits for hinge in here]).reshape(-1, 2),
    )


def spans_of(frames: IntArray) -> list[IntArray]:
    """Return frames cut where they do not follow each other."""
    return np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1)
