"""Finding the anatomy of a skeleton: legs, arms, head, leg length and height, by lengths and names together."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.body.anatomy import NOTHING_GIVEN, Anatomy, Arm, GivenBody, Leg, tip_of
from motionedit.core.body.bones import bones_of, travel_joint
from motionedit.core.body.head import SAME_PLACE, find_head
from motionedit.core.body.legs_and_arms import find_legs_and_arms
from motionedit.core.body.limbs import LimbPair, Triple
from motionedit.core.body.sides import side_of_chains, side_of_toes
from motionedit.core.body.tree import Tree
from motionedit.core.body.words import is_end, is_toe
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton

# The share of the way from ankle to tip at which the toe bends, at the least (a metatarsal ends before it).
_BALL_OF_FOOT = 0.42

_NO_LEGS = "no legs found: half the height stands for the leg length; body: in a spec says which joints are the legs"
_NO_SIDES = "neither names nor toes tell left from right: the file's order is taken; body: in a spec says which is left"


def find_anatomy(skeleton: Skeleton, *, poses: WorldPoses | None = None, given: GivenBody = NOTHING_GIVEN) -> Anatomy:
    """Return the anatomy of a skeleton; what it lacks is None and a warning, never an error.

    Legs and arms are pairs of branches with two bones each, left and right of each other by name or alike in length;
    of several, those that are called so, else the two longest. Names say which side is left; where they do not, the
    toes do, in `poses` if given, else in the skeleton's zero pose.
    """
    known = _by_names(skeleton, given)
    return _anatomy(_parts(skeleton, given), poses) if known is None else known


@dataclass(frozen=True, eq=False)
class _Parts:
    """What the tree and the names of a skeleton tell; its legs and arms are not yet left and right."""

    tree: Tree
    given: GivenBody
    legs: LimbPair | None
    arms: LimbPair | None
    head: int | None
    head_way: list[int]

    def side(self, pair: LimbPair) -> int:
        """Return +1 where the first limb of a pair is known to be the left one, -1 the right, 0 where it is not."""
        is_given = bool(self.given.legs if pair is self.legs else self.given.arms)
        return 1 if is_given else side_of_chains(self.tree.skeleton.names, pair.chains)


@lru_cache(maxsize=4)
def _parts(skeleton: Skeleton, given: GivenBody) -> _Parts:
    tree = Tree(skeleton)
    legs, arms = find_legs_and_arms(tree)
    legs = legs if given.legs is None else _given_pair(tree, given.legs, top=0)
    arms = arms if given.arms is None else _given_pair(tree, given.arms, top=-3)
    head, head_way = find_head(tree, legs, arms)
    if given.head is not None:
        head, head_way = (given.head, tree.longest_way(given.head)) if given.head >= 0 else (None, [])
    return _Parts(tree, given, legs, arms, head, head_way)


@lru_cache(maxsize=4)
def _by_names(skeleton: Skeleton, given: GivenBody) -> Anatomy | None:
    """Return the anatomy where names alone tell left from right, as in most files; None where poses must."""
    parts = _parts(skeleton, given)
    if all(parts.side(pair) for pair in (parts.legs, parts.arms) if pair is not None):
        return _anatomy(parts, None)
    return None


def _anatomy(parts: _Parts, poses: WorldPoses | None) -> Anatomy:
    tree, given, warnings = parts.tree, parts.given, []
    places = tree.places[None] if poses is None else poses.positions
    legs_pair, arms_pair, sure = _left_first(parts, places)
    if not sure:
        warnings.append(_NO_SIDES)
    if legs_pair is None:
        warnings.append(_NO_LEGS)
    legs = None if legs_pair is None else _legs(tree, legs_pair, given.legs)
    arms = None if arms_pair is None else _arms(tree, arms_pair, given.arms)
    return Anatomy(
        legs=legs,
        arms=arms,
        head=parts.head,
        pelvis=None if legs_pair is None else legs_pair.base,
        chest=None if arms_pair is None else arms_pair.base,
        digits=_digits(tree, legs, arms, parts.head_way),
        leg_length=0.5 * tree.height if legs_pair is None else legs_pair.length,
        height=tree.height,
        warnings=tuple(warnings),
    )


def anatomy_of(motion: Motion, *, given: GivenBody = NOTHING_GIVEN) -> Anatomy:
    """Return the anatomy of a motion's bones, which side is left by names and the zero pose."""
    return find_anatomy(bones_of(motion, travel_joint(motion)), given=given)


