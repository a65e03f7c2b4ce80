"""What constraints of edit-prioritized share: the keys that every type has, and those of several, [PRIO] section 4."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from motionedit.dataclass import dataclass
from motionedit.spec import kinds
from motionedit.spec.faults import Fault, Keys
from motionedit.spec.items import NOT_TWO_FRAMES, Item, measure_faults, without
from motionedit.spec.model import Kind, SpecModel, mappings_in, spec_key
from motionedit.spec.nested import list_of, mapping
from motionedit.spec.points import Point
from motionedit.spec.scalars import one_of
from motionedit.spec.times import Duration
from motionedit.spec.values import Recruit, Tolerance

EASE = Duration("0.8s", 0.8, is_seconds=True)
_TIME_KEYS = ("hold", "during", "at")


@dataclass(frozen=True, eq=False)
class OwnValue:
    """What a constraint has at a key that not every one has: its `kind`, and its `keys` in the spec."""

    key: str
    keys: Keys
    kind: Kind
    value: Any


# The types of constraints by their names, in the order in which constraint_types.py has them.
TYPES: "dict[str, type[ConstraintItem]]" = {}


def type_words(names: Sequence[str]) -> str:
    """Return ``type position or pose``."""
    return f"type {one_of(names)}"


class ConstraintItem(Item):
    """What every constraint has."""

    # Keys that a point may have beside its time, and whether a tolerance is a length or an angle.
    point_keys: ClassVar[tuple[str, ...]] = ()
    has_position: ClassVar[bool] = True
    has_angle: ClassVar[bool] = False
    # The keys that say what its positions and rotations are measured in.
    measure_keys: ClassVar[tuple[str, ...]] = ()
    # A constraint that --strict counts only where it is given a tolerance.
    only_warns: ClassVar[bool] = False

    if TYPE_CHECKING:
        type: str

    def __init_subclass__(cls) -> None:
        """Make a type known by its name, and to editors what its points and its tolerance may not have."""
        super().__init_subclass__()
        if "type" in cls.model_keys:
            TYPES[cls.model_keys["type"].kind.wanted] = cls
            foreign = [name for name in Point.key_names() if name not in (*_TIME_KEYS, *cls.point_keys)]
            lacking = [key for key, has in (("position", cls.has_position), ("angle", cls.has_angle)) if not has]
            rules = (("points", {"items": {"allOf": [without(name) for name in foreign]}}),)
            rules += tuple(("tolerance", without(key)) for key in lacking)
            cls.between_keys = (*cls.between_keys, *({"properties": {key: rule}} for key, rule in rules))

    priority: int = spec_key(
        kinds.whole(),
        default=1,
        description="Larger is more important; only the order matters. Equal ones share by weight.",
    )
    weight: float = spec_key(
        kinds.number(above=0.0),
        default=1.0,
        description="Weight among constraints of the same priority (see defaults).",
    )
    tolerance: Tolerance | None = spec_key(
        kinds.TOLERANCE,
        default=None,
        description="How near is met: clip units, degrees for what only turns, {position, angle} for what does both; "
        "off: may give way. Default 1 mm and 0.1 degree at leg length 0.85 m. Where none is given, --strict counts "
        "what has a point with at or hold, but for types that only follow or keep something: these warn alone.",
    )
    ease_in: Duration = spec_key(
        kinds.DURATION,
        default=EASE,
        description="Ramp from the input's trajectory before the first point (see defaults).",
    )
    ease_out: Duration = spec_key(
        kinds.DURATION,
        default=EASE,
        description="Ramp back to the input's trajectory after the last point (see defaults).",
    )
    follow: Literal["input", "reference"] = spec_key(
        kinds.word("input", "reference"),
        default="input",
        description="Whose paths and postures shifts and rides start from: the input's, or the reference's. Eases lead "
        "to them from the input, and back.",
    )
    points: tuple[Point, ...] = spec_key(
        list_of(mapping(Point)), default=(), description="When and where; none: as in the input, over the whole clip."
    )

    @property
    def default_name(self) -> str:
        """The name of one that gives none: its type, where it is about no one effector."""
        return self.type

    @property
    def met_within(self) -> Tolerance:
        """The tolerance, a bare number in degrees where the constraint is an angle."""
        tolerance = self.tolerance or Tolerance()
        return tolerance if self.has_position else tolerance.as_angle()

    @property
    def uses_reference(self) -> bool:
        """Whether anything is taken from the reference."""
        return self.follow == "reference"

    @property
    def counts_for_strict(self) -> bool:
        """Whether --strict fails where this constraint is not met."""
        if self.tolerance is not None:
            return not self.tolerance.off
        return not self.only_warns and any(point.during is None for point in self.points)

    def with_defaults(self, defaults: "Defaults") -> Self:
        """Return the constraint with the spec's defaults for keys that it does not give itself."""
        own = self.model_keys.keys() - self.given
        return self.changed({name: value for name, value in defaults.attributes() if name in own})

    def own_values(self) -> Iterator[OwnValue]:
        """Yield the values of the keys that not every constraint has."""
        for attribute, found in self.model_keys.items():
            if attribute != "type" and attribute not in ConstraintItem.model_keys:
                yield OwnValue(found.name, self.keys_of(found.name), found.kind, getattr(self, attribute))

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        for i, point in mappings_in(data, "points"):
            for key in point:
                if key in Point.model_keys and key not in (*_TIME_KEYS, *cls.point_keys):
                    types = [name for name, other in TYPES.items() if key in other.point_keys]
                    yield Fault(f"belongs to {type_words(types)}, not {data.get('type')}", ("points", i, key))
        tolerance = data.get("tolerance")
        if isinstance(tolerance, dict):
            for key, has in (("position", cls.has_position), ("angle", cls.has_angle)):
                if key in tolerance and not has:
                    what = "an angle" if cls.has_angle else "a length"
                    yield Fault(f"does not go with {data.get('type')}: its tolerance is {what}", ("tolerance", key))


class Recruiting(SpecModel):
    """What a constraint has that chooses its joints."""

    recruit: Recruit = spec_key(
        kinds.RECRUIT,
        default=Recruit(),
        description="Joints that may move: all (to the root, with its translation), {up_to: joint}, {levels: n}, "
        "{joints: [...]} (see defaults).",
    )


class Placed(SpecModel):
    """What a constraint has that is measured in some frame of coordinates."""

    measure_keys: ClassVar[tuple[str, ...]] = ("frame", "relative_to")
    between_keys: ClassVar[tuple[Mapping[str, Any], ...]] = (NOT_TWO_FRAMES,)

    frame: kinds.Frame = spec_key(
        kinds.FRAME,
        default="world",
        description="Axes of positions, shifts and orientations: world, or the character's heading.",
    )
    relative_to: str | None = spec_key(
        kinds.JOINT, default=None, description="Measure in this joint's frame instead of the world's."
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        yield from measure_faults(data)


class Defaults(SpecModel):
    """What constraints use that do not say otherwise."""

    ease_in: Duration = spec_key(
        kinds.DURATION, default=EASE, description="Ramp from the input before the first point."
    )
    ease_out: Duration = spec_key(
        kinds.DURATION, default=EASE, description="Ramp back to the input after the last point."
    )
    weight: float = spec_key(kinds.number(above=0.0), default=1.0, description="Weight in a layer.")
    recruit: Recruit = spec_key(kinds.RECRUIT, default=Recruit(), description="Joints that may move.")
