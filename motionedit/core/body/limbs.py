"""Pairs of limbs found in a skeleton's tree: two branches of one joint, alike in length or in name.

Lengths and the tree say what could be a limb, names decide where several could: names alone mislead (a thigh is called
LeftHip, a toe LeftFoot), and so do lengths (hair, wings and skirts hang in pairs, too).
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.body.sides import side_of_chains
from motionedit.core.body.words import is_hand_or_foot, is_twist, leg_or_arm
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.tree import Tree

_SHORTEST_LIMB = 0.1  # of the height: fingers and faces come in pairs too
_RATIO_LIMIT = 2.5  # upper to lower bone; CMU's upper arm is up to 1.9 forearms
# Costs against |log(upper / lower)|. A bone is taken as cut in pieces only where that explains the limb, and hardly
# ever at a joint that branches or that is bent in the zero pose: that one is a hand or a foot.
_COST_OF_A_CUT = 0.15
_COST_OF_AN_ODD_CUT = 0.6
_COST_ABOVE = 0.1  # per mean bone of length from the chain's first joint to the limb
_COST_BELOW = 0.2  # per mean bone from the limb to the farthest end
_COST_OF_ONE_PLACE = 1.0  # where both limbs would start at the same place, as CMU's hip joints and collars do
# Mean bones between the tops of two limbs in the zero pose: collars start at one place, and hips are 0.35 apart.
_AT_ONE_PLACE, _APART = 0.25, 0.38
_LONGEST_ABOVE = 1.5  # mean bones: a collar may be in two pieces
_LONGEST_BELOW = 1.2  # mean bones: a hand is 0.85 forearms
_COST_OF_ANOTHER_END = 1.0  # where the limb would not end at the joint that is called hand or foot
_COST_OF_A_TWIST = 1.0  # for each joint called twist or roll that would be a top, a bend or an end


class Triple(NamedTuple):
    """The joints at the top, bend and end of a limb: thigh, knee, ankle or shoulder, elbow, wrist."""

    top: int
    bend: int
    end: int


@dataclass(frozen=True)
class LimbPair:
    """Two limbs that hang on joint `base`: their chains of matched joints, and the three joints that bend.

    `length` is the mean of both, top to end, clip units; `names` is above 0 where names speak of legs, below of arms.
    """

    base: int
    chains: tuple[tuple[int, ...], tuple[int, ...]]
    triples: tuple[Triple, Triple]
    length: float
    names: int = 0

    def swapped(self) -> LimbPair:
        """Return the same pair in the other order."""
        return LimbPair(self.base, self.chains[::-1], self.triples[::-1], self.length, self.names)


def find_limb_pairs(tree: Tree) -> tuple[LimbPair, ...]:
    """Return the pairs of limbs, the likeliest first, none inside another; empty where there are none.

    The likeliest are those whose names speak of legs or arms, then the longest. Where the names of some limbs are left
    and right of each other, those whose names are not are none: a tail and a spine beside two legs.
    """
    skeleton = tree.skeleton
    found = [
        pair
        for base in range(len(skeleton))
        for a, b in combinations(tree.foremost(base), 2)
        if (pair := _limb_pair(tree, base, (a, b))) is not None
    ]
    mirrored = [pair for pair in found if side_of_chains(skeleton.names, pair.chains)]
    kept: list[LimbPair] = []
    taken: set[int] = set()
    for pair in sorted(mirrored or found, key=lambda pair: (pair.names == 0, -pair.length)):
        joints = tree.below(pair.chains[0][0]) | tree.below(pair.chains[1][0])
        if not joints & taken:
            kept.append(pair)
            taken |= joints
    return tuple(kept)


def _limb_pair(tree: Tree, base: int, first: tuple[int, int]) -> LimbPair | None:
    names = tree.names
    chain = _without_what_hangs(tree, tree.match(*first).chain)
    if len(chain) < 3:
        return None
    chains = (tuple(a for a, _ in chain), tuple(b for _, b in chain))
    lengths = 0.5 * (tree.lengths[list(chains[0])] + tree.lengths[list(chains[1])])
    # What hangs below each joint, on the side where less does: a club in one hand is no hand.
    rest = np.minimum(tree.spread(chains[0]), tree.spread(chains[1]))
    odd = np.array([tree.is_bent(chain, i) or min(map(tree.branches, chain[i])) > 1 for i in range(len(chain))])
    twist = np.array([is_twist(names[a]) for a in chains[0]])
    called_end = next((i for i, (a, _) in enumerate(chain) if is_hand_or_foot(names[a])), None)
    at = np.cumsum(lengths) - lengths[0]
    apart = _apart(tree, chains, at)
    places = _bending_joints(at, rest=rest, apart=apart, odd=odd, twist=twist, called_end=called_end)
    if places is None:
        # No limb, unless more hangs below it than a body has: props without a name.
        places = _bending_joints(at, rest=np.zeros_like(rest), apart=apart, odd=odd, twist=twist, called_end=called_end)
    if places is None:
        return None
    length = float(np.sum(lengths[places[0] + 1 : places[2] + 1]))
    triples = (Triple(*(chains[0][i] for i in places)), Triple(*(chains[1][i] for i in places)))
    words = sum(leg_or_arm(names, triple) for triple in triples)
    if not words and length < _SHORTEST_LIMB * tree.height:
        return None
    return LimbPair(base, chains, triples, length, words)


def _apart(tree: Tree, chains: tuple[tuple[int, ...], tuple[int, ...]], at: FloatArray) -> FloatArray:
    """Return how far each joint of a chain is from its twin, shape (N,); `at` is the length from the first one.

    The first joints have one parent, so that their distance is the same in every pose. Below them it is that of the
    zero pose, and no less than the way there: OFFSETs that all lie along their own bone put all into a heap.
    """
    distance = np.linalg.norm(tree.places[list(chains[0])] - tree.places[list(chains[1])], axis=-1)
    apart: FloatArray = np.maximum(distance, at)
    return apart


def _without_what_hangs(tree: Tree, chain: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return a chain down to where something begins that is no limb by its name; nothing where it begins so."""
    return [pair for pair in chain if tree.hanging.isdisjoint(pair)]


