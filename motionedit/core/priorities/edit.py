"""The edit by prioritized constraints: every frame deformed, layer by layer, and kept continuous ([PRIO] section 5)."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.priorities.constraints import (
    Constraint,
    reach_of,
    recruits_of,
)
from motionedit.core.priorities.continuity import NO_DISPLACEMENT, smoothed_displacement
from motionedit.core.priorities.recruiting import Breach, Recruits, breaches, expanded
from motionedit.core.priorities.run import Run, Solved
from motionedit.core.trace import frame_blocks
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.body.hinges import Hinge
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.constraint_errors import ConstraintErrors


@dataclass(frozen=True)
class Passes:
    """The default smoothing: low-pass the displacement map, solve again attracted to it; sigma in frames."""

    count: int = 3
    sigma: float = 1.5


@dataclass(frozen=True)
class PaperFilter:
    """The paper's: eq. (4) start states, an FIR low-pass on the root's translation (Hz), further passes."""

    count: int = 2
    cutoff: float = 3.0


@dataclass(frozen=True)
class LayeredSettings:
    """How an edit is solved: what the spec says beside its constraints."""

    smoothing: Passes | PaperFilter = field(default_factory=Passes)
    curve: Literal["time", "index"] = "time"
    attraction: float = 1.0
    max_iterations: int = 40
    recruiting_rule: Literal["expand", "error", "ignore"] = "expand"
    threads: int = 1


@dataclass(frozen=True, eq=False)
class Body:
    """What the edit knows of the body: its masses, hinges, and the joint that carries the travel."""

    masses: Masses
    hinges: tuple[Hinge, ...]
    travel: int
    first: int


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
        In the order of the constraints.
    iterations : shape (F,)
        Of the first solve.
    converged : shape (F,)
        Whether the last solve of each frame stopped by itself.
    ranks : shape (F, L)
        Independent rows of each layer of priority, the most important first; 0 where it is not active.
    recruits : tuple of Recruits
        What each constraint may move, after the recruiting rule.
    breaches : tuple of Breach
        Breaches of the recruiting rule that were mended (`expand`) or left (`ignore`).
    """

    motion: Motion
    touched: BoolArray
    moved: BoolArray
    errors: tuple[ConstraintErrors, ...]
    iterations: IntArray
    converged: BoolArray
    ranks: IntArray
    recruits: tuple[Recruits, ...]
    breaches: tuple[Breach, ...]


class RecruitingError(ValueError):
    """A breach of the recruiting rule where the user wants none; `breach` says which."""

    def __init__(self, breach: Breach) -> None:
        super().__init__("recruiting rule")
        self.breach = breach


def recruit(
    constraints: Sequence[Constraint], motion: Motion, body: Body, *, rule: Literal["expand", "error", "ignore"]
) -> tuple[list[Recruits], list[Breach]]:
    """Return what each constraint may move, and the breaches of the recruiting rule.

    Raises
    ------
    RecruitingError
        With ``error``, at the first breach.
    """
    skeleton, frames = motion.skeleton, len(motion)
    turnable = {j for j, axes in enumerate(skeleton.rotation_axes) if len(axes) in {1, 3}}
    massive = _body_joints(body, motion) & turnable
    asked = [recruits_of(c, skeleton, travel=body.travel, body=frozenset(massive)) for c in constraints]
    # A root without all its position channels has no translation that could be moved freely.
    travels = len(skeleton.position_axes[body.travel]) == 3
    asked = [Recruits(frozenset(each.joints & turnable), each.root and travels) for each in asked]
    reaches = [reach_of(c, skeleton, frames=frames, body=frozenset(massive)) for c in constraints]
    priorities = [c.priority for c in constraints]
    if rule == "expand":
        return expanded(priorities, asked, reaches)
    found = breaches(priorities, asked, reaches)
    if found and rule == "error":
        raise RecruitingError(found[0])
    return asked, found


def _body_joints(body: Body, motion: Motion) -> set[int]:
    """Return the joints that carry mass and those above them, from the travel-carrying joint down."""
    skeleton = motion.skeleton
    joints: set[int] = set()
    for j in np.flatnonzero(body.masses.shares > 0.0):
        chain = [int(k) for k in skeleton.chain(int(j))]
        joints.update(chain[chain.index(body.travel) :] if body.travel in chain else chain)
    return joints


def prepare(
    motion: Motion, constraints: Sequence[Constraint], body: Body, settings: LayeredSettings
) -> tuple[Run, list[Breach]]:
    """Return an edit that is ready to be solved, and the breaches of the recruiting rule; raises as `recruit`."""
    recruits, found = recruit(constraints, motion, body, rule=settings.recruiting_rule)
    return Run(motion, tuple(constraints), tuple(recruits), body, settings), found


def edit_by_priorities(
    motion: Motion, constraints: Sequence[Constraint], body: Body, settings: LayeredSettings
) -> PrioritizedEdit:
    """Return the motion deformed so that the constraints hold, each priority as far as those above it allow.

    Parameters
    ----------
    motion : Motion
        The input, lengths in normalised metres.
    constraints
        Lengths in normalised metres, too.

    Raises
    ------
    RecruitingError
        As `recruit`.
    """
    run, found = prepare(motion, constraints, body, settings)
    if isinstance(settings.smoothing, Passes):
        state, iterations = solve_in_passes(run, settings.smoothing)
    else:
        state, iterations = run.solve_as_the_paper(settings.smoothing)
    touched, moved = _changes(motion, state.motion, body.travel)
    return PrioritizedEdit(
        motion=state.motion,
        touched=touched,
        moved=moved,
        errors=run.errors(state),
        iterations=iterations,
        converged=state.converged,
        ranks=state.ranks,
        recruits=run.recruits,
        breaches=tuple(found),
    )


def solve_in_passes(run: Run, smoothing: Passes) -> tuple[Solved, IntArray]:
    """Return the motion solved, smoothed and solved again, and the iterations (F,) of the first solve."""
    motion = run.motion
    state = run.solve(motion, reference=motion, pull_root=False)
    iterations = state.iterations.copy()
    for _ in range(smoothing.count):
        smooth = smoothed_displacement(motion, state.motion, sigma=smoothing.sigma, first=run.body.first)
        known = run.after(state, smooth)
        del state  # of a long motion no more copies are kept than are needed
        state = run.solve(smooth, reference=smooth, pull_root=True, known=known)
        del smooth
    return state, iterations


def _changes(before: Motion, after: Motion, travel: int) -> tuple[BoolArray, BoolArray]:
    touched = np.empty(before.rotations.shape[:2], dtype=np.bool_)
    for block in frame_blocks(len(before)):
        # A turn so small is twice the vector part of its quaternion.
        turns = rot.multiply(rot.conjugate(before.rotations[block]), after.rotations[block])[..., 1:]
        touched[block] = 2.0 * np.abs(turns).max(axis=2) > NO_DISPLACEMENT
    place = np.searchsorted(before.skeleton.translated, travel)
    shifts = (after.translations - before.translations)[:, place : place + 1]
    moved: BoolArray = np.abs(shifts).max(axis=(1, 2), initial=0.0) > NO_DISPLACEMENT
    return touched, moved
