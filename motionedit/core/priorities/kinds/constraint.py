"""What every kind of constraint has, and what each answers: the only face that the rest of the edit knows.

A kind is one file beside this one. It says what a constraint of it recruits and what moves it, where it shall be, its
task, what is left of it, and its words. What it does not say stands here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector
from motionedit.core.priorities.points import point_of, recruited_of
from motionedit.core.priorities.trajectories import active_interval, share_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from typing import Self

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.measure import Level
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.points import Columns, Point, Recruited
    from motionedit.core.priorities.problem import Task
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.trajectories import ControlPoint, Curve
    from motionedit.core.skeleton import Skeleton

# How a page marks where a constraint is: a ring with a cross, a quartered ball, an arc.
Symbol = Literal["ring", "ball", "arc"]


@dataclass(frozen=True, eq=False)
class Movable:
    """What of a body constraints may recruit: the joint that carries the `travel`, the joints that carry mass."""

    skeleton: Skeleton
    travel: int
    carriers: frozenset[int]


@dataclass(frozen=True, eq=False)
class Targets:
    """Where a constraint's task shall be: frames `first` to `last`.

    Positions (n, 3), rotations (n, 4), lengths (n,), None of what it has none of.
    """

    first: int
    last: int
    positions: FloatArray | None = None
    rotations: FloatArray | None = None
    lengths: FloatArray | None = None

    @property
    def span(self) -> slice:
        """Their frames."""
        return slice(self.first, self.last + 1)

    @property
    def all_positions(self) -> FloatArray:
        """The positions, of targets that have them."""
        if self.positions is None:
            raise ValueError("these targets have no positions")
        return self.positions

    @property
    def parts(self) -> tuple[FloatArray | None, FloatArray | None, FloatArray | None]:
        """Positions, rotations and lengths."""
        return self.positions, self.rotations, self.lengths

    def within(self, frames: slice) -> Targets:
        """Return the targets at some of their frames."""
        if frames.start == self.first and frames.stop == self.last + 1:
            return self
        here = slice(frames.start - self.first, frames.stop - self.first)
        return Targets(frames.start, frames.stop - 1, *(None if part is None else part[here] for part in self.parts))

    def since(self, frame: int) -> Targets:
        """Return the same targets of a motion that begins at a frame of this one."""
        return self if frame == 0 else Targets(self.first - frame, self.last - frame, *self.parts)

    def with_part(self, part: Targets) -> Targets:
        """Return the targets with those at some of their frames replaced."""
        here = slice(part.first - self.first, part.last + 1 - self.first)
        parts = [None if own is None else own.copy() for own in self.parts]
        for own, new in zip(parts, part.parts, strict=True):
            if own is not None and new is not None:
                own[here] = new
        return Targets(self.first, self.last, *parts)

    def positions_at(self, frames: IntArray) -> FloatArray:
        """Return the positions at frames of the clip, shape (N, 3)."""
        return _at(self.positions, frames, self.first, "positions")

    def rotations_at(self, frames: IntArray) -> FloatArray:
        """Return the rotations at frames of the clip, shape (N, 4)."""
        return _at(self.rotations, frames, self.first, "rotations")

    @property
    def all_lengths(self) -> FloatArray:
        """The lengths, of targets that have them."""
        if self.lengths is None:
            raise ValueError("these targets have no lengths")
        return self.lengths

    def lengths_at(self, frames: IntArray) -> FloatArray:
        """Return the lengths at frames of the clip, shape (N,)."""
        return _at(self.lengths, frames, self.first, "lengths")


def _at(values: FloatArray | None, frames: IntArray, first: int, name: str) -> FloatArray:
    """Return values, those of frames from `first` on, at growing frames; those that follow each other are a view."""
    if values is None:
        raise ValueError(f"these targets have no {name}")
    start, count = int(frames[0]) - first, len(frames)
    if int(frames[-1]) - first == start + count - 1:
        return values[start : start + count]
    at: FloatArray = values[frames - first]
    return at


def between(one: Targets, other: Targets, share: FloatArray) -> Targets:
    """Return targets on the way from one to another of the same frames, so much of it each, shape (n,)."""
    positions, rotations, lengths = one.positions, one.rotations, one.lengths
    if positions is not None:
        positions = positions + share[:, None] * (other.all_positions - positions)
    if rotations is not None and other.rotations is not None:
        arc = rot.log(rot.between(rotations, other.rotations))
        rotations = rot.multiply(rotations, rot.exp(share[:, None] * arc))
    if lengths is not None:
        lengths = lengths + share * (other.all_lengths - lengths)
    return Targets(one.first, one.last, positions, rotations, lengths)


def moved(targets: Targets, before: Targets, after: Targets, share: FloatArray) -> Targets:
    """Return targets moved along from where one motion has a task to where another has it, so much each, shape (n,)."""
    positions, rotations, lengths = targets.positions, targets.rotations, targets.lengths
    if positions is not None:
        positions = positions + share[:, None] * (after.all_positions - before.all_positions)
    if rotations is not None and before.rotations is not None and after.rotations is not None:
        turn = rot.log(rot.between(before.rotations, after.rotations))
        rotations = rot.multiply(rotations, rot.exp(share[:, None] * turn))
    if lengths is not None:
        lengths = lengths + share * (after.all_lengths - before.all_lengths)
    return Targets(targets.first, targets.last, positions, rotations, lengths)


@dataclass(frozen=True, eq=False)
class ConstraintErrors:
    """What is left of a constraint: frames `first` on; lengths (n,) and radians (n,), None where it has none.

    `places` (n, 3) is where its effector is wanted in the world, or what an aim looks at; None for what only turns.
    Along axes that the constraint leaves free it is where the effector is.
    """

    first: int
    positions: FloatArray | None
    angles: FloatArray | None
    places: FloatArray | None = None


def joined(parts: Sequence[ConstraintErrors], first: int) -> ConstraintErrors:
    """Return what is left of a constraint from frame `first` on, of parts that follow one another."""
    if len(parts) == 1 and parts[0].first == first:
        return parts[0]

    def whole(name: str) -> FloatArray | None:
        arrays = [array for array in (getattr(part, name) for part in parts) if array is not None]
        return np.concatenate(arrays) if len(arrays) > 1 else arrays[0] if arrays else None

    return ConstraintErrors(first, whole("positions"), whole("angles"), whole("places"))


@dataclass(frozen=True, eq=False)
class Scene:
    """What targets are made from.

    Attributes
    ----------
    before : Sight
        The input, as far as the constraints look at it.
    curve : Curve
        What the parameter of splines is.
    goals : callable
        Returns where constraints that do not wait for others want joints in the world, a mapping from joints to shape
        (F, 3), nan where nothing does.
    others : callable
        Returns the Sight of the motion that the constraints which do not wait for others ask for, solved once.
    """

    before: Sight
    curve: Curve
    goals: Callable[[], Mapping[int, FloatArray]]
    others: Callable[[], Sight]


@dataclass(frozen=True, eq=False)
class Stage:
    """What a task is made for: the frames (N,) that are solved together, and what the constraint may use of them.

    `reference` is the input.
    """

    frames: IntArray
    columns: Columns
    recruits: Recruits
    masses: Masses
    reference: Motion

    @property
    def recruited(self) -> Recruited:
        """The recruited unknowns."""
        return recruited_of(self.columns, self.recruits)

    def point(self, effector: Effector) -> Point:
        """Return an effector as the recruited unknowns move it."""
        return point_of(self.columns, effector, self.recruits)

    def joint(self, joint: int | None) -> Point | None:
        """Return a joint's own place as the recruited unknowns move it; None for none."""
        return None if joint is None else self.point(Effector(joint, np.zeros(3)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Constraint(ABC):
    """What the user asks for, resolved in one clip; lengths are normalised metres.

    Attributes
    ----------
    name, priority, weight
        Larger priorities are more important; only their order matters.
    points : tuple of ControlPoint
        When and where; none: as in the input, the whole clip. Positions along the measuring axes.
    ease_in, ease_out : float
        Frames.
    since : int
        The first frame after a rest pose, which no ease reads.
    yields : bool
        Nobody counts on it: where meeting it makes the motion step, it gives way.
    follow : {"input", "reference"}
        Whose paths and turns it reads.
    """

    type: ClassVar[str]
    # Its targets ask for what the other constraints alone make of the motion.
    waits_for_others: ClassVar[bool] = False
    # It keeps its effector in place, or brings it there.
    places_effector: ClassVar[bool] = False
    # Its place is the body's center of mass, which needs masses.
    weighs: ClassVar[bool] = False
    # Its goals come from where feet stand, which is found before the edit.
    stands: ClassVar[bool] = False
    # What keys of a spec are called here, where it is not by their own names.
    called: ClassVar[Mapping[str, str]] = {}
    # On a page: its symbol, and whether its places are looked at rather than gone to.
    symbol: ClassVar[Symbol] = "ring"
    looks: ClassVar[bool] = False

    name: str
    priority: int = 1
    weight: float = 1.0
    points: tuple[ControlPoint, ...] = ()
    ease_in: float = 0.0
    ease_out: float = 0.0
    since: int = 0
    yields: bool = False
    follow: Literal["input", "reference"] = "input"

    @classmethod
    def several(cls, **given: Any) -> tuple[Self, ...]:  # noqa: ANN401  what its fields are
        """Return the constraints that one item of a spec stands for: one, of most kinds."""
        return (cls(**given),)

    @property
    def at(self) -> Effector | None:
        """The effector that it is about; None where it is about no one point."""
        return None

    @property
    def one_sided(self) -> bool:
        """Whether its task is a limit, met on all of one side: see `WeightedTask`."""
        return False

    @property
    def least(self) -> Level | None:
        """The height below which it wants no foot; None where it says nothing of it."""
        return None

    def active(self, frames: int) -> tuple[int, int]:
        """Return the first and last frame at which the constraint is active."""
        if not self.points:
            return 0, frames - 1
        return active_interval(
            self.points, ease_in=self.ease_in, ease_out=self.ease_out, frames=frames, since=self.since
        )

    def share(self, frames: int) -> FloatArray:
        """Return how far it is eased in at each frame, shape (F,), 0 to 1."""
        return share_of(self.points, ease_in=self.ease_in, ease_out=self.ease_out, frames=frames)

    @abstractmethod
    def recruits(self, movable: Movable) -> Recruits:
        """Return what the user lets it move.

        Raises
        ------
        NotOnTheWayError
            If its `up_to` is not on the way to the root.
        """

    @abstractmethod
    def moved_by(self, movable: Movable) -> Recruits:
        """Return what moves its task, recruited or not."""

    def looked_at(self) -> frozenset[int]:
        """Return the joints whose world transforms its targets and errors ask for."""
        return frozenset()

    @abstractmethod
    def targets(self, scene: Scene) -> Targets:
        """Return where its task shall be."""

    def reached(self, targets: Targets, after: Sight) -> Targets:
        """Return where a motion has its task, as targets are; what has no place to go back to returns its targets."""
        del after
        return targets

    def goal(self, targets: Targets) -> tuple[int, FloatArray] | None:
        """Return the joint that it puts in a place, and where, world positions (n, 3); None where it does not."""
        del targets
        return None

    @abstractmethod
    def task(self, targets: Targets, stage: Stage) -> Task:
        """Return its task at the stage's frames, all of them in its active interval."""

    @abstractmethod
    def errors(self, targets: Targets, after: Sight, *, reference: Motion) -> ConstraintErrors:
        """Return what is left of it over its active interval, not weighted; `reference` is the input."""

    @abstractmethod
    def words(self, names: tuple[str, ...]) -> str:
        """Return what it is about, in the words of a plan; `names` are the joints'."""

    def warnings(self) -> Iterator[str]:
        """Yield what the user should know of it before it is solved."""
        yield from ()
