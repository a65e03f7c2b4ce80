"""Points of a constraint: when and where an effector shall be, [PRIO] section 4.2."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from motionedit.spec import kinds
from motionedit.spec.faults import Fault
from motionedit.spec.model import SpecModel, spec_key
from motionedit.spec.scalars import Vector
from motionedit.spec.times import Interval, Time
from motionedit.spec.values import OrientationSpec

Bound = Literal["distance", "at_least", "at_most"]
SPLINE_KEYS = ("tension", "continuity", "bias")
_SPLINE = kinds.number(at_least=-1.0, at_most=1.0)
LENGTH_KEYS = ("distance", "at_least", "at_most")
_LENGTH = kinds.number(above=0.0)
# What a hold already is; the same value written out does no harm.
_HELD = {"tension": 1, "continuity": 0, "bias": 0}


class Point(SpecModel):
    """A hold, a ride or an instant; which goals it may have depends on the constraint's type."""

    exactly_one = (("hold", "during", "at"),)
    at_most_one = (("position", "shift"), ("orientation", "turn"), LENGTH_KEYS)
    between_keys = tuple({"not": {"required": ["during", key]}} for key in ("position", "orientation"))

    hold: Interval | None = spec_key(
        kinds.INTERVAL, default=None, description="Stands still from a to b, [a, b]. One of hold, during, at is needed."
    )
    during: Interval | None = spec_key(
        kinds.INTERVAL, default=None, description="Rides the input's own trajectory from a to b, [a, b], plus shift."
    )
    at: Time | None = spec_key(kinds.TIME, default=None, description="One instant.")
    position: Vector | None = spec_key(
        kinds.VECTOR,
        default=None,
        description="Where the effector shall be, in clip units; at most one of position, shift.",
    )
    shift: Vector | None = spec_key(
        kinds.VECTOR,
        default=None,
        description="Displacement in clip units from the input's place: at the start of a hold, along a ride, at an "
        "instant; default [0, 0, 0].",
    )
    orientation: OrientationSpec | None = spec_key(
        kinds.ORIENTATION,
        default=None,
        description="How the effector's joint shall be turned, in degrees; default: as in the input. At most one of "
        "orientation, turn.",
    )
    turn: OrientationSpec | None = spec_key(
        kinds.ORIENTATION,
        default=None,
        description="By how much the effector's joint shall be turned from the input's own rotation, about the axes of "
        "frame: or relative_to:, in degrees: at the start of a hold, along a ride, at an instant.",
    )
    distance: float | None = spec_key(
        _LENGTH,
        default=None,
        description="distance only: how far the two points shall be from each other, in clip units; default: as in the "
        "input (a hold: as at its start). At most one of distance, at_least, at_most.",
    )
    at_least: float | None = spec_key(
        _LENGTH, default=None, description="distance only: the least that the distance may be, in clip units."
    )
    at_most: float | None = spec_key(
        _LENGTH, default=None, description="distance only: the most that the distance may be, in clip units."
    )
    tension: float = spec_key(
        _SPLINE,
        default=0.0,
        description="Kochanek-Bartels tension of an instant, -1 to 1; default 0. A hold implies 1.",
    )
    continuity: float = spec_key(
        _SPLINE, default=0.0, description="Kochanek-Bartels continuity of an instant, -1 to 1; default 0."
    )
    bias: float = spec_key(_SPLINE, default=0.0, description="Kochanek-Bartels bias of an instant, -1 to 1; default 0.")

    @property
    def start(self) -> Time:
        """The first instant."""
        interval = self.hold or self.during
        return interval.start if interval is not None else self._instant

    @property
    def stop(self) -> Time:
        """The last instant; that of `at` is its first too."""
        interval = self.hold or self.during
        return interval.stop if interval is not None else self._instant

    @property
    def time_keys(self) -> tuple[str]:
        """The key that says when: hold, during or at."""
        if self.hold is not None:
            return ("hold",)
        return ("during",) if self.during is not None else ("at",)

    @property
    def bound(self) -> tuple[Bound, float | None]:
        """The length that is given, and whether it is the length itself or a bound."""
        if self.at_least is not None:
            return "at_least", self.at_least
        return ("distance", self.distance) if self.at_most is None else ("at_most", self.at_most)

    @property
    def _instant(self) -> Time:
        if self.at is None:
            raise ValueError("a point has one of hold, during, at")
        return self.at

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        if "during" in data:
            if "position" in data:
                yield Fault("does not go with during, which rides the input; use shift, or hold", ("position",))
            if "orientation" in data:
                yield Fault("does not go with during, which rides the input; use hold", ("orientation",))
        if "at" not in data and ("hold" in data or "during" in data):
            for key, held in _HELD.items():
                if key in data and data[key] != held:
                    yield Fault("belongs to a point with at; a hold or ride has tension 1", (key,))
