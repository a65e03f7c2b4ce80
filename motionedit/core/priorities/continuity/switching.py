"""Where constraints switch on and off over others: their ramps lead from and to what the others make of the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.agreeing import agreed
from motionedit.core.priorities.continuity.passes import solve_in_passes
from motionedit.core.priorities.frames import run_of
from motionedit.core.priorities.ramps import ramps_of, task_at
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.targets import lefts_of, reached
from motionedit.core.priorities.task_targets import moved
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run
    from motionedit.core.priorities.groups import Asked, Ramp
    from motionedit.core.priorities.settings import Passes

    Members = tuple[int, ...]
    Ramps = tuple[tuple[Ramp, ...], ...]


def eased_from_others(asked: Asked, smoothing: Passes) -> Run:
    """Return what is asked, with ramps from and to where the other constraints alone have each one's task.

    In a ramp the motion that a constraint takes over is what the others make of it, not the input.
    """
    ramps = tuple(ramps_of(asked, i) for i in range(len(asked.targets)))
    return run_of(_eased(asked, ramps, tuple(range(len(ramps))), _Alone(asked, ramps, smoothing)))


class _Alone:
    """What constraints alone make of the motion, solved once."""

    def __init__(self, asked: Asked, ramps: Ramps, smoothing: Passes) -> None:
        self._asked, self._ramps, self._smoothing = asked, ramps, smoothing
        self._wanted: dict[Members, BoolArray] = {}
        self._found: dict[Members, Motion] = {}

    def within(self, ramp: Ramp, members: Members) -> Motion | None:
        """Return what they make of it within a ramp; None where that is the motion itself."""
        if not members:
            return None
        if members not in self._wanted:
            self._wanted[members] = _wanted(self._asked.only(members), self._asked.motion)
        if not self._wanted[members][ramp.left > 0.0].any():
            return None
        if members not in self._found:
            own = _eased(self._asked, self._ramps, members, self)
            self._found[members] = solve_in_passes(run_of(own), self._smoothing).state.motion
        return self._found[members]


def _eased(asked: Asked, ramps: Ramps, members: Members, alone: _Alone) -> Asked:
    """Return what some constraints ask for, with ramps from and to where the others of them alone have each one's.

    Those of the same task agree in their ramps.
    """
    targets, led = list(asked.targets), list(ramps)
    for i in members:
        own = list(ramps[i])
        for k, ramp in enumerate(own):
            there = alone.within(ramp, _others(asked, i, ramp, members))
            if there is None:
                continue
            left = ramp.left[targets[i].span]
            targets[i] = moved(targets[i], reached(asked, i, asked.motion), reached(asked, i, there), left)
            own[k] = replace(ramp, end=task_at(asked, i, there, ramp.outside))
        led[i] = tuple(own)
    found = replace(asked, targets=tuple(targets), ramps=tuple(led)).only(members)
    return replace(found, targets=agreed(found.constraints, found.targets, len(asked.motion)))


def _others(asked: Asked, i: int, ramp: Ramp, members: Members) -> Members:
    """Return which of some constraints beside one are active where a ramp of it ends."""
    spans = asked.targets
    return tuple(k for k in members if k != i and spans[k].first <= ramp.outside <= spans[k].last)


def _wanted(asked: Asked, motion: Motion) -> BoolArray:
    """Return at which frames constraints want anything that a motion does not do already, shape (F,)."""
    wanted: BoolArray = np.max(lefts_of(asked, motion), axis=0) > NO_DISPLACEMENT
    return wanted
