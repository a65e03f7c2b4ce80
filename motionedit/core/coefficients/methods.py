"""The methods that an edit by coefficients can be solved by, each with its settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.coefficients.planted_feet import PlantedFoot


@dataclass(frozen=True, eq=False)
class Likeliest:
    """The default solver: the likeliest change under a prior in which components and a fading residual share.

    Attributes
    ----------
    share : float
        g, the share of a change's variance that may leave the components.
    bound : float or None
        Largest norm of the change, in the database's standard deviations.
    feet : tuple of PlantedFoot
        Points that stand, and are rather not moved.
    still : tuple of int
        Joints that the residual leaves alone.
    believed, heading, position
        Of the components, as of `components_about`.
    one_more : bool
        Whether the clip counts as one more motion of the database, as of `with_one_more`.
    most : float or None
        The largest g that goals at several frames may speak for, by `likeliest_share`; None: g is `share`.
    """

    share: float
    bound: float | None
    feet: tuple[PlantedFoot, ...] = ()
    still: tuple[int, ...] = ()
    believed: float = 1.0
    heading: bool = False
    position: bool = False
    one_more: bool = False
    most: float | None = None


@dataclass(frozen=True)
class GaussNewton:
    """Components alone; `bound` is the largest Mahalanobis norm allowed, None for no bound."""

    bound: float | None


@dataclass(frozen=True)
class Damped:
    """[PC]'s Algorithm 1; `unit` is metres (leg length 0.85 m) of the unit of damping and tolerance."""

    damping: float
    tolerance: float
    max_iterations: int | None
    unit: float
