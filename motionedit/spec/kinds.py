"""The kinds of values that spec models are made of, each with its parser, its words and its JSON Schema."""

from collections.abc import Callable, Sequence
from typing import Any, Literal, get_args

from motionedit.dataclass import replace
from motionedit.spec import grammar, scalars, times, values
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.model import Context, Kind
from motionedit.spec.times import Interval, Time

Schema = dict[str, Any]


def _text(pattern: str) -> Schema:
    return {"type": "string", "pattern": grammar.whole(pattern)}


_NAME: Schema = {"type": "string", "minLength": 1}
_NUMBER: Schema = {"type": "number", "minimum": -scalars.LARGEST, "maximum": scalars.LARGEST}
_VECTOR: Schema = {"type": "array", "items": _NUMBER, "minItems": 3, "maxItems": 3}
_JOINTS: Schema = {"type": "array", "items": _NAME, "minItems": 1, "uniqueItems": True}
_POSITIVE: Schema = {"type": "number", "exclusiveMinimum": 0, "maximum": scalars.LARGEST}
_FRAME: Schema = {"type": "integer", "minimum": 0}
_TIME: Schema = {"anyOf": [_FRAME, _text(grammar.TIME)]}
_INSTANT: Schema = {"anyOf": [_FRAME, _text(grammar.PLAIN_INSTANT)]}
_DURATION: Schema = {"anyOf": [_FRAME, _text(grammar.DURATION)]}
_EVENT_NAME: Schema = {**_text(grammar.EVENT), "not": {"enum": list(times.RESERVED_NAMES)}}

OFF_AS_FALSE: Schema = {"const": False, "description": "off, as YAML 1.1 reads it"}


def _closed(properties: Schema, *required: str) -> Schema:
    found: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
    return {**found, "required": list(required)} if required else found


_EFFECTOR: Schema = {
    "anyOf": [
        _NAME,
        _closed({"joint": _NAME, "offset": _VECTOR}, "joint"),
        _closed({"end_site": _NAME, "index": {"type": "integer", "minimum": 0}}, "end_site"),
    ]
}
_ORIENTATION: Schema = {
    "anyOf": [
        _closed({"euler": _VECTOR, "order": _text(grammar.ORDER)}, "euler", "order"),
        _closed(
            {"quaternion": {**_VECTOR, "minItems": 4, "maxItems": 4, "not": {"items": {"const": 0}}}}, "quaternion"
        ),
        _closed({"rotation_vector": _VECTOR}, "rotation_vector"),
    ]
}
_RECRUIT: Schema = {
    "anyOf": [
        {"const": "all"},
        _closed({"up_to": _NAME}, "up_to"),
        _closed({"levels": {"type": "integer", "minimum": 1}}, "levels"),
        _closed({"joints": _JOINTS}, "joints"),
    ]
}


def _plainly(parse: Callable[[Any], object]) -> Callable[[Any, Context], object]:
    return lambda value, _context: parse(value)


def _unknown_events(named: Sequence[Time], context: Context) -> list[Fault]:
    known = context.events
    if known is None:
        return []
    return [
        Fault(times.unknown_event(time.event, tuple(sorted(known))), (i,))
        for i, time in enumerate(named)
        if time.event is not None and time.event not in known
    ]


def _time(value: object, context: Context) -> Time:
    time = times.parse_time(value)
    for fault in _unknown_events([time], context):
        raise faulty(fault.message)
    return time


def _interval(value: object, context: Context) -> Interval:
    interval = times.parse_interval(value)
    if faults := _unknown_events([interval.start, interval.stop], context):
        raise FaultyValueError(faults)
    return interval


def number(
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    smallest: float = scalars.SMALLEST,
    largest: float = scalars.LARGEST,
) -> Kind:
    """Return the kind of numbers within bounds, and of sizes that make sense."""
    lower = {"minimum": -largest if at_least is None else at_least} if above is None else {"exclusiveMinimum": above}
    json: Schema = {"type": "number", **lower, "maximum": largest if at_most is None else at_most}
    words = f"a number {scalars.range_words(above=above, at_least=at_least, at_most=at_most)}".rstrip()

    def parse(value: object, _context: Context) -> float:
        bounds = {"above": above, "at_least": at_least, "at_most": at_most}
        return scalars.number(value, **bounds, smallest=smallest, largest=largest)

    return Kind(parse, words, json)


def whole(*, at_least: int | None = None, null: bool = False, largest: int = int(scalars.LARGEST)) -> Kind:
    """Return the kind of whole numbers; with `null`, an empty value means no bound."""
    json: Schema = {
        "type": ["integer", "null"] if null else "integer",
        "minimum": -largest if at_least is None else at_least,
        "maximum": largest,
    }
    words = f"a whole number {scalars.range_words(at_least=at_least)}".rstrip()

    def parse(value: object, _context: Context) -> int:
        return scalars.whole(value, at_least=at_least, largest=largest)

    return Kind(parse, words, json, null=null)


def components() -> Kind:
    """Return the kind of numbers of principal components; a share of the variance is sent to its own key."""
    number = whole(at_least=1)

    def parse(value: object, context: Context) -> object:
        if isinstance(value, float) and 0.0 < value < 1.0:
            raise faulty(f"must be a whole number, not {show(value)}; a share of the variance is explained_variance")
        return number.parse(value, context)

    return replace(number, parse=parse)


