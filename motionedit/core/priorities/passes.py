"""The passes of an edit that keep it continuous in time: the default's, and the paper's ([PRIO] section 5)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from motionedit.core.priorities.continuity import filtered_root, on_channels, smoothed_displacement
from motionedit.core.priorities.frames import Run, Solved, known_after, run_of, solve_frames, solve_in_order
from motionedit.core.priorities.recruiting import Recruits
from motionedit.core.priorities.settings import PaperFilter, Passes
from motionedit.core.priorities.straight import bent_where_missed

if TYPE_CHECKING:
    from motionedit.core.arrays import IntArray


def solve(run: Run, smoothing: Passes | PaperFilter) -> tuple[Solved, IntArray]:
    """Return the motion after all passes, and the iterations (F,) of the first solve."""
    return solve_in_passes(run, smoothing) if isinstance(smoothing, Passes) else solve_as_the_paper(run, smoothing)


def solve_in_passes(run: Run, smoothing: Passes) -> tuple[Solved, IntArray]:
    """Return the motion solved, smoothed and solved again, and the iterations (F,) of the first solve."""
    motion, first = run.motion, run.asked.body.first
    state = bent_where_missed(run, solve_frames(run, motion, reference=motion, pull_root=False))
    iterations = state.iterations.copy()
    for _ in range(smoothing.count):
        smooth = smoothed_displacement(motion, state.motion, sigma=smoothing.sigma, first=first)
        smooth = on_channels(smooth, run.asked.body.hinges)
        known = known_after(run, state, smooth)
        del state  # of a long motion no more copies are kept than are needed
        state = solve_frames(run, smooth, reference=smooth, pull_root=True, known=known)
        del smooth
    return state, iterations


def solve_as_the_paper(run: Run, smoothing: PaperFilter) -> tuple[Solved, IntArray]:
    """Solve frame by frame from eq. (4)'s start states, filter the root, and solve again with the root frozen."""
    state = solve_in_order(run)
    iterations = state.iterations.copy()
    if not smoothing.count:
        return state, iterations
    motion, first = run.motion, run.asked.body.first
    filtered = filtered_root(motion, state.motion, run.place, cutoff=smoothing.cutoff, first=first)
    state = replace(state, motion=filtered)
    # What is asked for is the same: the targets are.
    still = tuple(Recruits(each.joints, root=False) for each in run.asked.recruits)
    frozen = run_of(replace(run.asked, recruits=still)) if smoothing.count > 1 else run
    for _ in range(1, smoothing.count):
        known = known_after(frozen, state, state.motion)
        state = solve_frames(frozen, state.motion, reference=motion, pull_root=False, known=known)
    return state, iterations
