"""Which pair of limbs is the legs and which the arms: by names, by where the head hangs, by what the root is near."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.body.head import SAME_PLACE
from motionedit.core.body.limbs import find_limb_pairs

if TYPE_CHECKING:
    from motionedit.core.body.limbs import LimbPair
    from motionedit.core.body.tree import Tree


def find_legs_and_arms(tree: Tree) -> tuple[LimbPair | None, LimbPair | None]:
    """Return the legs and the arms: by what they are called, and by the tree where that does not tell two apart."""
    pairs = find_limb_pairs(tree)
    called_legs = next((pair for pair in pairs if pair.names > 0), None)
    called_arms = next((pair for pair in pairs if pair.names < 0), None)
    if called_legs is not None and called_arms is not None:
        return called_legs, called_arms
    if len(pairs) < 2:
        return (None, pairs[0]) if called_arms is not None else (pairs[0] if pairs else None, None)
    if called_arms is not None:
        return next(pair for pair in pairs if pair is not called_arms), called_arms
    return _by_the_tree(tree, *pairs[:2])


def _by_the_tree(tree: Tree, first: LimbPair, second: LimbPair) -> tuple[LimbPair, LimbPair]:
    """Tell legs from arms: the head hangs where the arms do, the root is nearer to the legs.

    Where these two contradict each other (a tail, a root in the chest), names decide.
    """
    depth = len(tree.skeleton.chain(second.base)) - len(tree.skeleton.chain(first.base))
    by_head = _signed(_neck_length(tree, second, first) - _neck_length(tree, first, second), tree)
    vote = int(np.sign(depth)) + by_head
    if vote == 0:
        vote = first.names - second.names or depth or 1
    return (first, second) if vote > 0 else (second, first)


def _signed(length: float, tree: Tree) -> int:
    return 0 if abs(length) < SAME_PLACE * tree.height else int(np.sign(length))


def _neck_length(tree: Tree, pair: LimbPair, other: LimbPair | None) -> float:
    return max((float(tree.lengths[c] + tree.reach[c]) for c in _neck_candidates(tree, pair, other)), default=0.0)


def _neck_candidates(tree: Tree, pair: LimbPair, other: LimbPair | None) -> list[int]:
    """Return the children of a pair's base that are neither its limbs nor on the way to the other pair."""
    way = set() if other is None else set(tree.skeleton.chain(other.base).tolist())
    limbs = {pair.chains[0][0], pair.chains[1][0]}
    children = tree.skeleton.children[pair.base]
    return [c for c in children if c not in limbs and c not in way]
