"""What an edit is given beside its constraints: the body, and how it is to be solved and smoothed."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Literal

from motionedit.core.body.limits import NO_LIMITS
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.anatomy import Leg
    from motionedit.core.body.bends import Bend
    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.body.gaze import Gaze
    from motionedit.core.body.hinges import Hinge
    from motionedit.core.body.limits import Limits
    from motionedit.core.priorities.trajectories.positions import Curve

RecruitingRule = Literal["expand", "error", "ignore"]


@dataclass(frozen=True)
class Passes:
    """The default smoothing: low-pass the displacement map, solve again attracted to it; sigma in frames."""

    count: int = 3
    sigma: float = 1.5


@dataclass(frozen=True)
class PaperFilter:
    """The paper's: eq. (4) start states, an FIR low-pass on the root's translation (Hz), further passes."""

    count: int = 2
    cutoff: float = 3.0


@dataclass(frozen=True)
class LayeredSettings:
    """How an edit is solved: what the spec says beside its constraints."""

    smoothing: Passes | PaperFilter = field(default_factory=Passes)
    curve: Curve = "time"
    attraction: float = 1.0
    max_iterations: int = 40
    recruiting_rule: RecruitingRule = "expand"
    threads: int = 1

    @property
    def gives_way(self) -> bool:
        """Whether what is out of reach gives way: the paper's way is as near to it as any step comes."""
        return isinstance(self.smoothing, Passes)


@dataclass(frozen=True, eq=False)
class Body:
    """What the edit knows of the body: its masses, hinges, the joint that carries the travel, the first moving frame.

    Frames before `first` are a rest pose. `bends` are its knees and elbows, where they are known. `mobility` (J,) is
    how readily each joint turns, `root_mobility` how readily the root shifts; 1, the default, is as the paper has it.
    `limits` are the cones that joints keep to. `upper` is what hangs on the chest, arms and head: goals for it alone
    are no reason to carry the body elsewhere. `gaze` is how it looks somewhere by itself, where it has a head; by its
    `legs` it goes down.
    """

    masses: Masses
    hinges: tuple[Hinge, ...]
    travel: int
    first: int
    bends: tuple[Bend, ...] = ()
    mobility: FloatArray | None = None
    root_mobility: float = 1.0
    limits: Limits = NO_LIMITS
    upper: frozenset[int] = frozenset()
    gaze: Gaze | None = None
    legs: tuple[Leg, ...] = ()
