"""What a report says of an effector: its joint's name, and the point fixed in that joint's frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from motionedit.core.kinematics import Effector
    from motionedit.core.skeleton import Skeleton


def effector_record(effector: Effector, skeleton: Skeleton, *, scale: float = 1.0) -> dict[str, Any]:
    """Return an effector's joint and offset in clip units; `scale` is what its offset was multiplied by."""
    return {"joint": skeleton.names[effector.joint], "offset": (effector.offset / scale).tolist()}
