"""The anatomy of a skeleton: legs, arms, head, leg length and height, found by the tree and not by names."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.body.limbs import LimbPair, Tree, find_limb_pairs
from motionedit.core.body.sides import leg_or_arm, side_of_chains, side_of_toes
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.skeleton import Skeleton

# A joint as near to its parent as this, in heights, is at the same place.
_SAME_PLACE = 1e-3
# The share of the way from ankle to tip at which the toe bends, at the least (a metatarsal ends before it).
_BALL_OF_FOOT = 0.5
_END_WORDS = ("end", "top", "nub", "site", "tip")


@dataclass(frozen=True)
class Leg:
    """The joints of a leg; `toe` is None where the ankle has no joint below it."""

    thigh: int
    knee: int
    ankle: int
    toe: int | None


@dataclass(frozen=True)
class Arm:
    """The joints of an arm; `clavicle` is None where the shoulder hangs on the spine."""

    clavicle: int | None
    shoulder: int
    elbow: int
    wrist: int


@dataclass(frozen=True)
class Anatomy:
    """What a skeleton's joints are; None where it has no such thing.

    Attributes
    ----------
    legs, arms : left, right
    head : int or None
        The joint at the base of the skull.
    pelvis, chest : int or None
        The joints on which the legs and the arms hang.
    digits : frozenset of int
        Wrists, hands, fingers, toes, and what hangs on the head: joints whose jumps do not make a rest pose.
    leg_length : float
        Thigh to ankle, the sum of |OFFSET|, mean of both sides, clip units; half the height where there are no legs.
    height : float
        The longest path between two ends, by |OFFSET|, clip units.
    warnings : tuple of str
        What was not found, each a line for the user.
    """

    legs: tuple[Leg, Leg] | None
    arms: tuple[Arm, Arm] | None
    head: int | None
    pelvis: int | None
    chest: int | None
    digits: frozenset[int]
    leg_length: float
    height: float
    warnings: tuple[str, ...]

    @property
    def foot_points(self) -> tuple[tuple[str, int], ...]:
        """Ankles and toes with their side, ``("left", joint)``; empty without legs."""
        if self.legs is None:
            return ()
        return tuple(
            (side, joint)
            for side, leg in zip(("left", "right"), self.legs, strict=True)
            for joint in (leg.ankle, leg.toe)
            if joint is not None
        )


def find_anatomy(skeleton: Skeleton, *, poses: WorldPoses | None = None) -> Anatomy:
    """Return the anatomy of a skeleton; what it lacks is None and a warning, never an error.

    Legs and arms are the two longest pairs of branches with two like bones each. Names say which side is left; where
    they do not, the toes do, in `poses` if given, else in the skeleton's zero pose.
    """
    tree = Tree(skeleton)
    warnings: list[str] = []
    legs_pair, arms_pair = _legs_and_arms(tree, find_limb_pairs(skeleton)[:2])
    head, head_way = _find_head(tree, legs_pair, arms_pair)
    if legs_pair is not None or arms_pair is not None:
        places = tree.places[None] if poses is None else poses.positions
        legs_pair, arms_pair, sure = _left_first(tree, legs_pair, arms_pair, head, places)
        if not sure:
            warnings.append("neither names nor toes tell left from right; the order in the file is taken")
    if legs_pair is None:
        warnings.append("no legs found: half the height stands for the leg length")
    legs = None if legs_pair is None else _legs(tree, legs_pair)
    arms = None if arms_pair is None else _arms(arms_pair)
    return Anatomy(
        legs=legs,
        arms=arms,
        head=head,
        pelvis=None if legs_pair is None else legs_pair.base,
        chest=None if arms_pair is None else arms_pair.base,
        digits=_digits(tree, legs, arms, head_way),
        leg_length=0.5 * tree.height if legs_pair is None else legs_pair.length,
        height=tree.height,
        warnings=tuple(warnings),
    )


def _legs_and_arms(tree: Tree, pairs: tuple[LimbPair, ...]) -> tuple[LimbPair | None, LimbPair | None]:
    """Tell legs from arms: the head hangs where the arms do, the root is nearer to the legs.

    Where these two contradict each other (a tail, a root in the chest) or there is one pair alone, names decide.
    """
    if not pairs:
        return None, None
    names = tree.skeleton.names
    if len(pairs) == 1:
        is_arm = leg_or_arm(names, pairs[0].chains[0]) < 0
        return (None, pairs[0]) if is_arm else (pairs[0], None)
    first, second = pairs
    depth = len(tree.skeleton.chain(second.base)) - len(tree.skeleton.chain(first.base))
    by_head = _signed(_neck_length(tree, second, first) - _neck_length(tree, first, second), tree)
    vote = int(np.sign(depth)) + by_head
    if vote == 0:
        words = leg_or_arm(names, first.chains[0]) - leg_or_arm(names, second.chains[0])
        vote = words or depth or 1
    return (first, second) if vote > 0 else (second, first)


def _signed(length: float, tree: Tree) -> int:
    return 0 if abs(length) < _SAME_PLACE * tree.height else int(np.sign(length))


def _neck_length(tree: Tree, pair: LimbPair, other: LimbPair | None) -> float:
    return max((float(tree.lengths[c] + tree.reach[c]) for c in _neck_candidates(tree, pair, other)), default=0.0)


def _neck_candidates(tree: Tree, pair: LimbPair, other: LimbPair | None) -> list[int]:
    """Return the children of a pair's base that are neither its limbs nor on the way to the other pair."""
    way = set() if other is None else set(tree.skeleton.chain(other.base).tolist())
    limbs = {pair.chains[0][0], pair.chains[1][0]}
    children = tree.skeleton.children[pair.base]
    return [c for c in children if c not in limbs and c not in way]


