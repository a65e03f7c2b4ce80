"""The spec of normalize: clips of one behaviour onto one timeline, [PC] section 5."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from motionedit.spec import kinds, times
from motionedit.spec.document import EventDocument
from motionedit.spec.events import EventSpec, event
from motionedit.spec.faults import Fault, faulty
from motionedit.spec.model import Context, Kind, SpecModel, spec_key
from motionedit.spec.nested import by_name, mapping
from motionedit.spec.times import Time


def _target(value: object, _context: Context) -> object:
    if value == "mean":
        return "mean"
    time = times.parse_time(value)
    if time.event is not None:
        raise faulty(f"must be mean or a time of the normalized clip, such as 94, 3.76s or 71.2%; not '{value}'")
    return time


TARGET = Kind(
    _target,
    "mean or a time of the normalized clip",
    {"anyOf": [{"const": "mean"}, kinds.TIME.json]},
)


def _align_at(value: object, context: Context) -> str:
    if value in ("first", "event"):
        return str(value)
    name = times.parse_event_name(value)
    if context.events is not None and name not in context.events:
        raise faulty(times.unknown_event(name, tuple(sorted(context.events))))
    return name


ALIGN_AT = Kind(_align_at, "first or an event's name", {**kinds.EVENT_NAME.json, "not": {"const": "mean"}})


class Align(SpecModel):
    """How clips are laid over each other on the ground plane."""

    heading: bool = spec_key(kinds.FLAG, default=True, description="Turn all clips to one heading.")
    position: bool = spec_key(kinds.FLAG, default=True, description="Move all clips to one place on the ground.")
    at: str = spec_key(
        ALIGN_AT,
        default="first",
        description="The instant at which they are aligned: first (frame), or an event's name.",
    )


class TimelineEvent(EventSpec):
    """An event, and where it goes on the common timeline."""

    target: Time | str = spec_key(
        TARGET,
        default="mean",
        description="Where the event goes: mean (the mean key frame, eq. 14) or a time of the normalized clip.",
    )


class NormalizeSpec(EventDocument):
    """Everything normalize is told."""

    schema_id: str = spec_key(
        kinds.schema_id("normalize"),
        default="motionedit/normalize/v1",
        name="schema",
        description="Which spec this is.",
    )
    frames: int | str = spec_key(
        kinds.either(("mean",), kinds.whole(at_least=2, largest=1_000_000)),
        default="mean",
        description="Frames of the normalized clips: mean (the mean duration, eq. 13) or a number.",
    )
    frame_rate: float | None = spec_key(
        kinds.number(above=0.0, smallest=0.01, largest=1e5),
        default=None,
        description="Hz of the normalized clips; default: the clips' own, an error where they differ.",
    )
    align: Align = spec_key(
        mapping(Align), default=Align(), description="Alignment on the ground; edit-pc undoes it on output."
    )
    from_time: Time | None = spec_key(
        kinds.TIME,
        default=None,
        name="from",
        description="Where each clip begins to count, an event or another time; default: its first frame. Of a cyclic "
        "motion one cycle, from one heel strike to the next, is normalized.",
    )
    to_time: Time | None = spec_key(
        kinds.TIME, default=None, name="to", description="Where each clip ends to count; default: its last frame."
    )
    rest_pose: Literal["drop", "keep"] = spec_key(
        kinds.word("drop", "keep"), default="drop", description="What becomes of a T-pose in front of a take."
    )
    events: Mapping[str, TimelineEvent] = spec_key(
        by_name(event(TimelineEvent)),
        default={},
        description="Instants that are brought to the same frame in all clips; none: durations only.",
        more={"propertyNames": dict(kinds.EVENT_NAME.json)},
    )

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from super().faults_between_keys(data)
        align, events = data.get("align"), data.get("events")
        count = len(events) if isinstance(events, dict) else 0
        if isinstance(align, dict) and align.get("at") == "event" and count != 1:
            yield Fault(f"must name the event: there are {count}", ("align", "at"))

    @property
    def align_event(self) -> str | None:
        """The event at which clips are aligned, None for the first frame."""
        if self.align.at == "first":
            return None
        return next(iter(self.events)) if self.align.at == "event" else self.align.at

    @property
    def crop(self) -> dict[str, str]:
        """What counts of each clip, as the spec has it: times by `from` and `to`, where they are given."""
        given = {"from": self.from_time, "to": self.to_time}
        return {key: time.text for key, time in given.items() if time is not None}
