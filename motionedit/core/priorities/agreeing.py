"""Constraints of one priority that ask for the same task agree in their ramps: nobody asked for a way of their own.

Of equals that are eased in by s, whose targets are T, all ask for sum b T / sum b there, b = w^2 s / (1 - s): the one
whose points are at hand has all the say.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.priorities.task_targets import Targets, between

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.priorities.kinds.constraint import Constraint


def agreed(constraints: Sequence[Constraint], targets: Sequence[Targets], frames: int) -> tuple[Targets, ...]:
    """Return the targets of constraints in a clip of so many frames, ramps of equals in agreement.

    Equals whose points overlap contradict each other: they are left to share by weight.
    """
    found = list(targets)
    for which in _equals(constraints):
        active = np.zeros((len(which), frames), dtype=np.bool_)
        for row, i in zip(active, which, strict=True):
            row[found[i].span] = True
        several = active.sum(axis=0) > 1
        shares = active * [constraints[i].share(frames) for i in which]
        if not several.any() or ((shares == 1.0).sum(axis=0) > 1).any():
            continue
        theirs = _mean([found[i] for i in which], _say([constraints[i].weight for i in which], shares))
        for i, follows in zip(which, several & (shares < 1.0), strict=True):
            span = found[i].span
            found[i] = between(found[i], theirs.within(span), follows[span].astype(np.float64))
    return tuple(found)


def _equals(constraints: Sequence[Constraint]) -> list[list[int]]:
    """Return the constraints that ask for the same task with the same priority, task by task, where there are two."""
    equals: dict[Hashable, list[int]] = {}
    for i, each in enumerate(constraints):
        if each.about is not None:
            equals.setdefault((each.about, each.priority), []).append(i)
    return [which for which in equals.values() if len(which) > 1]


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
