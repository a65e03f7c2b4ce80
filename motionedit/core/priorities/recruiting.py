"""Recruiting: which joints a constraint may move, and what keeps lower layers out of higher ones ([PRIO] 4.1)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Literal, NamedTuple

from motionedit.core.body.bones import below
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from motionedit.core.skeleton import Skeleton


@dataclass(frozen=True)
class RecruitRule:
    """What the user asks for: ``all``, ``up_to`` a joint, so many ``levels``, or these ``joints`` (and the `root`)."""

    kind: Literal["all", "up_to", "levels", "joints"] = "all"
    joint: int | None = None
    levels: int | None = None
    joints: tuple[int, ...] = ()
    root: bool = False


EVERYTHING = RecruitRule()


class Recruits(NamedTuple):
    """The joints that a constraint may turn, and whether it may move the root's translation.

    A tuple: what depends on it is looked up by it dozens of times a clip.
    """

    joints: frozenset[int]
    root: bool


@dataclass(frozen=True)
class Reach:
    """What moves a constraint's task: `joints`, and whether the root's translation does; active `first` to `last`."""

    joints: frozenset[int]
    root: bool
    first: int
    last: int


class NotOnTheWayError(ValueError):
    """A recruiting rule goes up to a `joint` that is not on the `way` from the effector to the root."""

    def __init__(self, joint: int, way: frozenset[int]) -> None:
        super().__init__("is not between the effector and the root")
        self.joint, self.way = joint, way


def start_of(skeleton: Skeleton, joint: int, *, itself: bool) -> int:
    """Return where recruiting for a point of a joint starts: at the joint, where that moves it, else at its parent."""
    return joint if itself else max(int(skeleton.parents[joint]), 0)


@lru_cache(maxsize=256)
def recruit_chain(skeleton: Skeleton, rule: RecruitRule, *, start: int, travel: int) -> Recruits:
    """Return what a constraint on an effector recruits: the same for all clips that share a skeleton.

    Parameters
    ----------
    start : int
        Where recruiting starts, `start_of` the effector.
    travel : int
        The joint that carries the travel. A static root above it is never recruited.

    Raises
    ------
    NotOnTheWayError
        If `up_to` is not on the way from the start to the root.
    """
    carried = below(skeleton, travel)
    chain = [int(j) for j in skeleton.chain(start)[::-1] if carried[j]]
    if rule.kind == "joints":
        return Recruits(frozenset(j for j in rule.joints if carried[j]), rule.root)
    if rule.kind == "levels":
        return Recruits(frozenset(chain[: rule.levels]), root=False)
    if rule.kind == "up_to":
        if rule.joint not in chain:
            raise NotOnTheWayError(-1 if rule.joint is None else rule.joint, frozenset(chain))
        return Recruits(frozenset(chain[: chain.index(rule.joint) + 1]), root=False)
    return Recruits(frozenset(chain), root=True)


def recruit_chains(skeleton: Skeleton, rule: RecruitRule, *, starts: Iterable[int], travel: int) -> Recruits:
    """Return what a constraint on several points recruits: the chains of all, as `recruit_chain`.

    An `up_to` is on the way of one of them at least; those that it is not on are left out.

    Raises
    ------
    NotOnTheWayError
        If `up_to` is on the way of none.
    """
    chains: list[Recruits] = []
    missed: list[NotOnTheWayError] = []
    for start in starts:
        try:
            chains.append(recruit_chain(skeleton, rule, start=start, travel=travel))
        except NotOnTheWayError as error:
            missed.append(error)
    if missed and not chains:
        raise NotOnTheWayError(missed[0].joint, frozenset().union(*(error.way for error in missed)))
    return Recruits(frozenset().union(*(each.joints for each in chains)), any(each.root for each in chains))


def recruit_body(rule: RecruitRule, body: Collection[int]) -> Recruits:
    """Return what a constraint on the CoM recruits: every joint that carries mass, or the listed ones."""
    if rule.kind == "joints":
        return Recruits(frozenset(rule.joints), rule.root)
    return Recruits(frozenset(body), root=True)


@dataclass(frozen=True)
class Breach:
    """A lower constraint's joints that move a higher one, which does not recruit them; indices of the two."""

    higher: int
    lower: int
    joints: frozenset[int]
    root: bool


def breaches(priorities: Sequence[int], recruits: Sequence[Recruits], reaches: Sequence[Reach]) -> list[Breach]:
    """Return every breach of the recruiting rule.

    Eq. (2) as printed compares the recruited sets alone and is neither sufficient nor necessary. What makes layers
    strict is this: joints of the lower set that physically move the higher task must be in the higher set, too, where
    both are active at some frame.
    """
    found = []
    for a, (priority, mine, reach) in enumerate(zip(priorities, recruits, reaches, strict=True)):
        for b, (other, theirs, span) in enumerate(zip(priorities, recruits, reaches, strict=True)):
            if a == b or other > priority or span.last < reach.first or reach.last < span.first:
                continue
            joints = (theirs.joints & reach.joints) - mine.joints
            root = theirs.root and reach.root and not mine.root
            if joints or root:
                found.append(Breach(a, b, joints, root))
    return found


def expanded(
    priorities: Sequence[int], recruits: Sequence[Recruits], reaches: Sequence[Reach]
) -> tuple[list[Recruits], list[Breach]]:
    """Return the sets widened until no breach is left, and the breaches that were mended."""
    sets, mended = list(recruits), []
    while found := breaches(priorities, sets, reaches):
        for breach in found:
            mine = sets[breach.higher]
            sets[breach.higher] = Recruits(mine.joints | breach.joints, mine.root or breach.root)
        mended += found
    return sets, mended
