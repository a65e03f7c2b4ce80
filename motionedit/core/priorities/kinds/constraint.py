"""What every kind of constraint has, and what each answers: the only face that the rest of the edit knows.

A kind is one file beside this one. It says what a constraint of it recruits and what moves it, where it shall be, its
task, what is left of it, and its words. What it does not say stands here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np

from motionedit.core.kinematics import Effector
from motionedit.core.measure import WORLD
from motionedit.core.priorities.solver.points import point_of, recruited_of
from motionedit.core.priorities.trajectories.positions import active_interval, share_of
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
    from typing import Self

    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.measure import Level, Measure
    from motionedit.core.motion import Motion
    from motionedit.core.priorities.recruiting import Recruits
    from motionedit.core.priorities.settings import Body
    from motionedit.core.priorities.sight import Sight
    from motionedit.core.priorities.solver.points import Columns, Point, Recruited
    from motionedit.core.priorities.solver.problem import Task
    from motionedit.core.priorities.task_targets import Targets
    from motionedit.core.priorities.trajectories.positions import ControlPoint, Curve
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
class ConstraintErrors:
    """What is left of a constraint: frames `first` on; lengths (n,) and radians (n,), None where it has none.

    `places` (n, 3) is where its effector is wanted in the world, or what an aim looks at; None for what only turns.
    Along axes that the constraint leaves free it is where the effector is.
    """

    first: int
    positions: FloatArray | None
    angles: FloatArray | None
    places: FloatArray | None = None

    @property
    def largest(self) -> FloatArray:
        """How much is left, the larger of both, shape (n,), metres or radians."""
        parts = [part for part in (self.positions, self.angles) if part is not None]
        return parts[0] if len(parts) == 1 else np.maximum(*parts)


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

    @classmethod
    def of_input(cls, before: Sight, curve: Curve) -> Scene:
        """Return the scene of the input alone: no goals, and others make nothing of it."""
        return cls(before, curve, dict, lambda: before)


@dataclass(frozen=True, eq=False)
class Displacement:
    """How far a constraint wants a point of the body from where the input has it, in the world.

    Attributes
    ----------
    places : shape (F, 3)
        Where the input has it.
    span : slice
        The n frames at which the constraint is active.
    shift : shape (n, 3)
        How far from there it is wanted; 0 along axes that do not count.
    counted : shape (k, 3)
        The axes that count, unit vectors.
    """

    places: FloatArray
    span: slice
    shift: FloatArray
    counted: FloatArray


class Turned(NamedTuple):
    """Joints and their local rotations, shape (n, k, 4), at the n frames at which a constraint is active."""

    joints: Sequence[int]
    rotations: FloatArray


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
        When and where; none: as in the input, the whole clip.
    measure : Measure
        What positions, shifts and rotations are measured in.
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
    # It is about how its effector is turned, too: by the effector's own joint, wherever in it that is.
    turns: ClassVar[bool] = False
    # Its error is where it shall be less where it is: of several that are about the same, their mean will do.
    averages: ClassVar[bool] = False
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
    measure: Measure = WORLD
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
        """The height below which it wants none of its points; None where it says nothing of it."""
        return None

    @property
    def about(self) -> Hashable:
        """What its targets are the targets of, equal to another's that asks for the same task; None where none can."""
        return None

    @property
    def subjects(self) -> frozenset[Hashable]:
        """What it says where it shall be or how turned, along whichever axes; none where that is told by no other."""
        return frozenset() if self.about is None else frozenset((self.about,))

    def carries(self, body: Body) -> bool:
        """Return whether meeting it may be a reason to carry the whole body elsewhere."""
        del body
        return True

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

    def unasked(self, targets: Targets, scene: Scene) -> Targets:
        """Return where its targets would be if its points asked for nothing, as targets are."""
        return self.reached(targets, scene.before)

    def by_itself(self, targets: Targets, recruits: Recruits, body: Body, before: Callable[[], Sight]) -> Turned | None:
        """Return how a body turns by itself to meet it, where that is not the least turn; `before` is the input."""
        del targets, recruits, body, before
        return None

    def goal(self, targets: Targets) -> tuple[int, FloatArray] | None:
        """Return the joint that it puts in a place, and where, world positions (n, 3); None where it does not."""
        del targets
        return None

    def displacement(self, scene: Scene) -> Displacement | None:
        """Return how far it wants its effector from where the input has it; None where that is no place of its own."""
        del scene
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
