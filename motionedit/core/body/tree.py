"""A skeleton's tree: the lengths of its bones and ways, and how far two branches of it are alike."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.body.bones import hanging
from motionedit.core.body.sides import side_of_names
from motionedit.core.body.words import bare_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.skeleton import Skeleton

# Captured bones differ between left and right (CMU's hips by 11 %); a spine differs from a leg by far more.
_LENGTH_TOLERANCE = 0.3
_NAMED_TOLERANCE = 0.7  # where names are left and right of each other: bones read off one frame of a video are 1 to 2
_LENGTH_FLOOR = 0.02  # of the height: below it any two bones are alike
# Branches of one joint beyond which only the longest are looked at: pairs of them are compared, and no body has more.
_MOST_BRANCHES = 48
_LONGEST_CHAIN = 24  # joints: longer ones are ropes and tails, and every three joints of a chain are tried
_STRAIGHT = 0.85  # cosine between the bones on both sides of a joint


class Match(NamedTuple):
    """How far two branches are alike: bone length matched in all, and along the longest chain; that chain's joints."""

    total: float
    longest: float
    chain: tuple[tuple[int, int], ...]


_NO_MATCH = Match(0.0, 0.0, ())


class Tree:
    """Lengths and paths in a skeleton's tree; all lengths in clip units, by |OFFSET|."""

    def __init__(self, skeleton: Skeleton) -> None:
        self.skeleton = skeleton
        self.names = bare_names(skeleton.names)
        self.lengths: FloatArray = np.linalg.norm(skeleton.offsets, axis=-1)
        self._ends: dict[int, float] = {}
        for site in skeleton.end_sites:
            self._ends[site.joint] = max(self._ends.get(site.joint, 0.0), float(np.linalg.norm(site.offset)))
        self.places = zero_pose(skeleton)
        self.reach = self._reaches()
        self.height = self._height()
        self._matches: dict[tuple[int, int], Match] = {}

    @cached_property
    def hanging(self) -> frozenset[int]:
        """The joints that their names call hair, tail, prop or the like, and all that hang on them."""
        return frozenset(np.flatnonzero(hanging(self.skeleton)).tolist())

    def below(self, joint: int) -> frozenset[int]:
        """Return a joint and all its descendants."""
        found, waiting = [joint], [joint]
        while waiting:
            children = self.skeleton.children[waiting.pop()]
            found += children
            waiting += children
        return frozenset(found)

    def branches(self, joint: int) -> int:
        """Return how many bones leave a joint: its children, and its end sites together as one."""
        return len(self.skeleton.children[joint]) + (joint in self._ends)

    def foremost(self, joint: int) -> list[int]:
        """Return the branches of a joint among which limbs, or what hangs on them, are looked for, in their order."""
        children = self.skeleton.children[joint]
        if len(children) <= _MOST_BRANCHES:
            return list(children)
        longest = sorted(children, key=lambda child: (-self.lengths[child] - self.reach[child], child))
        return sorted(longest[:_MOST_BRANCHES])

    def is_bent(self, chain: Sequence[tuple[int, int]], place: int) -> bool:
        """Tell whether a pair of chains bends at one of its joints in the zero pose, on both sides."""
        if place + 1 == len(chain):
            return False
        lengths, offsets = self.lengths, self.skeleton.offsets
        pieces = zip(chain[place], chain[place + 1], strict=True)
        return all(offsets[a] @ offsets[b] < _STRAIGHT * lengths[a] * lengths[b] for a, b in pieces)

    def longest_way(self, joint: int) -> list[int]:
        """Return the joints from `joint` (in) to the farthest end below it."""
        way = [joint]
        while children := self.skeleton.children[way[-1]]:
            way.append(max(children, key=lambda c: (self.lengths[c] + self.reach[c], -c)))
        return way

    def spread(self, joints: tuple[int, ...]) -> FloatArray:
        """Return the distance from each joint to the farthest end below it in the zero pose, shape (N,).

        Not along the bones: fingers that fan out from one point of the palm would make it longer than a forearm. What
        is called a prop, and what hangs on that, is left out.
        """
        below = [sorted(self.below(j) - self.hanging) for j in joints]
        return np.array(
            [
                max(
                    (np.linalg.norm(self.places[d] - self.places[j]) + self._ends.get(d, 0.0) for d in down),
                    default=0.0,
                )
                for j, down in zip(joints, below, strict=True)
            ]
        )

    def match(self, a: int, b: int, *, level: int = 1) -> Match:
        """Return how far two branches are alike, nothing where their first bones already differ.

        What only one side has, such as a club in one hand, is left out.
        """
        if (a, b) not in self._matches:
            self._matches[a, b] = self._match(a, b, level)
        return self._matches[a, b]

    def _match(self, a: int, b: int, level: int) -> Match:
        la, lb = float(self.lengths[a]), float(self.lengths[b])
        names = self.skeleton.names
        tolerance = _NAMED_TOLERANCE if side_of_names(names[a], names[b]) else _LENGTH_TOLERANCE
        if abs(la - lb) > tolerance * max(la, lb) + _LENGTH_FLOOR * self.height:
            return _NO_MATCH
        total, longest = 0.0, 0.0
        chain: tuple[tuple[int, int], ...] = ((a, b),)
        used: set[int] = set()
        for c, d, below in self._options(a, b, level):
            if below.chain and c not in used and d not in used:
                used |= {c, d}
                total += below.total
                if below.longest > longest or len(chain) == 1:
                    longest, chain = below.longest, ((a, b), *below.chain)
        mean = 0.5 * (la + lb)
        return Match(mean + total, mean + longest, chain)

    def _options(self, a: int, b: int, level: int) -> list[tuple[int, int, Match]]:
        """Return the pairs of children of two joints, the likeliest first; names settle which toe is which."""
        if level == _LONGEST_CHAIN:
            return []
        names = self.skeleton.names
        mine, theirs = self.foremost(a), self.foremost(b)
        options = [(c, d, self.match(c, d, level=level + 1)) for c in mine for d in theirs]
        return sorted(options, key=lambda o: (side_of_names(names[o[0]], names[o[1]]) == 0, -o[2].total, o[0], o[1]))

    def _reaches(self) -> FloatArray:
        """Return the length of the longest way from each joint down to an end, shape (J,)."""
        reach = np.zeros(len(self.skeleton))
        for j in range(len(self.skeleton) - 1, -1, -1):
            below = [self.lengths[c] + reach[c] for c in self.skeleton.children[j]]
            reach[j] = max([*below, self._ends.get(j, 0.0)])
        return reach

    def _height(self) -> float:
        """Return the longest path between two ends, or from the root where there is one end only."""
        longest = float(self.reach[0])
        for j, children in enumerate(self.skeleton.children):
            branches = [float(self.lengths[c] + self.reach[c]) for c in children]
            branches += [self._ends[j]] if j in self._ends else []
            if len(branches) > 1:
                longest = max(longest, sum(sorted(branches)[-2:]))
        return longest


def zero_pose(skeleton: Skeleton) -> FloatArray:
    """Return the positions of all joints with every rotation zero, by OFFSET alone, shape (J, 3), clip units."""
    positions = skeleton.offsets.copy()
    for j in range(1, len(skeleton)):
        positions[j] += positions[skeleton.parents[j]]
    return positions
