"""What stands at the top of every spec: events, the unit, which way is up."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

from motionedit.spec import kinds
from motionedit.spec.body import BodySpec
from motionedit.spec.events import EventSpec, event, event_faults
from motionedit.spec.faults import Fault
from motionedit.spec.model import SpecModel, spec_key
from motionedit.spec.nested import by_name, mapping
from motionedit.spec.values import Unit


class Document(SpecModel):
    """The keys that every spec may have."""

    # Whether times may name events that the spec does not list.
    knows_other_events: ClassVar[bool] = False

    events: Mapping[str, EventSpec] = spec_key(
        by_name(event(EventSpec)),
        default={},
        description="Names for instants, used wherever a time stands.",
        more={"propertyNames": dict(kinds.EVENT_NAME.json)},
    )
    unit: Unit | None = spec_key(
        kinds.UNIT,
        default=None,
        description="What a length of the clips is: m, cm, mm, in, cmu (1/0.45 inch) or a number of metres. Converts "
        "nothing; serves reports in millimetres and the damped solver.",
    )
    up: Literal["y", "z", "x", "-y", "-z", "-x", "auto"] = spec_key(
        kinds.word("y", "z", "x", "-y", "-z", "-x", "auto"),
        default="auto",
        description="The axis that points up; auto: by the floor, the OFFSETs and the way the body stands; "
        "of a model the one that its clips were normalized with.",
    )
    body: BodySpec = spec_key(
        mapping(BodySpec),
        default=BodySpec(),
        description="Which joint is what, where it cannot be told by names and lengths.",
    )

    @property
    def event_files(self) -> tuple[Path, ...]:
        """Files that frames of events were read from."""
        frames = [event.frames for event in self.events.values()]
        return tuple(found.file for found in frames if found is not None and found.file is not None)

    @classmethod
    def key_names(cls) -> tuple[str, ...]:
        """Return the keys of the spec, its own before those that all specs share."""
        names = super().key_names()
        shared = Document.model_keys
        return tuple(sorted(names, key=lambda name: name in shared))

    @classmethod
    def faults_between_keys(cls, data: Mapping[str, Any]) -> Iterator[Fault]:
        """Yield what is wrong between keys."""
        yield from (fault.under("events") for fault in event_faults(data.get("events")))