def word(*choices: str) -> Kind:
    """Return the kind of a few words."""
    return Kind(lambda value, _context: scalars.word(value, choices), scalars.one_of(choices), {"enum": list(choices)})


def constant(text: str) -> Kind:
    """Return the kind of one word alone."""
    return Kind(lambda value, _context: scalars.word(value, (text,)), text, {"const": text, "type": "string"})


def either(choices: Sequence[str], other: Kind) -> Kind:
    """Return the kind of a few words or values of another kind."""
    words = scalars.one_of((*choices, other.wanted))

    def parse(value: object, context: Context) -> object:
        if isinstance(value, str) and value in choices:
            return value
        if isinstance(value, (str, bool, dict)):
            raise faulty(f"must be {words}, not {show(value)}")
        return other.parse(value, context)

    return Kind(parse, words, {"anyOf": [{"enum": list(choices)}, other.json]})


def or_off(kind: Kind) -> Kind:
    """Return a kind that has the word off, read from false too: so YAML 1.1 has it, and with it PyYAML."""

    def parse(value: object, context: Context) -> object:
        return kind.parse("off" if value is False else value, context)

    return Kind(parse, kind.wanted, {"anyOf": [*kind.json.get("anyOf", [kind.json]), OFF_AS_FALSE]}, null=kind.null)


def either_number(choice: str) -> Kind:
    """Return the kind of a word or a number."""

    def parse(value: object, _context: Context) -> object:
        return value if value == choice else scalars.number(value)

    return Kind(parse, f"{choice} or a number", {"anyOf": [{"const": choice}, _NUMBER]})


FLAG = Kind(_plainly(scalars.flag), "true or false", {"type": "boolean"})
NAME = Kind(lambda value, _context: scalars.name(value, what="a name"), "a name", _NAME)
JOINT = Kind(_plainly(values.parse_joint), "a joint's name", _NAME)
JOINTS = Kind(_plainly(values.parse_joints), "a list of joints", _JOINTS)
JOINTS_OR_NONE = Kind(
    lambda value, _context: scalars.names(value, what="a list of joints", empty=True),
    "a list of joints",
    {**_JOINTS, "minItems": 0},
)
# The same, where feet and toes found in the skeleton stand for what is not given.
FEET = Kind(_plainly(values.parse_joints), "a list of joints", _JOINTS)
# The same, where ankles found in the skeleton stand for `auto`.
ANKLES = either(("auto",), JOINTS)
OWN_HEIGHT = either_number("input")
VECTOR = Kind(_plainly(scalars.vector), "three numbers [x, y, z]", _VECTOR)
DIRECTION = Kind(_plainly(scalars.direction), "a direction [x, y, z]", {**_VECTOR, "not": {"items": {"const": 0}}})
AXES = Kind(
    _plainly(scalars.axes),
    "a list of some of x, y, z",
    {"type": "array", "items": {"enum": list(scalars.AXES)}, "minItems": 1, "uniqueItems": True},
)
TIME = Kind(_time, f"a time: {times.TIME_WORDS}", _TIME)
INSTANT = Kind(_plainly(times.parse_instant), times.INSTANT_WORDS, _INSTANT)
INTERVAL = Kind(_interval, "an interval [from, to]", {"type": "array", "items": _TIME, "minItems": 2, "maxItems": 2})
DURATION = Kind(_plainly(times.parse_duration), f"a duration: {times.DURATION_WORDS}", _DURATION)
EFFECTOR = Kind(_plainly(values.parse_effector), f"an effector: {values.EFFECTOR_WORDS}", _EFFECTOR)
EFFECTORS = Kind(
    _plainly(values.parse_effectors),
    f"an effector: {values.EFFECTOR_WORDS}",
    {"anyOf": [*_EFFECTOR["anyOf"], {"type": "array", "items": _EFFECTOR, "minItems": 1}]},
)
BODY_POINTS = Kind(
    _plainly(values.parse_body_points),
    f"feet, all, or a list of effectors: {values.EFFECTOR_WORDS}",
    {"anyOf": [{"enum": list(values.BODY_PARTS)}, *EFFECTORS.json["anyOf"]]},
)
HEIGHT = number()
ORIENTATION = Kind(_plainly(values.parse_orientation), f"an orientation: {values.ORIENTATION_WORDS}", _ORIENTATION)
TOLERANCE = or_off(
    Kind(
        _plainly(values.parse_tolerance),
        "a number, {position: 0.5, angle: 0.1} or off",
        {
            "anyOf": [
                _POSITIVE,
                {"const": "off"},
                {**_closed({"position": _POSITIVE, "angle": _POSITIVE}), "minProperties": 1},
            ]
        },
    )
)
UNIT = Kind(
    _plainly(values.parse_unit),
    "m, cm, mm, in, cmu or a number of metres",
    {"anyOf": [{"enum": list(values.UNITS)}, _POSITIVE]},
)
RECRUIT = Kind(_plainly(values.parse_recruit), values.RECRUIT_WORDS, _RECRUIT)
Frame = Literal["world", "heading"]
FRAME = word(*get_args(Frame))
EVENT_NAME = Kind(_plainly(times.parse_event_name), "an event's name", _EVENT_NAME)


def schema_id(command: str) -> Kind:
    """Return the kind of a spec's first line."""
    text = f"motionedit/{command}/v1"

    def parse(value: object, _context: Context) -> str:
        if value != text:
            raise faulty(f"must be {text}, not {show(value)}")
        return text

    return Kind(parse, text, {"const": text})
