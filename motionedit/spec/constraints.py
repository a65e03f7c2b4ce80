"""The types of constraints of edit-prioritized, each with the keys it may have, [PRIO] section 4."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field

from motionedit.spec import kinds
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.items import EffectorItem, Item
from motionedit.spec.model import SpecModel, mappings_in
from motionedit.spec.points import SPLINE_KEYS, Point
from motionedit.spec.scalars import Vector, one_of, word
from motionedit.spec.times import Duration
from motionedit.spec.values import Recruit, Tolerance

EASE = Duration("0.8s", 0.8, is_seconds=True)
# Named in the contract for later work.
LATER_TYPES = ("footplants",)
_TIME_KEYS = ("hold", "during", "at")


class ConstraintItem(Item):
    """What every constraint has."""

    # Keys that a point may have beside its time, and whether a tolerance is a length or an angle.
    point_keys: ClassVar[tuple[str, ...]] = ()
    has_position: ClassVar[bool] = True
    has_angle: ClassVar[bool] = False
    # A constraint that --strict counts only where it is given a tolerance.
    only_warns: ClassVar[bool] = False

    priority: Annotated[int, kinds.whole()] = Field(
        default=1, description="Larger is more important; only the order matters. Equal ones share by weight."
    )
    weight: Annotated[float, kinds.number(above=0.0)] = Field(
        default=1.0, description="Weight among constraints of the same priority (see defaults)."
    )
    tolerance: Annotated[Tolerance | None, kinds.TOLERANCE] = Field(
        default=None,
        description="How near is met: clip units, degrees for orientation, aim and posture, {position, angle} for "
        "pose; off: may give way. Default 1 mm and 0.1 degree at leg length 0.85 m. Where none is given, --strict "
        "counts places and turns that have an at or a hold; com, aim, posture, and what has no points or only during, "
        "warn alone.",
    )
    ease_in: Annotated[Duration, kinds.DURATION] = Field(
        default=EASE, description="Ramp from the input's trajectory before the first point (see defaults)."
    )
    ease_out: Annotated[Duration, kinds.DURATION] = Field(
        default=EASE, description="Ramp back to the input's trajectory after the last point (see defaults)."
    )
    points: tuple[Point, ...] = Field(
        default=(), description="When and where; none: as in the input, over the whole clip."
    )

    @property
    def met_within(self) -> Tolerance:
        """The tolerance, a bare number in degrees where the constraint is an angle."""
        tolerance = self.tolerance or Tolerance()
        return tolerance if self.has_position else tolerance.as_angle()

    @property
    def counts_for_strict(self) -> bool:
        """Whether --strict fails where this constraint is not met."""
        if self.tolerance is not None:
            return not self.tolerance.off
        return not self.only_warns and any(point.during is None for point in self.points)

    def with_defaults(self, defaults: "Defaults") -> Self:
        """Return the constraint with the spec's defaults for keys that it does not give itself."""
        own = type(self).model_fields
        keys = [key for key in Defaults.model_fields if key in own and key not in self.model_fields_set]
        return self.model_copy(update={key: getattr(defaults, key) for key in keys})

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        for i, point in mappings_in(data, "points"):
            for key in point:
                if key in Point.model_fields and key not in (*_TIME_KEYS, *cls.point_keys):
                    types = [name for name, other in TYPES.items() if key in other.point_keys]
                    yield Fault(f"belongs to {_types(types)}, not {data.get('type')}", ("points", i, key))
        tolerance = data.get("tolerance")
        if isinstance(tolerance, dict):
            for key, has in (("position", cls.has_position), ("angle", cls.has_angle)):
                if key in tolerance and not has:
                    what = "an angle" if cls.has_angle else "a length"
                    yield Fault(f"does not go with {data.get('type')}: its tolerance is {what}", ("tolerance", key))
        if data.get("frame") == "heading" and "relative_to" in data and data.get("type") != "com":
            yield Fault("stands beside frame: heading; give one of them", ("relative_to",))


class Recruiting(SpecModel):
    """What a constraint has that chooses its joints."""

    recruit: Annotated[Recruit, kinds.RECRUIT] = Field(
        default=Recruit(),
        description="Joints that may move: all (to the root, with its translation), {up_to: joint}, {levels: n}, "
        "{joints: [...]} (see defaults).",
    )


class Placed(SpecModel):
    """What a constraint has that is measured in some frame of coordinates."""

    frame: Annotated[kinds.Frame, kinds.FRAME] = Field(
        default="world", description="Axes of positions, shifts and orientations: world, or the character's heading."
    )
    relative_to: Annotated[str | None, kinds.JOINT] = Field(
        default=None, description="Measure in this joint's frame instead of the world's."
    )


class PositionConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """An effector follows a trajectory: a shape constraint S(T(t))."""

    point_keys = ("position", "shift", *SPLINE_KEYS)

    type: Literal["position"] = Field(description="The type: position.")
    axes: Annotated[tuple[int, ...], kinds.AXES] = Field(
        default=(0, 1, 2), description="Axes that count; default: all of [x, y, z]."
    )


class OrientationConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """A joint is turned as asked."""

    point_keys = ("orientation",)
    has_position = False
    has_angle = True

    type: Literal["orientation"] = Field(description="The type: orientation.")


class PoseConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """Position and orientation together: a footplant that cannot roll."""

    point_keys = ("position", "shift", "orientation", *SPLINE_KEYS)
    has_angle = True

    type: Literal["pose"] = Field(description="The type: pose.")


class ComConstraint(Recruiting, ConstraintItem):
    """The center of mass keeps its place over the support, section 4.3."""

    point_keys = ("shift", *SPLINE_KEYS)
    only_warns = True

    type: Literal["com"] = Field(description="The type: com.")
    support: Annotated[tuple[str, ...] | None, kinds.JOINTS] = Field(
        default=None, description="Joints the body stands on, the set A; default: feet and toes found in the skeleton."
    )
    relative_to: Annotated[Literal["support", "world"], kinds.word("support", "world")] = Field(
        default="support",
        description="support: moves as the other constraints move the support; world: the input's own path.",
    )
    frame: Annotated[kinds.Frame, kinds.FRAME] = Field(
        default="world", description="Axes of shifts: world, or the character's heading."
    )
    axes: Annotated[tuple[int, ...], kinds.AXES] = Field(
        default=(0, 1, 2), description="Axes that count; default: all of [x, y, z]."
    )

    @property
    def default_name(self) -> str:
        """The name of one that gives none."""
        return self.type

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        recruit = data.get("recruit")
        for key in ("up_to", "levels"):
            if isinstance(recruit, dict) and key in recruit:
                yield Fault("does not go with com, which has no chain; use all or {joints: [...]}", ("recruit", key))


class AimConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """An axis of a joint looks at a point or at another joint."""

    point_keys = ("position", *SPLINE_KEYS)
    has_position = False
    has_angle = True
    only_warns = True

    type: Literal["aim"] = Field(description="The type: aim.")
    axis: Annotated[Vector, kinds.DIRECTION] = Field(
        description="The direction that looks, in the joint's frame; any length."
    )
    target: Annotated[str | None, kinds.JOINT] = Field(
        default=None, description="The joint that is looked at, instead of positions in points."
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        if "target" not in data and not data.get("points"):
            yield Fault("needs one of target, points: what shall be looked at")
        for i, point in mappings_in(data, "points"):
            if "target" in data and "position" in point:
                yield Fault("stands beside target; give one of them", ("points", i, "position"))
            if "target" not in data and "position" not in point and "during" not in point:
                yield Fault("is missing; it is three numbers [x, y, z]", ("points", i, "position"))
            if "target" not in data and "during" in point:
                yield Fault("needs a target: JOINT; at a position, use hold", ("points", i, "during"))


class PostureConstraint(ConstraintItem):
    """Joints keep the local rotations they have in the input."""

    has_position = False
    has_angle = True
    only_warns = True

    type: Literal["posture"] = Field(description="The type: posture.")
    joints: Annotated[tuple[str, ...], kinds.JOINTS] = Field(description="The joints that keep their rotations.")

    @property
    def default_name(self) -> str:
        """The name of one that gives none."""
        return self.type


class Defaults(SpecModel):
    """What constraints use that do not say otherwise."""

    ease_in: Annotated[Duration, kinds.DURATION] = Field(
        default=EASE, description="Ramp from the input before the first point."
    )
    ease_out: Annotated[Duration, kinds.DURATION] = Field(
        default=EASE, description="Ramp back to the input after the last point."
    )
    weight: Annotated[float, kinds.number(above=0.0)] = Field(default=1.0, description="Weight in a layer.")
    recruit: Annotated[Recruit, kinds.RECRUIT] = Field(default=Recruit(), description="Joints that may move.")


AnyConstraint = (
    PositionConstraint | OrientationConstraint | PoseConstraint | ComConstraint | AimConstraint | PostureConstraint
)


def _with_known_type(value: object) -> object:
    """Return the value itself where it is a mapping whose type is known; pydantic's union needs no words then."""
    if not isinstance(value, dict):
        raise faulty(f"must be a mapping with a type, not {show(value)}")
    names = tuple(TYPES)
    if "type" not in value:
        raise faulty(f"is missing; it is {one_of(names)}", "type")
    if value["type"] in LATER_TYPES:
        raise faulty(f"{value['type']} is not supported yet", "type")
    try:
        word(value["type"], names)
    except FaultyValueError as error:
        raise faulty(str(error), "type") from None
    return value


Constraint = Annotated[AnyConstraint, Field(discriminator="type"), BeforeValidator(_with_known_type)]

TYPES: dict[str, type[ConstraintItem]] = {
    "position": PositionConstraint,
    "orientation": OrientationConstraint,
    "pose": PoseConstraint,
    "com": ComConstraint,
    "aim": AimConstraint,
    "posture": PostureConstraint,
}


def _types(names: list[str]) -> str:
    return f"type {one_of(names)}"


def _foreign_keys(type_name: str) -> dict[str, str]:
    """Return what to say of each key that only other types have."""
    owners: dict[str, list[str]] = {}
    for other, model in TYPES.items():
        for key in model.key_names():
            owners.setdefault(key, []).append(other)
    return {
        key: f"belongs to {_types(names)}, not {type_name}" for key, names in owners.items() if type_name not in names
    }


for _name, _model in TYPES.items():
    _model.foreign_keys = _foreign_keys(_name)
