"""The feet and plants that a spec names, found in a clip."""

from __future__ import annotations

from functools import partial
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.kinematics import Effector
from motionedit.dataclass import dataclass
from motionedit.jobs.clip import resolve
from motionedit.spec.faults import listed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.core.priorities.asks_to_stand import GivenPlants
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.faults import Faults
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.plants import PlantsSpec


@dataclass(frozen=True, eq=False)
class FeetInClip:
    """Where ankles and plants are looked for: a clip, its events, and what files call it; faults are collected."""

    facts: ClipFacts
    events: Mapping[str, float]
    faults: Faults
    relative: str

    def ankles(self, named: str | Sequence[str], place: Place) -> tuple[Effector, ...]:
        """Return the ankles that are named, or those of all legs."""
        skeleton, known = self.facts.clip.motion.skeleton, [leg.ankle for leg in self.facts.anatomy.legs or ()]
        if isinstance(named, str):
            joints = tuple(known)
        else:
            joints = resolve.joints_if_there(named, skeleton, place, self.faults)
        if not known:
            self.faults.add(
                place.error(f"no feet found in {place.clip}; body: in a spec says which joints are the legs")
            )
        for i, joint in enumerate(joints):
            self._refuse_no_ankle(joint, place.at(i))
        return tuple(Effector(joint, np.zeros(3)) for joint in joints)

    def _refuse_no_ankle(self, joint: int, place: Place) -> None:
        names, known = self.facts.clip.motion.skeleton.names, [leg.ankle for leg in self.facts.anatomy.legs or ()]
        if joint not in known:
            ankles = listed([names[j] for j in known])
            self.faults.add(place.error(f"'{names[joint]}' is no ankle in {place.clip}; they are {ankles}"))

    def _ankle(self, foot: str, place: Place) -> int | None:
        """Return the ankle of a foot that is called left, right, or by its joint."""
        sides = dict(zip(("left", "right"), self.facts.anatomy.legs or (), strict=False))
        if foot in sides:
            return sides[foot].ankle
        joint = resolve.joint_if_there(foot, self.facts.clip.motion.skeleton, place, self.faults)
        if joint is not None:
            self._refuse_no_ankle(joint, place)
        return joint

    def plants(self, given: PlantsSpec, place: Place) -> dict[int, GivenPlants] | None:
        """Return the plants that the spec or its file gives, by ankle; None where they are to be found."""
        found: dict[int, list[tuple[str, int, int]]] = {}
        if given.by_foot is not None:
            for foot, intervals in given.by_foot.items():
                joint = self._ankle(foot, place.at(foot))
                for i, interval in enumerate(intervals):
                    motion, events = self.facts.clip.motion, self.events
                    find = partial(resolve.frame_range, interval, place.at(foot, i), motion, events=events)
                    span: tuple[int, int] | None = self.faults.get(find, otherwise=None)
                    if joint is not None and span is not None:
                        found.setdefault(joint, []).extend((("heel", *span), ("toe", *span)))
            return self._no_more_than_frames({joint: tuple(plants) for joint, plants in found.items()}, place)
        if given.rows is None:
            return None
        mine = {self.relative, PurePosixPath(self.relative).stem}
        for row in given.rows:
            if row.clip in mine:
                joint = self._ankle(row.foot, place)
                if row.last > self.facts.last:
                    self.faults.add(
                        place.error(f"frame {row.last} is outside {place.clip}, whose last is {self.facts.last}")
                    )
                elif joint is not None:
                    parts = ("heel", "toe") if row.part == "foot" else (row.part,)
                    found.setdefault(joint, []).extend((part, row.first, row.last) for part in parts)
        return self._no_more_than_frames({joint: tuple(plants) for joint, plants in found.items()}, place)

    def _no_more_than_frames(self, found: dict[int, GivenPlants], place: Place) -> dict[int, GivenPlants]:
        """Return plants by ankle, of which a clip has no more than frames: others lie over each other."""
        motion = self.facts.clip.motion
        for joint, plants in found.items():
            for part in ("heel", "toe"):
                count = sum(of == part for of, _, _ in plants)
                if count > len(motion):
                    name = motion.skeleton.names[joint]
                    message = f"'{name}' has {count} plants of its {part}, more than {place.clip} has frames"
                    self.faults.add(place.error(message))
                    break
        return found
