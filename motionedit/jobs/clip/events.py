"""The frames of a clip's events: given by a spec, or found by a spec's rule."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.kinematics import effector_positions
from motionedit.core.timeline.events import Quantity, Search, find_event
from motionedit.jobs.clip import resolve

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.events import DetectRule, EventSpec


def event_frames(
    specs: Mapping[str, EventSpec], facts: ClipFacts, place: Place, *, known: Mapping[str, float]
) -> dict[str, float]:
    """Return the frame of every event of a clip that is known or has a rule; found ones to a part of a frame.

    Parameters
    ----------
    specs : mapping
        The events of a spec, or of the spec that a model's database was normalized by.
    place : Place
        Of the mapping `specs`.
    known : mapping
        Frames that need no rule.

    Raises
    ------
    SpecError
        Where a known frame is outside the clip, or a rule names what the clip lacks.
    """
    frames = dict(known)
    for name, frame in known.items():
        if not facts.first <= frame <= facts.last:
            message = (
                f"in {place.clip}: frame {frame:g} is outside the take, whose frames are {facts.first} to {facts.last}"
            )
            raise place.at(name).error(message)
    # A rule may wait for another's event; the spec has refused rings, so each round finds at least one.
    waiting = {name: spec.detect for name, spec in specs.items() if spec.detect is not None and name not in frames}
    while waiting:
        ready = [name for name, rule in waiting.items() if not _waits_for(rule) & set(waiting)]
        for name in ready:
            frames[name] = _found(waiting.pop(name), facts, place.at(name).at("detect"), events=frames)
    return frames


def _waits_for(rule: DetectRule) -> set[str]:
    times = [] if rule.between is None else [rule.between.start, rule.between.stop]
    return {name for name in (rule.after, *(time.event for time in times)) if name is not None}


def _found(rule: DetectRule, facts: ClipFacts, place: Place, *, events: Mapping[str, float]) -> float:
    motion = facts.clip.motion
    effector = resolve.effector(rule.effector, motion.skeleton, place.at("effector"))
    start, stop = facts.first, facts.last
    if rule.between is not None:
        start, stop = resolve.frame_range(
            rule.between, place.at("between"), frames=len(motion), frame_time=motion.frame_time, events=events
        )
    elif rule.after is not None:
        if rule.after not in events:
            raise place.at("after").error(f"in {place.clip}: event '{rule.after}' has no frame")
        start = int(events[rule.after]) + 1
    start = min(max(start, facts.first), stop)
    to = None if rule.to is None else np.array(rule.to)
    return find_event(
        effector_positions(facts.poses, effector),
        Search("minimum" if rule.is_minimum else "maximum", _quantity(rule), start, stop),
        up=facts.up,
        frame_time=motion.frame_time,
        to=to,
    )


def _quantity(rule: DetectRule) -> Quantity:
    quantities: dict[str, Quantity] = {"height": "height", "speed": "speed", "distance": "distance"}
    return quantities[rule.measure]
