"""Which constraints a missed one gave way to: those without which it would be nearer, its worst frame solved again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.priorities.frames import run_of, solve_frames
from motionedit.core.priorities.targets import errors_of
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Callable

    from motionedit.core.priorities.groups import Asked
    from motionedit.core.priorities.kinds.constraint import ConstraintErrors

    Places = tuple[int, ...]

# Nearer is nearer by this share of the error, and by this many metres or radians: less is rounding, or no help.
_SHARE = 0.1
_LEAST = 1e-4
# So many are tried one by one.
_ONE_BY_ONE = 8


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


class Blames:
    """Why constraints of an edit are missed: frames are solved again, each time without some that are active there."""

    def __init__(self, asked: Asked) -> None:
        self._asked = asked
        self._solved: dict[tuple[int, Places], tuple[ConstraintErrors, ...]] = {}

    def of(self, i: int, frame: int) -> Blame:
        """Return why constraint `i` is missed at a frame at which it is active.

        The others are those of the same or a higher priority that move the same joints there. Where it takes more than
        one away to help, all of them are to blame.
        """
        everything = tuple(k for k, each in enumerate(self._asked.targets) if each.first <= frame <= each.last)
        rivals = tuple(k for k in everything if _is_rival(self._asked, k, i))
        left = self._left(everything, frame, i)
        with_all = float(left.largest.max())

        def helps(gone: Places) -> bool:
            left = self._left(tuple(k for k in everything if k not in gone), frame, i)
            return with_all - float(left.largest.max()) > max(_LEAST, _SHARE * with_all)

        return Blame(_to_blame(rivals, helps) if rivals and helps(rivals) else (), left)

    def _left(self, kept: Places, frame: int, i: int) -> ConstraintErrors:
        """Return what is left of a constraint at a frame where some alone are asked for."""
        if (frame, kept) not in self._solved:
            self._solved[frame, kept] = _errors(_at(self._asked.only(kept), frame))
        return self._solved[frame, kept][kept.index(i)]


def _to_blame(rivals: Places, helps: Callable[[Places], bool]) -> Places:
    """Return those of some whose absence helps that help by themselves, many tried half by half; else all of them."""
    if len(rivals) == 1:
        return rivals
    middle = len(rivals) // 2
    halves = (rivals[:middle], rivals[middle:])
    parts = halves if len(rivals) > _ONE_BY_ONE else tuple((k,) for k in rivals)
    found = [_to_blame(part, helps) for part in parts if helps(part)]
    return tuple(k for part in found for k in part) or rivals


def _is_rival(asked: Asked, other: int, i: int) -> bool:
    mine, theirs = asked.recruits[i], asked.recruits[other]
    return (
        other != i
        and asked.constraints[other].priority >= asked.constraints[i].priority
        and bool((theirs.joints & mine.joints) or (theirs.root and mine.root))
    )


def _at(asked: Asked, frame: int) -> Asked:
    """Return what is asked of a motion that is one of its frames alone, at which all of it is asked."""
    span = slice(frame, frame + 1)
    targets = tuple(each.within(span).since(frame) for each in asked.targets)
    none, no_ramps = (None,) * len(targets), ((),) * len(targets)
    return replace(asked, motion=asked.motion.at(span), targets=targets, arcs=none, ramps=no_ramps)


def _errors(asked: Asked) -> tuple[ConstraintErrors, ...]:
    """Return what is left of constraints in a motion of one frame."""
    solved = solve_frames(run_of(asked), asked.motion, reference=asked.motion, pull_root=False)
    return errors_of(asked, solved.motion)
