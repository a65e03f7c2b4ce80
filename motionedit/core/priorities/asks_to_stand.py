"""What a constraint that holds a foot asks for, before it is known where the foot stands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from typing import Self

    from motionedit.core.kinematics import Effector
    from motionedit.core.priorities.task_targets import Targets

# The part that stands, heel or toe, from the first frame to the last, both in.
GivenPlants = tuple[tuple[str, int, int], ...]


class AsksToStand(Protocol):
    """A constraint on one foot, whose ankle is the effector; see `Footplants`."""

    @property
    def effector(self) -> Effector:
        """The ankle."""

    @property
    def plants(self) -> GivenPlants | None:
        """When heel and toe stand; None: found in the clip."""

    @property
    def height(self) -> float | None:
        """On which height plants stand, clip units along up; None: each on its own."""

    @property
    def follows_path(self) -> bool:
        """Whether plants move and turn where the root's new path takes them."""

    def within(self, goals: Targets, *, number: int) -> Self:
        """Return the constraint with its goals over one stretch of frames."""
