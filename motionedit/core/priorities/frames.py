"""Every frame of a motion solved, group by group, and what one solve leaves for the next."""

from __future__ import annotations

from functools import cached_property
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.blocks import frame_blocks
from motionedit.core.compiled import compiled
from motionedit.core.priorities.drawn_to import drawn_to, turned_at
from motionedit.core.priorities.far_floors import lifted
from motionedit.core.priorities.far_turns import parts_of
from motionedit.core.priorities.groups import Asked, Group, groups_of, part_of, retargeted, spans_of
from motionedit.core.priorities.solver.layered import solve_layers
from motionedit.core.priorities.solver.problem import LayeredSolution, Reference
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.kinds.constraint import Turned
    from motionedit.core.priorities.ramps import Ends
    from motionedit.core.priorities.task_targets import Targets


@dataclass(frozen=True, eq=False)
class Run:
    """One edit ready to be solved: what is asked, and the groups of its frames.

    `idle`, shape (F,), are the frames in none; `place` is the root's among the joints with translations; `level_count`
    is how many priorities there are.
    """

    asked: Asked
    groups: tuple[Group, ...]
    idle: BoolArray
    place: int
    level_count: int

    def aimed_at(self, targets: tuple[Targets, ...]) -> Run:
        """Return the same edit with other targets over the same frames."""
        asked, old = replace(self.asked, targets=targets), self.asked.targets
        changed = frozenset(i for i, (one, other) in enumerate(zip(old, targets, strict=True)) if one is not other)
        return replace(self, asked=asked, groups=tuple(retargeted(asked, group, changed) for group in self.groups))

    @property
    def motion(self) -> Motion:
        """The input."""
        return self.asked.motion

    @property
    def drawn_to(self) -> Motion:
        """The input as all freedom that is left has it: see `drawn_to`; of a long one no copy is kept."""
        return turned_at(self.motion, self._drawn_to)

    @cached_property
    def _drawn_to(self) -> Sequence[tuple[IntArray, Turned]]:
        return drawn_to(self.asked)


def run_of(asked: Asked) -> Run:
    """Return an edit ready to be solved."""
    groups, place = groups_of(asked), asked.motion.skeleton.translation_places[asked.body.travel]
    idle = np.ones(len(asked.motion), dtype=np.bool_)
    for group in groups:
        idle[group.where] = False
    return Run(asked, groups, idle, int(place), len(asked.levels))


@dataclass(eq=False)
class Solved(LayeredSolution):
    """A motion whose frames are solved in place, and how it went, with L the priorities of the whole edit.

    `ends`: where the ramps ended in the last pass, None where they were not led. `steps`, shape (F,): those of its
    joints' changes that are seen, rad, and `poses`, its world transforms: None where nobody has looked.
    """

    ends: Ends | None = None
    steps: FloatArray | None = None
    poses: WorldPoses | None = None


@dataclass(frozen=True, eq=False)
class Known:
    """What a solve leaves for the next: frames (F,) that need nothing, and their ranks (F, L)."""

    done: BoolArray
    ranks: IntArray


def solve_frames(
    run: Run,
    start: Motion,
    *,
    reference: Motion,
    pull_root: bool,
    known: Known | None = None,
    in_place: bool = False,
) -> Solved:
    """Return the motion with every frame solved from `start`, attracted to `reference`.

    Parameters
    ----------
    pull_root : bool
        Whether the root's translation is attracted, too; it always is where what is asked pulls it.
    known : Known, optional
        What is known from the solve before.
    in_place : bool
        `start` is solved itself, and not a copy, be it the reference, too: of each that is read before it is written.
    """
    solved = _unsolved(run, start, known, in_place=in_place)
    travels = bool(run.motion.translations.shape[1])
    pulls = travels and (pull_root or run.asked.pulls_root)
    root = np.ascontiguousarray(reference.translations[:, run.place]) if pulls else None
    aim = Reference(reference.rotations, root)
    for group in run.groups:
        # To count is quicker than to ask whether all are.
        if known is None or np.count_nonzero(known.done[group.where]) < len(group.frames):
            _solve(run, solved, group, aim)
    if known is not None:
        solved.ranks[known.done] = known.ranks[known.done]
    return solved