def _bending_joints(
    at: FloatArray,
    *,
    rest: FloatArray,
    apart: FloatArray,
    odd: BoolArray,
    twist: BoolArray,
    called_end: int | None,
) -> tuple[int, int, int] | None:
    """Return the places in a chain of a limb's top, bend and end.

    A limb has two bones of like lengths, each in one piece or cut by twist joints; what is above them in the chain
    and what is below is shorter than they are.

    Parameters
    ----------
    at : shape (N,)
        Length along the chain from its first joint.
    rest : shape (N,)
        Distance from each joint to the farthest end below it.
    apart : shape (N,)
        Distance from each joint to its twin on the other side.
    odd : shape (N,)
        Whether a joint is bent or branches, so that no bone is cut there.
    twist : shape (N,)
        Whether a joint is called twist or roll.
    called_end : int or None
        The place of the first joint that is called hand or foot.
    """
    cut_cost = np.where(odd, _COST_OF_AN_ODD_CUT, _COST_OF_A_CUT)
    best: tuple[float, tuple[int, int, int]] | None = None
    for i, j, k in combinations(range(len(at)), 3):
        upper, lower = at[j] - at[i], at[k] - at[j]
        mean = 0.5 * (upper + lower)
        if min(upper, lower) <= 0.0 or max(upper, lower) > _RATIO_LIMIT * min(upper, lower):
            continue
        below = 0.0 if k == called_end else rest[k]
        if at[i] > _LONGEST_ABOVE * mean or below > _LONGEST_BELOW * mean:
            continue
        # A joint at the place of the top or the bend cuts no bone.
        cuts = [c for c in range(i + 1, k) if c != j and at[c] > at[i] and at[c] != at[j]]
        cost = abs(float(np.log(upper / lower))) + float(np.sum(cut_cost[cuts]))
        cost += float(_COST_ABOVE * at[i] + _COST_BELOW * below) / mean
        nearness = (_APART - apart[i] / mean) / (_APART - _AT_ONE_PLACE)
        cost += _COST_OF_ONE_PLACE * min(max(float(nearness), 0.0), 1.0)
        cost += _COST_OF_A_TWIST * float(np.sum(twist[[i, j, k]]))
        cost += _COST_OF_ANOTHER_END * (called_end is not None and k != called_end)
        if best is None or cost < best[0] - 1e-12:
            best = cost, (i, j, k)
    return None if best is None else best[1]
