"""Goals that an edit met, and that are to be met again where more is changed of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from motionedit.core import kinematics
from motionedit.core.units import STANDARD_LEG
from motionedit.dataclass import replace
from motionedit.jobs.edit_pc.goals import off, seen

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from motionedit.core.coefficients.edit import CoefficientEdit
    from motionedit.core.coefficients.goal_chains import GoalRequest
    from motionedit.core.kinematics import WorldPoses
    from motionedit.core.motion import Motion

# Metres at leg length 0.85 m, and radians: what a change may move a goal by.
_SETTLED = 5e-6
# Times that: what is left of it after all rounds, 0.1 mm, is met.
NEARLY = 20.0


class Again(Protocol):
    """What changes a motion so that goals are met again."""

    def __call__(
        self, motion: Motion, requests: Sequence[GoalRequest], still: Collection[int], *, firm: bool = False
    ) -> Motion:
        """Return the motion with the goals met while joints are `still`; with `firm`, so are feet that stand."""
        ...


def asked_again(edit: CoefficientEdit, requests: Sequence[GoalRequest]) -> list[GoalRequest]:
    """Return the goals that an edit met; of one that is out of reach what the solver has come to is kept."""
    if all(edit.reasons[i] == "converged" for i in range(len(requests))):
        return list(requests)
    poses = kinematics.forward(edit.motion)
    return [
        request if edit.reasons[i] == "converged" else _reached(request, poses) for i, request in enumerate(requests)
    ]


def _reached(request: GoalRequest, poses: WorldPoses) -> GoalRequest:
    position, rotation = seen(poses, request.frame, request.effector, request.measure)
    return replace(
        request,
        position=None if request.position is None else position,
        rotation=None if request.rotation is None else rotation,
    )


def ways_off(poses: WorldPoses, requests: Sequence[GoalRequest], *, leg: float) -> list[float]:
    """Return how far each goal is off in some poses, over what settles it; `leg` is the leg's length, clip units."""
    tolerance, found = _SETTLED * leg / STANDARD_LEG, [off(request, poses) for request in requests]
    return [max((way or 0.0) / tolerance, (turn or 0.0) / _SETTLED) for way, turn in found]
