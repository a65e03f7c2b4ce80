"""The passes of an edit that keep it continuous in time: the default's, and the paper's ([PRIO] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.priorities.continuity.calming import calmed
from motionedit.core.priorities.continuity.displacement import filtered_root
from motionedit.core.priorities.continuity.giving_way import within_reach
from motionedit.core.priorities.continuity.straight import bent_where_missed
from motionedit.core.priorities.frames import (
    Run,
    Solved,
    known_again,
    left_alone,
    run_of,
    solve_frames,
    solve_from_input,
    solve_in_order,
)
from motionedit.core.priorities.recruiting import Recruits
from motionedit.core.priorities.settings import PaperFilter, Passes
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import IntArray


@dataclass(frozen=True, eq=False)
class Passed:
    """A motion after all passes: its `state`, and iterations (F,) of the first solve."""

    state: Solved
    iterations: IntArray


def solve(run: Run, smoothing: Passes | PaperFilter) -> Passed:
    """Return the motion after all passes."""
    return solve_in_passes(run, smoothing) if isinstance(smoothing, Passes) else solve_as_the_paper(run, smoothing)


def solve_in_passes(run: Run, smoothing: Passes) -> Passed:
    """Return the motion solved, smoothed and solved again."""
    state = bent_where_missed(run, solve_from_input(run))
    iterations = state.iterations.copy()
    found = within_reach(run, state, smoothing)
    return Passed(calmed(found, smoothing) if smoothing.count else found.state, iterations)


def solve_as_the_paper(run: Run, smoothing: PaperFilter) -> Passed:
    """Solve frame by frame from eq. (4)'s start states, filter the root, and solve again with the root frozen."""
    state = solve_in_order(run)
    iterations = state.iterations.copy()
    if not smoothing.count:
        return Passed(state, iterations)
    motion, first = run.motion, run.asked.body.first
    filtered = filtered_root(motion, state.motion, cutoff=smoothing.cutoff, first=first)
    state = replace(state, motion=filtered)
    # What is asked for is the same: the targets are.
    still = tuple(Recruits(each.joints, root=False) for each in run.asked.recruits)
    frozen = run_of(replace(run.asked, recruits=still)) if smoothing.count > 1 else run
    for _ in range(1, smoothing.count):
        known = known_again(frozen, left_alone(frozen, state), state.motion)
        state = solve_frames(frozen, state.motion, reference=motion, pull_root=False, known=known)
    return Passed(state, iterations)
