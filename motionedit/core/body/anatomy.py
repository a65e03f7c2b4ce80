"""The anatomy of a skeleton: legs, arms, head, leg length and height."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.kinematics import Effector
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.skeleton import Skeleton

_T = TypeVar("_T")
Part = Literal["heel", "toe"]


@dataclass(frozen=True)
class Leg:
    """The joints of a leg; `toe` is None where the ankle has no joint below it.

    `tip` is then where the ankle's end site is in its frame, clip units, None where it has none.
    """

    thigh: int
    knee: int
    ankle: int
    toe: int | None
    tip: tuple[float, float, float] | None = None

    @property
    def joints(self) -> tuple[int, int, int]:
        """Thigh, knee and ankle: those that turn it."""
        return self.thigh, self.knee, self.ankle


def tip_of(skeleton: Skeleton, ankle: int) -> tuple[float, float, float] | None:
    """Return where the farthest end site of an ankle is in its frame, clip units, None where it has none."""
    sites = [site.offset for site in skeleton.end_sites if site.joint == ankle]
    tip = max(sites, key=lambda offset: float(np.linalg.norm(offset)), default=np.zeros(3))
    return (float(tip[0]), float(tip[1]), float(tip[2])) if np.any(tip) else None


@dataclass(frozen=True)
class SolePoint:
    """A point on which a foot stands: which `foot` (left, right) and `part` of it, and where it is fixed."""

    foot: str
    part: Part
    joint: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def effector(self) -> Effector:
        """The point in its joint's frame."""
        return Effector(self.joint, np.array(self.offset))


@dataclass(frozen=True)
class Arm:
    """The joints of an arm; `clavicle` is None where the shoulder hangs on the spine."""

    clavicle: int | None
    shoulder: int
    elbow: int
    wrist: int

    @property
    def joints(self) -> tuple[int, int, int]:
        """Shoulder, elbow and wrist: those that turn it."""
        return self.shoulder, self.elbow, self.wrist

    @property
    def as_leg(self) -> Leg:
        """Its joints as those of a leg: what solves two bones does not mind which."""
        return Leg(*self.joints, None)


@dataclass(frozen=True)
class Anatomy:
    """What a skeleton's joints are; None where it has no such thing.

    The skeleton is the one of `bones_of`, whose offsets are bones.

    Attributes
    ----------
    legs, arms : left, right
    head : int or None
        The joint at the base of the skull.
    pelvis, chest : int or None
        The joints on which the legs and the arms hang.
    digits : frozenset of int
        Wrists, hands, fingers, toes, and what hangs on the head: joints whose jumps do not make a rest pose.
    leg_length : float
        Thigh to ankle, the sum of bones, mean of both sides, clip units; half the height where there are no legs.
    height : float
        The longest path between two ends, along the bones, clip units.
    warnings : tuple of str
        What no edit can do well without, and was not found, each a line for the user.
    mirrored : bool
        Whether what is called left is on the right in the clip: the heading is the other way round.
    """

    legs: tuple[Leg, Leg] | None
    arms: tuple[Arm, Arm] | None
    head: int | None
    pelvis: int | None
    chest: int | None
    digits: frozenset[int]
    leg_length: float
    height: float
    warnings: tuple[str, ...]
    mirrored: bool = False

    def left_first(self, pair: tuple[_T, _T]) -> tuple[_T, _T]:
        """Return a pair of what is called left and right with that first which is on the left."""
        return pair[::-1] if self.mirrored else pair

    @property
    def missing(self) -> tuple[str, ...]:
        """What else was not found, each a line for the user with its consequence."""
        lines = []
        if self.arms is None:
            lines.append(
                "no arms found: elbows are no hinges, and masses for the center of mass go by the lengths of bones; "
                "body: in a spec says which joints are the arms"
            )
        if self.head is None:
            lines.append("no head found: up is found without it; body: in a spec says which joint is the head")
        return tuple(lines)

    @property
    def limbs(self) -> tuple[tuple[int, int, int], ...]:
        """The top, the joint that bends and the end of each leg, then of each arm, left before right."""
        return tuple(limb.joints for limb in (*(self.legs or ()), *(self.arms or ())))

    @cached_property
    def sole_points(self) -> tuple[SolePoint, ...]:
        """The heel and toe of each foot, left before right; a leaf ankle's end site serves as its toe."""
        points = []
        for foot, leg in zip(("left", "right"), self.legs or (), strict=False):
            points.append(SolePoint(foot, "heel", leg.ankle))
            if leg.toe is not None:
                points.append(SolePoint(foot, "toe", leg.toe))
            elif leg.tip is not None:
                points.append(SolePoint(foot, "toe", leg.ankle, leg.tip))
        return tuple(points)

    @cached_property
    def soles(self) -> tuple[IntArray, FloatArray]:
        """The sole points' joints, shape (P,), and where they are in their frames, shape (P, 3)."""
        joints = np.array([point.joint for point in self.sole_points], dtype=np.intp)
        offsets = np.array([point.offset for point in self.sole_points], dtype=np.float64)
        return frozen(joints), frozen(offsets.reshape(-1, 3))

    @property
    def foot_points(self) -> tuple[tuple[str, int], ...]:
        """Ankles and toes with their side, ``("left", joint)``; empty without legs."""
        if self.legs is None:
            return ()
        return tuple(
            (side, joint)
            for side, leg in zip(("left", "right"), self.legs, strict=True)
            for joint in (leg.ankle, leg.toe)
            if joint is not None
        )


@dataclass(frozen=True)
class GivenBody:
    """What a user says that joints are: `head`, and the joints of `legs` and `arms`, left and right.

    None is what is not said, -1 and () what the body does not have. Legs are thigh, knee, ankle and perhaps toe; arms
    shoulder, elbow, wrist, and perhaps the clavicle before them. A limb's joints hang on one another in that order.
    """

    head: int | None = None
    legs: tuple[tuple[int, ...], ...] | None = None
    arms: tuple[tuple[int, ...], ...] | None = None


NOTHING_GIVEN = GivenBody()
