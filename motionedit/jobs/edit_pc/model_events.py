"""The frames of a model's events in a clip: by the edit's spec, by the database, or by the model's own rules."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from motionedit.errors import ClipError, ModelError
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.crop import crop_events
from motionedit.jobs.clip.events import event_frames, explicit_events
from motionedit.jobs.clip.kept_rules import KeptRules
from motionedit.spec.event_names import events_named
from motionedit.spec.faults import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.pca.model import DatabaseClip, MotionModel
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.spec.edit_pc import EditPcSpec
    from motionedit.spec.load import LoadedSpec


_KNOWN_BY = "a clip is known by its name and its bytes"


def refuse_unknown_events(loaded: LoadedSpec[EditPcSpec], model: MotionModel) -> None:
    """Raise a SpecError where a goal's time names an event that neither the spec nor the model has.

    Or where the spec has an event that nothing is at, and that is all but named as one that the model has.
    """
    known = sorted({*loaded.model.events, *events_of_model(model)})
    for i, goal in enumerate(loaded.model.goals):
        if goal.at.event is not None and goal.at.event not in known:
            listed = ", ".join(f"'{name}'" for name in known) or "none"
            message = f"no event '{goal.at.event}' in this spec or in the model; there are: {listed}"
            raise loaded.error(("goals", i, "at"), message)
    own = loaded.model.events
    used = {*events_of_model(model), *events_named(loaded.model.goals), *events_named(own)}
    for name in (each for each in own if each not in used):
        meant = nearest(name, [each for each in events_of_model(model) if each not in own])
        if meant is not None:
            raise loaded.error(("events", name), f"nothing is at this event; did you mean the model's '{meant}'?")


def events_of_model(model: MotionModel) -> list[str]:
    """Return the events that a model needs in a clip: those of its timeline, and those that its clips were cut at."""
    return [*dict(model.timeline.events), *crop_events(model.rules.get("crop", {}))]


def events_for_model(
    loaded: LoadedSpec[EditPcSpec],
    model: MotionModel,
    facts: ClipFacts,
    task: ClipTask,
    *,
    model_label: str,
    others: Sequence[str],
) -> dict[str, float]:
    """Return the frames of all events of the spec and the model in a clip.

    The edit's spec comes first; then, for a clip of the database (same stem and content), the model; then the
    model's rule.

    Raises
    ------
    ClipError
        An event of the model has no frame in this clip.
    SpecError
        As `event_frames`.
    """
    known = explicit_events(loaded, facts.clip, relative=task.relative, others=others)
    place = resolve.Place(loaded, ("events",), task.label)
    rules = dict(loaded.model.events)
    database = _database_events(model, facts, task)
    needed = events_of_model(model)
    for name in needed:
        given = name in known or (name in rules and rules[name].detect is not None)
        if not given and name in database:
            known[name] = database[name]
    frames = event_frames(rules, facts, place, known=known)
    missing = [name for name in needed if name not in frames]
    if missing:
        own = resolve.Place(KeptRules(model_label), ("events",), task.label)
        frames = event_frames(_model_rules(model, missing, label=model_label), facts, own, known=frames)
    for name in needed:
        if name not in frames:
            message = (
                f"no frame for the model's event '{name}'{_why_unknown(model, facts, task)}; give it in the spec, as "
                f"events: {{{name}: {{frames: {{{PurePosixPath(task.relative).stem}: FRAME}}}}}}"
            )
            raise ClipError(message, file=task.label)
    return frames


def _database_events(model: MotionModel, facts: ClipFacts, task: ClipTask) -> dict[str, float]:
    for clip in model.clips:
        if _is_named(clip, task) and clip.digest == facts.clip.sha256:
            return dict(clip.events)
    return {}


def _why_unknown(model: MotionModel, facts: ClipFacts, task: ClipTask) -> str:
    """Return why a clip that is like one of the database is not taken for it, or an empty text."""
    for clip in model.clips:
        if clip.digest == facts.clip.sha256 and not _is_named(clip, task):
            return f": it has the bytes of the database's '{clip.name}' under another name; {_KNOWN_BY}"
    for clip in model.clips:
        if _is_named(clip, task) and clip.digest != facts.clip.sha256:
            return f": it has the name of the database's '{clip.name}' and other bytes; {_KNOWN_BY}"
    return ""


def _is_named(clip: DatabaseClip, task: ClipTask) -> bool:
    return PurePosixPath(clip.name).name == PurePosixPath(task.relative).stem


def _model_rules(model: MotionModel, names: Sequence[str], *, label: str) -> dict[str, Any]:
    """Return the model's rules as the spec of normalize would hold them."""
    from motionedit.spec.events import EventSpec
    from motionedit.spec.model import Context

    rules = model.rules["events"]
    context = Context()
    try:
        return {name: EventSpec.parse({"detect": rules[name]}, context) for name in names if rules.get(name)}
    except ValueError as error:
        message = "its rules for events are damaged; make it again with 'motionedit fit-pca'"
        raise ModelError(message, file=label) from error
