"""Which constraints a missed one gave way to: those without which it would be nearer, its worst frame solved again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.priorities.frames import run_of, solve_frames
from motionedit.core.priorities.targets import errors_of
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import ConstraintErrors

# Nearer is nearer by this share of the error, and by this many metres or radians: less is rounding, or no help.
_SHARE = 0.1
_LEAST = 1e-4


@dataclass(frozen=True, eq=False)
class Blame:
    """Why a constraint is missed at a frame.

    Attributes
    ----------
    by : tuple of int
        The constraints without which it would be nearer; none: no other stands in its way.
    left : ConstraintErrors
        What is left of it where that frame is solved by itself, with all constraints, and not smoothed.
    """

    by: tuple[int, ...]
    left: ConstraintErrors


def blame_of(asked: Asked, i: int, frame: int) -> Blame:
    """Return why constraint `i` of an edit is missed at a frame at which it is active.

    The frame is solved again as often as there are constraints of the same or a higher priority that move the same
    joints there, each time without one of them. Where it takes more than one away to help, all of them are to blame.
    """
    here = _at(asked, frame)
    everything = [k for k, each in enumerate(asked.targets) if each.first <= frame <= each.last]
    rivals = [k for k in everything if _is_rival(asked, k, i)]
    left = _left(here, everything, i)
    with_all = float(left.largest.max())

    def helps(gone: Sequence[int]) -> bool:
        without = float(_left(here, [k for k in everything if k not in gone], i).largest.max())
        return with_all - without > max(_LEAST, _SHARE * with_all)

    if not rivals or not helps(rivals):
        return Blame((), left)
    if len(rivals) == 1:
        return Blame(tuple(rivals), left)
    return Blame(tuple(k for k in rivals if helps([k])) or tuple(rivals), left)


def _is_rival(asked: Asked, other: int, i: int) -> bool:
    mine, theirs = asked.recruits[i], asked.recruits[other]
    return (
        other != i
        and asked.constraints[other].priority >= asked.constraints[i].priority
        and bool((theirs.joints & mine.joints) or (theirs.root and mine.root))
    )


def _at(asked: Asked, frame: int) -> Asked:
    """Return what is asked of a motion that is one of its frames alone."""
    span = slice(frame, frame + 1)
    # Targets that do not have the frame are not asked for: they stay as they are.
    targets = tuple(
        each.within(span).since(frame) if each.first <= frame <= each.last else each for each in asked.targets
    )
    none, no_ramps = (None,) * len(targets), ((),) * len(targets)
    return replace(asked, motion=asked.motion.at(span), targets=targets, arcs=none, ramps=no_ramps)


def _left(here: Asked, keep: Sequence[int], i: int) -> ConstraintErrors:
    """Return what is left of a constraint where some of them are asked for in a motion of one frame."""
    asked = here.only(keep)
    solved = solve_frames(run_of(asked), here.motion, reference=here.motion, pull_root=False)
    return errors_of(asked, solved.motion)[list(keep).index(i)]
