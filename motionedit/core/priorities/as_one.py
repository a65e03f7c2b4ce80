"""Many constraints of a layer that ask for the same task are solved as one, whose targets are the mean of theirs.

Squares of errors toward several targets are least where those toward their mean are, by squares of weights; and what a
layer costs grows with the cube of its rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from motionedit.core.priorities.solver.problem import Task
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.measure import Measure
    from motionedit.core.priorities.kinds.constraint import Constraint
    from motionedit.core.priorities.recruiting import Recruits

# Of so many constraints in a layer each is solved by itself.
_FEW = 8


class AveragedTask(Task, Protocol):
    """A task of targets (N, 3) whose errors are these less what a motion has, along the axes that count."""

    targets: FloatArray
    measure: Measure


def tasks_among(
    layer: Sequence[int], constraints: Sequence[Constraint], recruits: Sequence[Recruits]
) -> tuple[tuple[int, ...], ...]:
    """Return the constraints of a layer task by task: those together that are solved as one."""
    if len(layer) <= _FEW:
        return tuple([(i,) for i in layer])
    tasks: dict[Hashable, list[int]] = {}
    for i in layer:
        each = constraints[i]
        tasks.setdefault((each.about, recruits[i]) if each.averages else i, []).append(i)
    return tuple([tuple(which) for which in tasks.values()])


def mean_task(tasks: Sequence[Task], weights: Sequence[float]) -> tuple[Task, FloatArray]:
    """Return the task whose targets are the mean of several, and how far these are from it at most, shape (N,)."""
    several, squares = cast("Sequence[AveragedTask]", tasks), np.square(np.array(weights) / max(weights))
    targets, shares = np.array([each.targets for each in several]), squares / squares.sum()
    mean = (shares[:, None, None] * targets).sum(axis=0)
    apart = np.abs(targets - mean)[..., list(several[0].measure.counted)]
    return cast("Task", replace(cast("Any", several[0]), targets=mean)), apart.max(axis=(0, 2))
