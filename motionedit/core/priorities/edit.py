"""The edit by prioritized constraints: every frame deformed, layer by layer, and kept continuous ([PRIO] section 5)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.blocks import frame_blocks
from motionedit.core.body.bones import below
from motionedit.core.compiled import compiled
from motionedit.core.priorities.agreeing import led_by_others
from motionedit.core.priorities.continuity.passes import solve
from motionedit.core.priorities.continuity.switching import eased_from_others
from motionedit.core.priorities.frames import run_of, solve_from_input
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.ramps import led_to
from motionedit.core.priorities.recruiting import Breach, Reach, Recruits, breaches, expanded
from motionedit.core.priorities.settings import Passes
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.priorities.targets import NOBODY, Follows, errors_of, toward, with_targets
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.frames import Run
    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import Constraint, ConstraintErrors
    from motionedit.core.priorities.settings import Body, LayeredSettings, RecruitingRule
    from motionedit.core.skeleton import Skeleton


# A joint of less mobility hardly turns, whatever asks for it; one of so much does.
_HARDLY, _READILY = 0.1, 0.35


@dataclass(frozen=True, eq=False)
class PrioritizedEdit:
    """What an edit did.

    Attributes
    ----------
    motion : Motion
        In normalised metres, as the input.
    touched : shape (F, J), moved : shape (F,)
        Joints whose rotations, frames at which the root's translation changed.
    errors : tuple of ConstraintErrors
        In the order of the constraints; 0 in ramps that others lead, for which nobody asks.
    iterations : shape (F,)
        Of the first solve.
    converged : shape (F,)
        Whether the last solve of each frame stopped by itself.
    ranks : shape (F, L)
        Independent rows of each layer of priority, the most important first; 0 where it is not active.
    solver : {"compiled", "numpy"}
        What solved the frames; numpy's where any of them asked for what the compiled solver does not know.
    recruits : tuple of Recruits
        What each constraint may move, after the recruiting rule.
    breaches : tuple of Breach
        Breaches of the recruiting rule that were mended (`expand`) or left (`ignore`).
    asked : Asked
        What was asked for, for those who ask why a constraint is missed (`blame_of`).
    """

    motion: Motion
    touched: BoolArray
    moved: BoolArray
    errors: tuple[ConstraintErrors, ...]
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    solver: Literal["compiled", "numpy"]
    recruits: tuple[Recruits, ...]
    breaches: tuple[Breach, ...]
    asked: Asked


class RecruitingError(ValueError):
    """A breach of the recruiting rule where the user wants none; `breach` says which."""

    def __init__(self, breach: Breach) -> None:
        super().__init__("recruiting rule")
        self.breach = breach


def recruit(
    constraints: Sequence[Constraint], motion: Motion, body: Body, *, rule: RecruitingRule
) -> tuple[list[Recruits], list[Breach]]:
    """Return what each constraint may move, and the breaches of the recruiting rule.

    Raises
    ------
    RecruitingError
        With ``error``, at the first breach.
    """
    heavy = tuple(np.flatnonzero(body.masses.shares > 0.0).tolist())
    given = (tuple(constraints), motion.skeleton, body.travel, heavy)
    # Goals of feet are a clip's own, and as long.
    find = _recruit if any(each.stands for each in constraints) else _recruit_again
    asked, found = find(*given, frames=len(motion), rule=rule)
    return [*asked], [*found]


def _recruit(
    constraints: tuple[Constraint, ...],
    skeleton: Skeleton,
    travel: int,
    heavy: tuple[int, ...],
    *,
    frames: int,
    rule: RecruitingRule,
) -> tuple[list[Recruits], list[Breach]]:
    turnable, carriers = _turnable(skeleton, travel), _carriers(skeleton, heavy)
    movable = Movable(skeleton, travel, carriers & turnable)
    asked = [each.recruits(movable) for each in constraints]
    travels = bool(skeleton.position_axes[travel])
    asked = [Recruits(frozenset(each.joints & turnable), each.root and travels) for each in asked]
    reaches = [
        Reach(moved.joints, moved.root, *each.active(frames))
        for each in constraints
        for moved in [each.moved_by(movable)]
    ]
    priorities = [c.priority for c in constraints]
    if rule == "expand":
        return expanded(priorities, asked, reaches)
    found = breaches(priorities, asked, reaches)
    if found and rule == "error":
        raise RecruitingError(found[0])
    return asked, found


# The clips of a folder that share a skeleton mostly share their constraints, too.
_recruit_again = lru_cache(maxsize=4)(_recruit)


@lru_cache(maxsize=8)
def _turnable(skeleton: Skeleton, travel: int) -> frozenset[int]:
    """Return the joints that can be turned: those that the travel carries and that have rotation channels."""
    carried = below(skeleton, travel)
    return frozenset(j for j, axes in enumerate(skeleton.rotation_axes) if axes and carried[j])


@lru_cache(maxsize=8)
def _carriers(skeleton: Skeleton, heavy: tuple[int, ...]) -> frozenset[int]:
    """Return the joints that carry mass, those that are `heavy`, and those above them."""
    return frozenset(int(k) for j in heavy for k in skeleton.chain(j))


def prepare(
    motion: Motion,
    constraints: Sequence[Constraint],
    body: Body,
    settings: LayeredSettings,
    *,
    follows: Follows = NOBODY,
) -> tuple[Run, list[Breach]]:
    """Return an edit that is ready to be solved, and the breaches of the recruiting rule; raises as `recruit`."""
    recruits, found = recruit(constraints, motion, body, rule=settings.recruiting_rule)
    body = _with_all_that_is_asked(body, constraints, recruits)

    def ready(asked: Asked) -> Run:
        smoothing = settings.smoothing
        return eased_from_others(asked, smoothing) if isinstance(smoothing, Passes) else run_of(asked)

    def solved(asked: Asked) -> Motion:
        return solve_from_input(ready(asked)).motion

    return ready(with_targets(motion, constraints, recruits, body, settings, solve=solved, follows=follows)), found


def _with_all_that_is_asked(body: Body, constraints: Sequence[Constraint], recruits: Sequence[Recruits]) -> Body:
    """Return a body whose joints turn readily enough where a constraint recruits none that does."""
    if body.mobility is None:
        return body
    mobility = body.mobility.copy()
    for each, own in zip(constraints, recruits, strict=True):
        joints = sorted(own.joints)
        if joints and (each.turns or not own.root) and float(body.mobility[joints].max()) < _HARDLY:
            mobility[joints] = _READILY
    return body if np.array_equal(mobility, body.mobility) else replace(body, mobility=frozen(mobility))


def edit_by_priorities(
    motion: Motion,
    constraints: Sequence[Constraint],
    body: Body,
    settings: LayeredSettings,
    *,
    follows: Follows = NOBODY,
) -> PrioritizedEdit:
    """Return the motion deformed so that the constraints hold, each priority as far as those above it allow.

    Parameters
    ----------
    motion : Motion
        The input, lengths in normalised metres.
    constraints
        Lengths in normalised metres, too.
    follows : Follows
        Whose paths they follow, where it is not the motion's: it has been changed before, or there is a reference.

    Raises
    ------
    RecruitingError
        As `recruit`.
    """
    run, found = prepare(motion, constraints, body, settings, follows=follows)
    passed = solve(run, settings.smoothing)
    state = passed.state
    asked = run.asked if state.ends is None else replace(run.asked, targets=led_to(run.asked, state.ends))
    by: Literal["compiled", "numpy"] = "numpy"
    if compiled() and all(group.prepared.layout for group in run.groups):
        by = "compiled"
    del run  # with the layouts of all its frames
    touched, moved = changes(follows.input or motion, state.motion, body.travel)
    return PrioritizedEdit(
        motion=state.motion,
        touched=touched,
        moved=moved,
        errors=errors_of(_asked_by_anybody(asked, state.motion), state.motion, poses=state.poses),
        iterations=passed.iterations,
        converged=state.converged,
        ranks=state.ranks,
        solver=by,
        recruits=asked.recruits,
        breaches=tuple(found),
        asked=asked,
    )


def _asked_by_anybody(asked: Asked, motion: Motion) -> Asked:
    """Return what is asked with the targets of ramps that others lead where a motion has them: they count as met."""
    led = led_by_others(asked.constraints, asked.targets, len(asked.motion))
    shares = {int(i): led[:, i].astype(np.float64) for i in np.flatnonzero(led.any(axis=0))}
    return replace(asked, targets=toward(asked, asked.targets, shares, motion)) if shares else asked


def changes(before: Motion, after: Motion, travel: int) -> tuple[BoolArray, BoolArray]:
    """Return which joints turn otherwise, shape (F, J), and where the travel goes otherwise, shape (F,)."""
    shifts = (after.translations - before.translations)[:, before.skeleton.translated == travel]
    moved: BoolArray = np.abs(shifts).max(axis=(1, 2), initial=0.0) > NO_DISPLACEMENT
    return _turned(before.rotations, after.rotations), moved


def _turned(before: FloatArray, after: FloatArray) -> BoolArray:
    """Return which rotations, shape (F, J, 4), are others than before, shape (F, J)."""
    turned, kernel = np.empty(before.shape[:2], dtype=np.bool_), compiled()
    if kernel is not None:
        pair = np.ascontiguousarray(before), np.ascontiguousarray(after)
        kernel.turned(*pair, turned.size, NO_DISPLACEMENT, turned)
        return turned
    for block in frame_blocks(len(before)):
        # A turn so small is twice the vector part of its quaternion.
        turns = rot.between(before[block], after[block])
        x, y, z = (2.0 * np.abs(turns[..., part]) > NO_DISPLACEMENT for part in (1, 2, 3))
        turned[block] = x | y | z
    return turned