def solve_from(run: Run, start: Motion, known: Known | None = None) -> Solved:
    """Return the motion with every frame solved from `start`, attracted to what the input is drawn to."""
    return solve_frames(run, start, reference=run.drawn_to, pull_root=False, known=known)


def solve_from_input(run: Run, known: Known | None = None) -> Solved:
    """Return the motion with every frame solved from the input; far turns part by part.

    A body that is far below its floor starts from above it.
    """
    motion, start = run.motion, lifted(run.asked)
    for targets, far in parts_of(run.asked):
        idle = ~far if known is None else ~far | known.done
        ranks = np.zeros((len(motion), len(run.asked.levels)), dtype=np.intp)
        part = run.aimed_at(targets)
        start = solve_from(part, start, Known(idle, ranks)).motion
    return solve_from(run, start, known)


def solve_in_order(run: Run) -> Solved:
    """Return the motion solved frame by frame, eq. (4): joints that a constraint controls start where they were."""
    solved = _unsolved(run, run.motion)
    spans = [(int(span[0]), span, group) for group in run.groups for span in spans_of(group.frames)]
    before = -2
    for first, span, group in sorted(spans, key=itemgetter(0)):
        part = part_of(run.asked, group, span)
        if before == first - 1:
            motion, joints = solved.motion, part.problem.columns.joints
            motion.rotations[first, joints] = motion.rotations[first - 1, joints]
            if part.problem.moves_root:
                motion.translations[first, run.place] = motion.translations[first - 1, run.place]
        _solve(run, solved, part, Reference(run.motion.rotations, None), in_order=True)
        before = first + len(span) - 1
    return solved


def _solve(run: Run, solved: Solved, group: Group, reference: Reference, *, in_order: bool = False) -> None:
    """Solve a group's frames of `solved` that are not converged from where they are, in place."""
    frames, levels, threads = group.frames, group.levels, run.asked.settings.threads
    solve_layers(solved, group.prepared, reference, frames, levels=levels, in_order=in_order, threads=threads)


def left_alone(run: Run, previous: Solved) -> Known:
    """Return the frames that a solve left as in the input, and its ranks."""
    return Known(_same(previous.motion, run.motion) & previous.converged, previous.ranks)


def known_again(run: Run, left: Known, start: Motion) -> Known:
    """Return what a solve from `start` may leave alone of what the one before did.

    Frames that were left as in the input, and that start from there again, need nothing.
    """
    return Known(_same(start, run.motion) & left.done if left.done.any() else left.done, left.ranks)


def _unsolved(run: Run, start: Motion, known: Known | None = None, *, in_place: bool = False) -> Solved:
    shape = len(run.idle), run.level_count
    return Solved(
        start if in_place else start.copied(),
        np.zeros(shape[0], dtype=np.int64),
        run.idle.copy() if known is None else run.idle | known.done,
        np.zeros(shape, dtype=np.int64),
        np.zeros(shape),
    )


def _same(one: Motion, other: Motion) -> BoolArray:
    """Return the frames at which two motions are alike to the bit, shape (F,)."""
    kernel = compiled()
    if kernel is not None:
        found = np.empty(len(one), dtype=np.bool_)
        pairs = one.rotations, other.rotations, one.translations, other.translations
        kernel.same(*map(np.ascontiguousarray, pairs), len(one), found)
        return found
    same: BoolArray = (one.translations == other.translations).all(axis=(1, 2))
    for block in frame_blocks(len(same)):
        same[block] &= (one.rotations[block] == other.rotations[block]).all(axis=(1, 2))
    return same
