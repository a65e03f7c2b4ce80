"""A foot stands where its plants are, and goes between them as it did: its goals are found before the edit."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from motionedit.core.priorities.kinds.pose import Pose
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, Self

    from motionedit.core.priorities.asks_to_stand import GivenPlants
    from motionedit.core.priorities.kinds.constraint import Scene
    from motionedit.core.priorities.task_targets import Targets


@dataclass(frozen=True, eq=False, kw_only=True)
class Footplants(Pose):
    """The ankle's pose is what `goals` say: those of one foot over one stretch of frames.

    Attributes
    ----------
    plants : GivenPlants or None
        When heel and toe stand; None: found in the clip.
    height : float or None
        On which height plants stand, clip units along up; None: each on its own.
    follows_path : bool
        Plants move and turn where the root's new path takes them.
    goals : Targets or None
        None until they were found.
    """

    type: ClassVar[str] = "footplants"
    stands: ClassVar[bool] = True
    called: ClassVar[Mapping[str, str]] = {"feet": "effector", "at": "follows_path"}

    plants: GivenPlants | None = None
    height: float | None = None
    follows_path: bool = False
    goals: Targets | None = None

    @classmethod
    def several(cls, **given: Any) -> tuple[Self, ...]:  # noqa: ANN401  what its fields are
        """Return a constraint for each of the `feet`; the first keeps the name. `plants` are by the ankle's joint."""
        feet, plants, name = given.pop("feet"), given.pop("plants"), given.pop("name")
        height, at = given.pop("height"), given.pop("at")
        return tuple(
            cls(
                name=name if i == 0 else f"{name}-{i + 1}",
                effector=foot,
                plants=None if plants is None else plants.get(foot.joint, ()),
                height=height,
                follows_path=at == "path",
                **given,
            )
            for i, foot in enumerate(feet)
        )

    def within(self, goals: Targets, *, number: int) -> Self:
        """Return the constraint with its goals over one stretch; from the second on, stretches are numbered."""
        return replace(self, goals=goals, name=self.name if number == 0 else f"{self.name}-stretch-{number + 1}")

    @property
    def found(self) -> Targets:
        """The goals, once they were found."""
        if self.goals is None:
            raise ValueError("the goals of these plants were not found yet")
        return self.goals

    def active(self, frames: int) -> tuple[int, int]:
        """Return the first and last frame of the stretch."""
        return (self.since, frames - 1) if self.goals is None else (self.goals.first, self.goals.last)

    def targets(self, scene: Scene) -> Targets:
        """Return the goals."""
        del scene
        return self.found
