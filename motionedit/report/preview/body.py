"""A body as the preview draws it: points over frames, and the limbs, hulls and balls that stand on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Side = Literal["left", "right", "middle"]


@dataclass(frozen=True)
class Limb:
    """A tapered limb from point `start` to point `end`; `radii` at both, in the unit of the positions."""

    start: int
    end: int
    radii: tuple[float, float]
    side: Side


@dataclass(frozen=True)
class Hull:
    """The flat outline round several points, such as a chest; one radius for each point."""

    points: tuple[int, ...]
    radii: tuple[float, ...]


@dataclass(frozen=True)
class Ball:
    """A ball at a point: a head, or the nose that tells where it looks."""

    point: int
    radius: float
    part: Literal["head", "nose"]


@dataclass(frozen=True, eq=False)
class Body:
    """One clip, ready to draw.

    Attributes
    ----------
    label : str
        Name in the legend.
    names : P strings
        Of the points: joints, then end sites; an empty name is a point that only serves the drawing.
    positions : shape (F, P, 3)
        World positions, y up, in clip units times `scale`.
    frame_time : float
        Seconds from frame to frame.
    first : int
        Number of rest-pose frames in front of the take.
    limbs, hulls, balls : tuples
        What is drawn on the points.
    trails : tuple of int
        Points whose paths are shown unless the viewer asks for others.
    size : float
        Leg length, in the unit of the positions.
    forward : three floats
        Horizontal unit vector to the character's front at frame `first`.
    axes : three strings
        The file's axes along x, y and z, such as ``("x", "z", "-y")`` for a file with z up.
    scale : float
        1, or what brings a clip of another unit to the size of the first one.
    floor : float
        Height at which the floor is drawn.
    """

    label: str
    names: tuple[str, ...]
    positions: NDArray[np.float64]
    frame_time: float
    first: int
    limbs: tuple[Limb, ...]
    hulls: tuple[Hull, ...]
    balls: tuple[Ball, ...]
    trails: tuple[int, ...]
    size: float
    forward: tuple[float, float, float]
    axes: tuple[str, str, str]
    scale: float = 1.0
    floor: float = 0.0

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (len(self.positions) - 1) * self.frame_time
