"""The types of constraints of edit-prioritized, each with the keys it may have; a new one is a class here, [PRIO] 4."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from motionedit.spec import kinds
from motionedit.spec.constraints import TYPES, ConstraintItem, Placed, Recruiting, type_words
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.items import EFFECTOR_KEYS, EffectorItem
from motionedit.spec.model import Context, Kind, mappings_in, spec_key
from motionedit.spec.nested import reference_to
from motionedit.spec.plants import PLANTS, PlantsSpec
from motionedit.spec.points import LENGTH_KEYS, SPLINE_KEYS
from motionedit.spec.scalars import Vector, one_of, word
from motionedit.spec.values import EffectorSpec, parse_effectors

_AXES = (
    "Axes that count, the file's or those of frame: or relative_to:; default: all of [x, y, z]. Along the ground are "
    "[x, z] where y is up, as in a heading, and [x, y] in a file whose z is up."
)


class PositionConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """An effector follows a trajectory: a shape constraint S(T(t))."""

    point_keys = ("position", "shift", *SPLINE_KEYS)
    measure_keys = ("frame", "relative_to", "axes")

    type: Literal["position"] = spec_key(kinds.constant("position"), description="The type: position.")
    axes: tuple[int, ...] = spec_key(kinds.AXES, default=(0, 1, 2), description=_AXES)


class OrientationConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """A joint is turned as asked."""

    point_keys = ("orientation", "turn")
    has_position = False
    has_angle = True

    type: Literal["orientation"] = spec_key(kinds.constant("orientation"), description="The type: orientation.")


class PoseConstraint(Recruiting, Placed, EffectorItem, ConstraintItem):
    """Position and orientation together: a footplant that cannot roll."""

    point_keys = ("position", "shift", "orientation", "turn", *SPLINE_KEYS)
    has_angle = True

    type: Literal["pose"] = spec_key(kinds.constant("pose"), description="The type: pose.")


class ComConstraint(Recruiting, ConstraintItem):
    """The center of mass keeps its place over the support, section 4.3."""

    point_keys = ("shift", *SPLINE_KEYS)
    measure_keys = ("frame", "axes")
    only_warns = True

    type: Literal["com"] = spec_key(kinds.constant("com"), description="The type: com.")
    support: tuple[str, ...] | None = spec_key(
        kinds.FEET,
        default=None,
        description="Joints the body stands on, the set A; default: feet and toes found in the skeleton.",
    )
    relative_to: Literal["support", "world"] = spec_key(
        kinds.word("support", "world"),
        default="support",
        description="support: moves as the other constraints move the support; world: the input's own path.",
    )
    frame: kinds.Frame = spec_key(
        kinds.FRAME, default="world", description="Axes of shifts: world, or the character's heading."
    )
    axes: tuple[int, ...] = spec_key(kinds.AXES, default=(0, 1, 2), description=_AXES)

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
    between_keys = (
        *Placed.between_keys,
        {"anyOf": [{"required": ["target"]}, {"required": ["points"]}]},
        {"not": {"required": ["target", "relative_to"]}},
        {
            "if": {"required": ["target"]},
            "then": {"properties": {"points": {"items": {"not": {"required": ["position"]}}}}},
            "else": {"properties": {"points": {"items": {"required": ["position"]}, "minItems": 1}}},
        },
    )

    type: Literal["aim"] = spec_key(kinds.constant("aim"), description="The type: aim.")
    axis: Vector = spec_key(kinds.DIRECTION, description="The direction that looks, in the joint's frame; any length.")
    target: str | None = spec_key(
        kinds.JOINT, default=None, description="The joint that is looked at, instead of positions in points."
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        if "target" in data and "relative_to" in data:
            yield Fault("stands beside target, whose frame it is in; give one of them", ("relative_to",))
        if _joints_of(data.get("effector")) & _joints_of(data.get("target")):
            yield Fault("is the joint that looks, which never moves against itself; name another joint", ("target",))
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
    """Joints keep the local rotations they have in the input, or take those of the reference."""

    has_position = False
    has_angle = True
    only_warns = True

    type: Literal["posture"] = spec_key(kinds.constant("posture"), description="The type: posture.")
    joints: tuple[str, ...] = spec_key(kinds.JOINTS, description="The joints that keep their rotations.")


class DistanceConstraint(Recruiting, EffectorItem, ConstraintItem):
    """Two points of the body are as far from each other as asked, or not nearer, or not farther."""

    point_keys = LENGTH_KEYS

    type: Literal["distance"] = spec_key(kinds.constant("distance"), description="The type: distance.")
    to: EffectorSpec = spec_key(kinds.EFFECTOR, description="The point that the distance is to.")

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        joints = _joints_of(data.get("effector"))
        if joints & _joints_of(data.get("to")):
            yield Fault("is on the effector's own joint, which it never moves against; name another joint", ("to",))
        bounds = [(i, {"at_least", "at_most"} & point.keys()) for i, point in mappings_in(data, "points")]
        for i, bound in bounds[1:]:
            if bound != bounds[0][1]:
                what = "points of one constraint have at_least, or at_most, or neither, all alike"
                yield Fault(f"{what}; make this one another constraint", ("points", i))


def _joints_of(effector: object) -> set[str]:
    """Return the joints of an effector or a list of them; none of a faulty one, which is refused itself."""
    try:
        return {each.joint for each in parse_effectors(effector)}
    except FaultyValueError:
        return set()


class _Timeless(Recruiting, ConstraintItem):
    """One that acts without times of its own."""

    @classmethod
    def key_names(cls) -> tuple[str, ...]:
        """Return its keys: it has no times."""
        return tuple(key for key in super().key_names() if key not in ("ease_in", "ease_out", "points"))


class FloorConstraint(_Timeless):
    """Nothing of some points of the body goes below a height, over the whole clip."""

    only_warns = True

    type: Literal["floor"] = spec_key(kinds.constant("floor"), description="The type: floor.")
    effector: str | tuple[EffectorSpec, ...] = spec_key(
        kinds.BODY_POINTS,
        default="feet",
        description="What stays above: feet (feet and toes found in the skeleton), all (joints and end sites), or a "
        "list of effectors, which is one constraint.",
    )
    height: float = spec_key(kinds.HEIGHT, default=0.0, description="The floor's height along up, clip units.")


class FootplantsConstraint(_Timeless):
    """Planted feet stand: each plant in one place, heel and toe, rolling over the toe as in the input."""

    has_angle = True
    only_warns = True

    type: Literal["footplants"] = spec_key(kinds.constant("footplants"), description="The type: footplants.")
    feet: str | tuple[str, ...] = spec_key(
        kinds.ANKLES, default="auto", description="Which feet: auto (both), or a list of ankles."
    )
    plants: PlantsSpec = spec_key(
        PLANTS,
        default=PlantsSpec(),
        description="When they stand: auto (as `info --contacts` shows them), a CSV file (clip,foot,part,first,last), "
        "or intervals by ankle.",
    )
    height: str | float = spec_key(
        kinds.OWN_HEIGHT,
        default="input",
        description="input: each plant keeps its own height; a number: the lower of heel and toe stands on that height "
        "along up, clip units, and the body comes along.",
    )
    at: Literal["input", "path"] = spec_key(
        kinds.word("input", "path"),
        default="input",
        description="input: plants stay where they are; path: each moves and turns, as a whole, where positions asked "
        "of the root take it, along the axes that count, and the body turns with the path.",
    )

    @property
    def uses_reference(self) -> bool:
        """Whether anything is taken from the reference: plants and places, where there is one."""
        return True


def _constraint(value: object, context: Context) -> ConstraintItem:
    if not isinstance(value, dict):
        raise faulty(f"must be a mapping with a type, not {show(value)}")
    names = tuple(TYPES)
    if "type" not in value:
        raise faulty(f"is missing; it is {one_of(names)}", "type")
    try:
        word(value["type"], names)
    except FaultyValueError as error:
        raise faulty(str(error), "type") from None
    return TYPES[value["type"]].parse(value, context)


CONSTRAINT = Kind(
    _constraint,
    "a mapping with a type",
    {"oneOf": [reference_to(model) for model in TYPES.values()]},
    models=tuple(TYPES.values()),
)


def _foreign_keys(type_name: str) -> dict[str, str]:
    """Return what to say of each key that stands elsewhere: in points, in the effector, in other types."""
    owners: dict[str, list[str]] = {}
    for other, model in TYPES.items():
        for key in model.key_names():
            owners.setdefault(key, []).append(other)
    model = TYPES[type_name]
    foreign = {key: f"belongs to {type_words(names)}, not {type_name}" for key, names in owners.items()}
    if "effector" in model.key_names():
        foreign |= EFFECTOR_KEYS
    if "points" in model.key_names():
        foreign |= {key: f"belongs to a point, as points: [{{{key}: ...}}]" for key in ("at", "hold", "during")}
        foreign |= {key: f"belongs to a point, as points: [{{at: ..., {key}: ...}}]" for key in model.point_keys}
    return {key: text for key, text in foreign.items() if key not in model.key_names()}


for _name, _model in TYPES.items():
    _model.foreign_keys = _foreign_keys(_name)
