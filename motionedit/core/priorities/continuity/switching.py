"""Where constraints switch on and off over others: their ramps lead from and to what the others make of the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.frames import run_of
from motionedit.core.priorities.ramps import ramps_of, task_at
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.targets import errors_of, reached
from motionedit.core.priorities.task_targets import moved
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run
    from motionedit.core.priorities.groups import Asked, Ramp
    from motionedit.core.priorities.settings import Passes


def eased_from_others(asked: Asked, smoothing: Passes) -> Run:
    """Return what is asked, with ramps from and to where the other constraints alone have each one's task.

    In a ramp the motion that a constraint takes over is what the others make of it, not the input.
    """
    motion = asked.motion
    alone: dict[tuple[int, ...], Motion] = {}
    wanted: dict[tuple[int, ...], BoolArray] = {}
    targets, ramps = list(asked.targets), []
    for i in range(len(targets)):
        own = list(ramps_of(asked, i))
        for k, ramp in enumerate(own):
            others = _others(asked, i, ramp)
            if others and others not in wanted:
                wanted[others] = _wanted(asked.only(others), motion)
            if not others or not wanted[others][ramp.left > 0.0].any():
                continue
            if others not in alone:
                alone[others] = solve_in_passes(run_of(asked.only(others)), smoothing).state.motion
            there = alone[others]
            left = ramp.left[targets[i].span]
            targets[i] = moved(targets[i], reached(asked, i, motion), reached(asked, i, there), left)
            own[k] = replace(ramp, end=task_at(asked, i, there, ramp.outside))
        ramps.append(tuple(own))
    return run_of(replace(asked, targets=tuple(targets), ramps=tuple(ramps)))


def _others(asked: Asked, i: int, ramp: Ramp) -> tuple[int, ...]:
    """Return the constraints that are active where a ramp of constraint `i` ends."""
    return tuple(k for k, span in enumerate(asked.targets) if k != i and span.first <= ramp.outside <= span.last)


def _wanted(asked: Asked, motion: Motion) -> BoolArray:
    """Return at which frames constraints want anything that a motion does not do already, shape (F,)."""
    wanted = np.zeros(len(motion), dtype=np.bool_)
    for errors, targets in zip(errors_of(asked, motion), asked.targets, strict=True):
        for left in (errors.positions, errors.angles):
            if left is not None:
                wanted[targets.span] |= left > NO_DISPLACEMENT
    return wanted
