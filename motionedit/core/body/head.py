"""The head of a skeleton: the joint that is called so, or the end of its longest neck."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.core.body.sides import side_of_chains
from motionedit.core.body.words import is_end, is_head

if TYPE_CHECKING:
    from motionedit.core.body.limbs import LimbPair
    from motionedit.core.body.tree import Tree

# A joint as near to its parent as this, in heights, is at the same place.
SAME_PLACE = 1e-3


def find_head(tree: Tree, legs: LimbPair | None, arms: LimbPair | None) -> tuple[int | None, list[int]]:
    """Return the head and the way from it to the farthest end: the joint that is called so, else the longest neck.

    A neck is a chain beside the arms, or beside the spine below them.
    """
    called = _called_head(tree, legs, arms)
    if called is not None:
        return called, tree.longest_way(called)
    candidates = _necks(tree, legs, arms)
    if not candidates:
        return None, []
    names = tree.names
    branches = [[c for c in below if c not in tree.hanging] for below in tree.skeleton.children]
    way = [_longest(tree, candidates)]
    while len(branches[way[-1]]) == 1:
        way.append(branches[way[-1]][0])
    # Back from ends, and from a joint at the place of the one below it.
    while len(way) > 1 and (
        tree.lengths[way[-1]] < SAME_PLACE * tree.height or (not branches[way[-1]] and is_end(names[way[-1]]))
    ):
        way.pop()
    return way[-1], tree.longest_way(way[-1])


def _longest(tree: Tree, joints: list[int]) -> int:
    """Return the joint from which the way to the farthest end is longest."""
    return max(joints, key=lambda j: (tree.lengths[j] + tree.reach[j], -j))


def _called_head(tree: Tree, legs: LimbPair | None, arms: LimbPair | None) -> int | None:
    """Return the joint nearest to the root that is called head and is part of no limb."""
    limbs: set[int] = set()
    for pair in (legs, arms):
        for chain in () if pair is None else pair.chains:
            limbs |= tree.below(chain[0])
    names = tree.names
    heads = [j for j, name in enumerate(names) if is_head(name) and j not in limbs and j not in tree.hanging]
    return min(heads, key=lambda j: (len(tree.skeleton.chain(j)), j), default=None)


def _necks(tree: Tree, legs: LimbPair | None, arms: LimbPair | None) -> list[int]:
    """Return the joints at which a neck may begin: at the arms' base, else at the nearest joint below it with any."""
    carrier = arms or legs
    if carrier is None:
        return []
    below = legs if arms is not None else None
    spine = tree.skeleton.chain(carrier.base).tolist()[::-1]
    if below is not None and below.base in spine:
        spine = spine[: max(spine.index(below.base), 1)]
    limbs = {carrier.chains[0][0], carrier.chains[1][0]}
    way = set(spine) | (set() if below is None else set(tree.skeleton.chain(below.base).tolist()))
    for joint in spine:
        found = [c for c in tree.skeleton.children[joint] if c not in limbs | way and c not in tree.hanging]
        found = [c for c in found if not _is_paired(tree, c, found)] or found
        if found:
            return found
    return []


def _is_paired(tree: Tree, joint: int, joints: list[int]) -> bool:
    """Tell whether a branch has a twin beside it by name: breasts and ribs are no necks."""
    names = tree.skeleton.names
    return any(side_of_chains(names, ((joint,), (other,))) for other in joints if other != joint)
