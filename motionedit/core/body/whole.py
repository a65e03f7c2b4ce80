"""The joints that turn a whole body: from the one that carries the travel down to where legs and trunk part."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from motionedit.core.body.anatomy import Anatomy
    from motionedit.core.skeleton import Skeleton


@lru_cache(maxsize=8)
def whole_joints(skeleton: Skeleton, anatomy: Anatomy, *, travel: int) -> tuple[int, ...]:
    """Return the joints that all of a body hangs on, the one that carries the `travel` first, the hips last.

    Mostly it is one. A root that walks the floor, as games have it, has the hips below it; they are no part of the
    spine.
    """
    ends = [leg.thigh for leg in anatomy.legs or ()]
    ends += [joint for joint in (anatomy.chest, anatomy.head) if joint is not None][: bool(ends)]
    ways = [[travel, *skeleton.between(travel, end)] for end in ends]
    shared = []
    for joints in zip(*ways, strict=False):
        if len(set(joints)) > 1:
            break
        shared.append(joints[0])
    return tuple(shared) if len(ends) > 2 else (travel,)


def path_joint(skeleton: Skeleton, anatomy: Anatomy, *, travel: int) -> int:
    """Return the joint whose path is the whole body's, height and all: the last that turns it that has six channels.

    That of a root that walks the floor says nothing of how high the hips are.
    """
    for joint in reversed(whole_joints(skeleton, anatomy, travel=travel)):
        if skeleton.turns_freely(joint) and len(set(skeleton.position_axes[joint])) == len("XYZ"):
            return joint
    return travel
