"""Constraints that ask for the same task: a more important one overrules others, and equals agree in their ramps.

Where one of a higher priority is active, those below it have no freedom. They are not solved for: what they may move
they would move, and it would be moved back. And nobody asked for the way of a ramp. Of equals that are eased in by s,
whose targets are T, all ask for sum b T / sum b there, b = w^2 s / (1 - s): the one whose points are at hand has all
the say. Those that are overruled in a ramp ask for what overrules them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.task_targets import Targets, between

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.priorities.kinds.constraint import Constraint


# At the end of its ramp a constraint has a say all the same.
_LEAST_SHARE = 1e-12


def agreed(constraints: Sequence[Constraint], targets: Sequence[Targets], frames: int) -> tuple[Targets, ...]:
    """Return the targets of constraints in a clip of so many frames, ramps of the same task in agreement.

    Equals whose points overlap contradict each other: they are left to share by weight.
    """
    found = list(targets)
    for which in _same_tasks(constraints):
        active = _active([found[i] for i in which], frames)
        several = active.sum(axis=0) > 1
        if not several.any():
            continue
        together = [constraints[i] for i in which]
        leads, shares = _leading(together, active), np.array([each.share(frames) for each in together])
        if ((leads & (shares == 1.0)).sum(axis=0) > 1).any():
            continue
        say = _say([each.weight for each in together], leads * np.maximum(shares, _LEAST_SHARE))
        theirs = _mean([found[i] for i in which], say)
        for i, follows in zip(which, several & active & (shares < 1.0), strict=True):
            span = found[i].span
            found[i] = between(found[i], theirs.within(span), follows[span].astype(np.float64))
    return tuple(found)


def overruled(constraints: Sequence[Constraint], targets: Sequence[Targets], frames: int) -> BoolArray:
    """Return at which frames constraints are overruled by one of a higher priority, shape (F, C)."""
    without = np.zeros((frames, len(constraints)), dtype=np.bool_)
    for which in _same_tasks(constraints):
        active = _active([targets[i] for i in which], frames)
        without[:, which] = (active & ~_leading([constraints[i] for i in which], active)).T
    return without


def led_by_others(constraints: Sequence[Constraint], targets: Sequence[Targets], frames: int) -> BoolArray:
    """Return at which frames ramps are led by others, shape (F, C): there nobody asks for what they do.

    Others of the same or a higher priority are active there that say where the same point is, or how the same joint
    is turned, be it along other axes or in another's frame.
    """
    led = np.zeros((len(constraints), frames), dtype=np.bool_)
    active, subjects = _active(targets, frames), [each.subjects for each in constraints]
    for i, one in enumerate(constraints):
        for k, other in enumerate(constraints):
            if k != i and other.priority >= one.priority and not subjects[i].isdisjoint(subjects[k]):
                led[i] |= active[k]
        if led[i].any():
            led[i] &= active[i] & (one.share(frames) < 1.0)
    return led.T


def _same_tasks(constraints: Sequence[Constraint]) -> list[list[int]]:
    """Return the constraints that ask for a task of which there are several, task by task."""
    tasks: dict[Hashable, list[int]] = {}
    for i, each in enumerate(constraints):
        if each.about is not None:
            tasks.setdefault(each.about, []).append(i)
    return [which for which in tasks.values() if len(which) > 1]


def _active(targets: Sequence[Targets], frames: int) -> BoolArray:
    """Return at which frames targets are those of something, shape (n, F)."""
    active = np.zeros((len(targets), frames), dtype=np.bool_)
    for row, each in zip(active, targets, strict=True):
        row[each.span] = True
    return active


def _leading(constraints: Sequence[Constraint], active: BoolArray) -> BoolArray:
    """Return at which frames constraints are of the highest priority of those that are active, shape (n, F)."""
    priorities = np.array([each.priority for each in constraints])[:, None]
    highest = np.where(active, priorities, priorities.min()).max(axis=0)
    leading: BoolArray = active & (priorities == highest)
    return leading


def _say(weights: Sequence[float], shares: FloatArray) -> FloatArray:
    """Return how much constraints have to say, of which at most one is eased in wholly anywhere, shape (n, F): b."""
    wholly = shares == 1.0
    left = np.where(wholly, 1.0, 1.0 - shares)
    say: FloatArray = np.where(wholly.any(axis=0), wholly, np.square(weights)[:, None] * shares / left)
    return say


def _mean(targets: Sequence[Targets], say: FloatArray) -> Targets:
    """Return what targets of a clip's frames are on the whole, each having so much to say, shape (n, F)."""
    mean, before = _whole(targets[0], say.shape[1]), np.zeros(say.shape[1])
    for each, much in zip(targets, say, strict=True):
        before += much
        share = np.divide(much, before, out=np.zeros_like(much), where=before > 0.0)[each.span]
        mean = mean.with_part(between(mean.within(each.span), each, share))
    return mean


def _whole(targets: Targets, frames: int) -> Targets:
    """Return targets of all frames of a clip: these, where they are, and their first beside them."""
    rows = np.clip(np.arange(frames) - targets.first, 0, targets.last - targets.first)
    return Targets(0, frames - 1, *(None if part is None else part[rows] for part in targets.parts))