def _given_pair(tree: Tree, limbs: tuple[tuple[int, ...], ...], *, top: int) -> LimbPair | None:
    """Return the pair of given limbs, whose three joints that bend begin at place `top`; None where there are none."""
    if not limbs:
        return None
    ways = [tree.skeleton.chain(limb[-1]).tolist() for limb in limbs]
    base = max(set(ways[0]) & set(ways[1]))
    left, right = (tuple(tree.skeleton.between(base, limb[-1])) for limb in limbs)
    triples = tuple(Triple(*limb[top:][:3]) for limb in limbs)
    lengths = [_way(tree, triple.top, triple.end) for triple in triples]
    return LimbPair(base, (left, right), (triples[0], triples[1]), 0.5 * sum(lengths))


def _left_first(parts: _Parts, positions: FloatArray) -> tuple[LimbPair | None, LimbPair | None, bool]:
    """Return legs and arms with the left one first, and whether anything said which it is."""
    legs, arms = parts.legs, parts.arms
    if legs is None and arms is None:
        return None, None, True
    sides = {id(pair): parts.side(pair) for pair in (legs, arms) if pair is not None}
    known = next((pair for pair in (legs, arms) if pair is not None and sides[id(pair)]), None)
    if known is None and legs is not None:
        sides[id(legs)] = _side_by_toes(parts.tree, legs, parts.head, positions)
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
    """Return the joint at the ball of the foot: what is called toe, else the first one far enough to the tip."""
    below = [j for j in chain[chain.index(ankle) + 1 :] if j not in tree.hanging]
    if not below:
        below = [j for j in tree.longest_way(ankle)[1:] if j not in tree.hanging][:1]
    names = tree.names
    below = [j for j in below if not is_end(names[j])] or below[:1]
    below = [j for j in below if is_toe(names[j])] or below
    way = 0.0
    for joint in below:
        way = _way(tree, ankle, joint)
        if way >= _BALL_OF_FOOT * (way + float(tree.reach[joint])):
            return joint
    return below[-1] if below else None


def _way(tree: Tree, top: int, joint: int) -> float:
    return float(tree.lengths[tree.skeleton.between(top, joint)].sum())


def _legs(tree: Tree, pair: LimbPair, given: tuple[tuple[int, ...], ...] | None) -> tuple[Leg, Leg]:
    if given:
        left, right = (_leg(tree, Triple(*limb[:3]), limb[3] if len(limb) > 3 else None) for limb in given)
        return left, right
    pieces = zip(pair.chains, pair.triples, strict=True)
    left, right = (_leg(tree, triple, _toe(tree, chain, triple.end)) for chain, triple in pieces)
    return left, right


def _leg(tree: Tree, triple: Triple, toe: int | None) -> Leg:
    return Leg(*triple, toe, tip_of(tree.skeleton, triple.end) if toe is None else None)


def _arms(tree: Tree, pair: LimbPair, given: tuple[tuple[int, ...], ...] | None) -> tuple[Arm, Arm]:
    if given:
        left, right = (Arm(limb[0] if len(limb) > 3 else None, *limb[-3:]) for limb in given)
        return left, right
    pieces = zip(pair.chains, pair.triples, strict=True)
    left, right = (Arm(_clavicle(tree, chain, triple.top), *triple) for chain, triple in pieces)
    return left, right


def _clavicle(tree: Tree, chain: tuple[int, ...], shoulder: int) -> int | None:
    """Return the first joint of a chain above the shoulder that does not only stand where the next one does."""
    above = chain[: chain.index(shoulder)]
    moving = (j for j, lower in zip(above, chain[1:], strict=False) if tree.lengths[lower] > SAME_PLACE * tree.height)
    return next(moving, above[0] if above else None)


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