def _find_head(tree: Tree, legs: LimbPair | None, arms: LimbPair | None) -> tuple[int | None, list[int]]:
    """Return the head and the way from it to the farthest end: the chain beside the arms, else the longest one."""
    carrier = arms or legs
    if carrier is None:
        return None, []
    candidates = _neck_candidates(tree, carrier, legs if arms is not None else None)
    candidates = [c for c in candidates if not _is_paired(tree, c, candidates)] or candidates
    if not candidates:
        return None, []
    way = tree.longest_way(max(candidates, key=lambda c: (tree.lengths[c] + tree.reach[c], -c)))
    children, names = tree.skeleton.children, tree.skeleton.names
    at = next((i for i, j in enumerate(way) if len(children[j]) > 1), len(way) - 1)
    while (
        at > 0
        and len(children[way[at - 1]]) == 1
        and (
            tree.lengths[way[at]] < _SAME_PLACE * tree.height
            or (not children[way[at]] and names[way[at]].casefold().endswith(_END_WORDS))
        )
    ):
        at -= 1
    return way[at], way[at:]


def _is_paired(tree: Tree, joint: int, joints: list[int]) -> bool:
    """Tell whether a branch has a twin beside it by name: breasts and ribs are no necks."""
    names = tree.skeleton.names
    return any(side_of_chains(names, ((joint,), (other,))) for other in joints if other != joint)


def _left_first(
    tree: Tree, legs: LimbPair | None, arms: LimbPair | None, head: int | None, positions: FloatArray
) -> tuple[LimbPair | None, LimbPair | None, bool]:
    """Return legs and arms with the left one first, and whether anything said which it is."""
    names = tree.skeleton.names
    sides = {id(pair): side_of_chains(names, pair.chains) for pair in (legs, arms) if pair is not None}
    known = next((pair for pair in (legs, arms) if pair is not None and sides[id(pair)]), None)
    if known is None and legs is not None:
        sides[id(legs)] = _side_by_toes(tree, legs, head, positions)
        known = legs if sides[id(legs)] else None
    if known is None:
        return legs, arms, False
    left = _across(known, positions) * sides[id(known)]

    def ordered(pair: LimbPair | None) -> LimbPair | None:
        if pair is None:
            return None
        side = sides[id(pair)] or float(median(np.sum(_across(pair, positions) * left, axis=-1)))
        return pair.swapped() if side < 0 else pair

    return ordered(legs), ordered(arms), True


def _across(pair: LimbPair, positions: FloatArray) -> FloatArray:
    """Return the vectors from the second limb's top to the first's, shape (F, 3)."""
    across: FloatArray = positions[:, pair.triples[0].top] - positions[:, pair.triples[1].top]
    return across


def _side_by_toes(tree: Tree, legs: LimbPair, head: int | None, positions: FloatArray) -> int:
    ankles = [triple.end for triple in legs.triples]
    toes = [_toe(tree, chain, ankle) for chain, ankle in zip(legs.chains, ankles, strict=True)]
    if head is None or None in toes:
        return 0
    feet = positions[:, ankles].mean(axis=1)
    forward = positions[:, [t for t in toes if t is not None]].mean(axis=1) - feet
    return side_of_toes(across=_across(legs, positions), up=positions[:, head] - feet, toes=forward)


def _toe(tree: Tree, chain: tuple[int, ...], ankle: int) -> int | None:
    """Return the joint at the ball of the foot: the first one half-way or more from the ankle to the tip."""
    below = chain[chain.index(ankle) + 1 :]
    if not below:
        children = tree.skeleton.children[ankle]
        return tree.longest_way(ankle)[1] if children else None
    way = 0.0
    for joint in below:
        way += float(tree.lengths[joint])
        if way >= _BALL_OF_FOOT * (way + float(tree.reach[joint])):
            return joint
    return below[-1]


def _legs(tree: Tree, pair: LimbPair) -> tuple[Leg, Leg]:
    left, right = (
        Leg(*triple, _toe(tree, chain, triple.end)) for chain, triple in zip(pair.chains, pair.triples, strict=True)
    )
    return left, right


def _arms(pair: LimbPair) -> tuple[Arm, Arm]:
    left, right = (
        Arm(chain[0] if chain[0] != triple.top else None, *triple)
        for chain, triple in zip(pair.chains, pair.triples, strict=True)
    )
    return left, right


def _digits(
    tree: Tree, legs: tuple[Leg, Leg] | None, arms: tuple[Arm, Arm] | None, head_way: list[int]
) -> frozenset[int]:
    digits: set[int] = set()
    for arm in arms or ():
        digits |= tree.below(arm.wrist)
    for leg in legs or ():
        digits |= tree.below(leg.ankle) - {leg.ankle}
    if head_way:
        digits |= tree.below(head_way[0]) - {head_way[0]}
    return frozenset(digits)
