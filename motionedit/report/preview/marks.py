"""What an edit asked for, as the preview draws it: goals and constraints, their frames, places and errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Span:
    """A point of a constraint: ``hold``, ``during`` or ``at``, from one frame to another, both in."""

    mode: str
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class Curve:
    """An error by frame, (n,), from a mark's first frame on, and its tolerance (None: it may be anything)."""

    values: NDArray[np.float64]
    tolerance: float | None


@dataclass(frozen=True, eq=False)
class Mark:
    """A goal or a constraint.

    Attributes
    ----------
    name : str
    kind : str
        ``goal``, or the constraint's type: a word.
    symbol : {"ring", "ball", "arc"}
        How its place is drawn.
    looks : bool
        Its places are looked at rather than gone to.
    instant : bool
        It is about one instant, and is shown all the time.
    priority : int
        Larger is more important.
    status : str
        As in the report.
    gave_way_to : tuple of str
        Names of those for which it is missed.
    first, last : int
        Frames of the edited clip at which it is active, both in.
    spans : tuple of Span
        Its points; none where it rides the input's own trajectory.
    places : shape (last - first + 1, 3), or None
        Where it wants its effector, y up, in the unit of the bodies' positions; what an aim looks at.
    lengths, angles : Curve or None
        Its errors: clip units, degrees.
    points : tuple of (int, int)
        Bodies on the page and the point of each that is its effector.
    """

    name: str
    kind: str
    symbol: Literal["ring", "ball", "arc"]
    looks: bool
    instant: bool
    priority: int
    status: str
    gave_way_to: tuple[str, ...]
    first: int
    last: int
    spans: tuple[Span, ...]
    places: NDArray[np.float64] | None
    lengths: Curve | None
    angles: Curve | None
    points: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class Edit:
    """The marks of one edited clip, the most important first.

    `body` is the edited clip's place among the bodies; `status`, `message` and `unit` (of lengths) are the report's.
    """

    body: int
    status: str
    message: str | None
    unit: str | None
    marks: tuple[Mark, ...]
