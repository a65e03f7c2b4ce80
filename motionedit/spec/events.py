"""Events of a spec: instants with names, given by frame, by clip, by a CSV file, or found by a rule."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any, Literal, get_args

from motionedit.dataclass import dataclass, replace
from motionedit.spec import kinds, scalars
from motionedit.spec.faults import Fault, FaultyValueError, faulty, show
from motionedit.spec.model import Context, Kind, SpecModel, spec_key
from motionedit.spec.nested import mapping, reference_to
from motionedit.spec.times import (
    INSTANT_WORDS,
    Interval,
    Time,
    parse_event_name,
    parse_instant,
    parse_interval,
    unknown_event,
)
from motionedit.spec.values import EffectorSpec

FRAMES_WORDS = "a frame for all clips, a CSV file with the columns clip,frame, or {CLIP: FRAME, ...}"
# A frame, or a time whose frame depends on the clip.
When = int | Time


@dataclass(frozen=True)
class EventFrames:
    """Frames or times of an event: `every` for all clips, or `by_clip`, read from `file` where that is not None.

    The keys of `by_clip` are relative paths or stems of clips, as written.
    """

    every: When | None = None
    by_clip: Mapping[str, When] = field(default_factory=dict)
    file: Path | None = None


def _event_frames(value: object, context: Context) -> EventFrames:
    if isinstance(value, str):
        file = Path(value)
        if context.folder is None:
            return EventFrames(file=file)
        # Imported here: most specs name no file.
        from motionedit.spec.event_table import read_event_table

        table = read_event_table(context.folder / file, label=context.label_of(value))
        return EventFrames(by_clip=table, file=context.folder / file)
    if isinstance(value, dict):
        faults: list[Fault] = []
        by_clip: dict[str, When] = {}
        for clip, frame in value.items():
            try:
                if frame is None:
                    raise faulty("needs a frame")
                by_clip[clip] = _when(frame)
            except FaultyValueError as error:
                faults += [fault.under(clip) for fault in error.faults]
        if faults:
            raise FaultyValueError(faults)
        return EventFrames(by_clip=by_clip)
    if isinstance(value, list):
        raise faulty(f"must be {FRAMES_WORDS}; not {show(value)}")
    return EventFrames(every=scalars.whole(value, at_least=0))


def _when(value: object, words: str = INSTANT_WORDS) -> When:
    return parse_instant(value, words=words) if isinstance(value, str) else scalars.whole(value, at_least=0)


_FRAME = {"type": "integer", "minimum": 0}
_WHEN = kinds.INSTANT.json
# Each rule looks at a whole clip, and rules wait for others.
MOST_EVENTS = 1000
FRAMES = Kind(
    _event_frames,
    FRAMES_WORDS,
    {
        "anyOf": [
            _FRAME,
            {"type": "string", "minLength": 1},
            {"type": "object", "additionalProperties": _WHEN},
        ]
    },
)


def _event_in(value: object, context: Context) -> str:
    name = parse_event_name(value)
    if context.events is not None and name not in context.events:
        raise faulty(unknown_event(name, tuple(sorted(context.events))))
    return name


EVENT = Kind(_event_in, "an event's name", kinds.EVENT_NAME.json)
Measure = Literal["height", "speed", "distance"]
MEASURE = kinds.word(*get_args(Measure))


class DetectRule(SpecModel):
    """The frame at which a measure of an effector is smallest or largest."""

    exactly_one = (("minimum_of", "maximum_of"),)
    at_most_one = (("between", "after"),)
    between_keys = (
        {
            "if": {
                "anyOf": [
                    {"properties": {key: {"const": "distance"}}, "required": [key]}
                    for key in ("minimum_of", "maximum_of")
                ]
            },
            "then": {"required": ["to"]},
            "else": {"not": {"required": ["to"]}},
        },
    )

    effector: EffectorSpec = spec_key(kinds.EFFECTOR, description="The point that is watched.")
    minimum_of: Measure | None = spec_key(
        MEASURE,
        default=None,
        description="The event is where this is smallest: height over the ground, speed, or distance to the point "
        "`to`. One of minimum_of, maximum_of is needed.",
    )
    maximum_of: Measure | None = spec_key(
        MEASURE, default=None, description="The event is where this is largest; as minimum_of."
    )
    to: scalars.Vector | None = spec_key(
        kinds.VECTOR,
        default=None,
        description="The point distances are measured to, in clip units; needed for distance.",
    )
    between: Interval | None = spec_key(
        kinds.INTERVAL, default=None, description="Only frames of this interval are looked at (default: all)."
    )
    after: str | None = spec_key(
        EVENT, default=None, description="Only frames after this other event are looked at; instead of between."
    )

    @property
    def measure(self) -> Measure:
        """What is measured: height, speed or distance."""
        measure = self.minimum_of or self.maximum_of
        if measure is None:
            raise ValueError("a rule has one of minimum_of, maximum_of")
        return measure

    @property
    def is_minimum(self) -> bool:
        """Whether the smallest value is wanted, else the largest."""
        return self.minimum_of is not None

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        measures = [data[key] for key in ("minimum_of", "maximum_of") if key in data]
        if "distance" in measures and "to" not in data:
            yield Fault("is missing; distance is measured to a point [x, y, z]", ("to",))
        if "to" in data and measures and "distance" not in measures:
            yield Fault("belongs to distance; height and speed need no point", ("to",))


class EventSpec(SpecModel):
    """One event: known frames, and a rule for the clips that have none."""

    at_least_one = (("frames", "detect"),)

    frames: EventFrames | None = spec_key(
        FRAMES,
        default=None,
        description="0-based frames in the input clips: one for all, a CSV file (columns clip,frame; relative to the "
        "spec), or by clip (relative path or unique stem), where times such as 3.76s may stand, too.",
    )
    detect: DetectRule | None = spec_key(
        replace(mapping(DetectRule), null=True),
        default=None,
        description="How to find the frame in clips that are not listed.",
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        if data.get("detect", ...) is None:
            yield Fault("needs a value: a rule with an effector and minimum_of or maximum_of", ("detect",))


def event(model: type[EventSpec]) -> Kind:
    """Return the kind of events: a bare frame, ``hit: 94``, stands for ``hit: {frames: 94}``; so does a time."""
    words = "a frame such as 94, a time such as 3.76s or 71.2%, or {frames: ...} or {detect: ...}"

    def parse(value: object, context: Context) -> EventSpec:
        if isinstance(value, (bool, list)):
            raise faulty(f"must be {words}; not {show(value)}")
        if isinstance(value, (int, float, str)):
            return model().changed({"frames": EventFrames(every=_when(value, words)), "given": frozenset({"frames"})})
        return model.parse(value, context)

    return Kind(parse, words, {"anyOf": [_WHEN, reference_to(model)]}, models=(model,))


def event_faults(events: object) -> Iterator[Fault]:
    """Yield what is wrong with the names of events, and rules that wait for one another in a ring."""
    if not isinstance(events, dict):
        return
    if len(events) > MOST_EVENTS:
        yield Fault(f"are {len(events)}; one spec has {MOST_EVENTS} at most: they are asked for together")
        return
    for name in events:
        try:
            kinds.EVENT_NAME.parse(name, Context())
        except FaultyValueError as error:
            yield from (fault.under(name) for fault in error.faults)
    waits = {name: _events_of_rule(event) & events.keys() for name, event in events.items()}
    order = {name: place for place, name in enumerate(events)}
    for name in events:
        ring = _ring(name, waits)
        # Each ring is reported once, at its first event in the file.
        if ring and name == min(ring, key=order.__getitem__):
            yield Fault(f"waits for itself: {' -> '.join([*ring, name])}; let one rule name no event", (name,))


def _events_of_rule(event: object) -> set[str]:
    rule = event.get("detect") if isinstance(event, dict) else None
    if not isinstance(rule, dict):
        return set()
    names = {rule["after"]} if isinstance(rule.get("after"), str) else set()
    try:
        interval = parse_interval(rule.get("between"))
    except FaultyValueError:
        return names
    return names | {time.event for time in (interval.start, interval.stop) if time.event is not None}


def _ring(start: str, waits: Mapping[str, set[str]]) -> list[str]:
    """Return the shortest way from an event back to itself, [] where there is none."""
    ways = [[start]]
    seen: set[str] = set()
    while ways:
        way = ways.pop(0)
        for name in sorted(waits[way[-1]]):
            if name == start:
                return way
            if name not in seen:
                seen.add(name)
                ways.append([*way, name])
    return []
