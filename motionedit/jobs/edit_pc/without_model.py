"""What a spec of edit-pc names and a clip lacks, as far as that is known without the model."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from motionedit.dataclass import replace
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.events import event_frames, explicit_events, rule_effectors, waits_for
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.edit_pc.goals import refuse_unknown_joints

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_pc import EditPcSpec
    from motionedit.spec.events import EventSpec
    from motionedit.spec.load import LoadedSpec


def refuse_lacking(loaded: LoadedSpec[EditPcSpec], facts: ClipFacts, task: ClipTask, *, others: Sequence[str]) -> None:
    """Raise the errors of all that the spec names and the clip lacks: joints, end sites, frames.

    What is at an event that the spec does not find in this clip is let pass: the model may know it.

    Raises
    ------
    SpecError, MotionEditErrors
        What the clip lacks.
    """
    faults, none = Faults(), dict[str, float]()
    # Whether a rest pose counts is the model's rule.
    facts = replace(facts, first=0)
    place = resolve.Place(loaded, ("events",), task.label)
    known = faults.get(
        partial(explicit_events, loaded, facts.clip, relative=task.relative, others=others), otherwise=none
    )
    rules = {name: event.detect for name, event in loaded.model.events.items() if event.detect and name not in known}
    faults.get(partial(rule_effectors, rules, facts, place), otherwise=None)
    own = _found_alone(loaded.model.events, known)
    events = faults.get(partial(event_frames, own, facts, place, known=known), otherwise=none)
    faults.get(partial(refuse_unknown_joints, loaded, facts), otherwise=None)
    for i, goal in enumerate(loaded.model.goals):
        if goal.at.event is None or goal.at.event in events:
            at = resolve.Place(loaded, ("goals", i, "at"), task.label)
            faults.get(partial(resolve.frame, goal.at, at, facts.clip.motion, events=events), otherwise=None)
    faults.raise_all(f"what the spec names and {task.label} lacks")


def _found_alone(specs: Mapping[str, EventSpec], known: Mapping[str, float]) -> dict[str, EventSpec]:
    """Return the events with a rule that waits for none but those that are known or found alone."""
    found = {name: event for name, event in specs.items() if event.detect is not None}
    while waiting := [name for name, event in found.items() if _waits(event) - found.keys() - known.keys()]:
        for name in waiting:
            del found[name]
    return found


def _waits(event: EventSpec) -> set[str]:
    return set() if event.detect is None else waits_for(event.detect)
