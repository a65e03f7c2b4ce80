"""The frames of a clip's events: given by a spec, or found by a spec's rule."""

from __future__ import annotations

from functools import lru_cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from motionedit.core.again import LastFew, Same
from motionedit.core.kinematics import effector_positions
from motionedit.core.timeline.events import Quantity, Search, find_event
from motionedit.core.timeline.warp import EventOrderError, make_warp
from motionedit.errors import MotionEditError
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.faults import Faults

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from motionedit.core.bvh import Clip
    from motionedit.core.kinematics import Effector
    from motionedit.core.skeleton import Skeleton
    from motionedit.core.timeline.warp import Timeline, TimeWarp
    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.resolve import Place
    from motionedit.spec.document import Document
    from motionedit.spec.events import DetectRule, EventSpec
    from motionedit.spec.load import LoadedSpec


_QUANTITIES: dict[str, Quantity] = {"height": "height", "speed": "speed", "distance": "distance"}
# Parts of a path that name nothing.
_NO_NAMES = frozenset(("", "."))
# Of each rule and skeleton of a run: mostly one of each.
_EFFECTORS: LastFew[Effector] = LastFew(16)


def explicit_events(
    loaded: LoadedSpec[Document], clip: Clip, *, relative: str, others: Collection[str] = ()
) -> dict[str, float]:
    """Return the frames that the spec itself gives for a clip's events, or the times.

    Parameters
    ----------
    relative : str
        The clip's path below the given folder, or its name.
    others : collection of str
        The same of all clips of the run, so that a stem that two of them share is refused.

    Raises
    ------
    SpecError
        Where a stem is not unique, or a time is outside the clip.
    """
    found: dict[str, float] = {}
    for name, event in loaded.model.events.items():
        if event.frames is None:
            continue
        value, place = event.frames.every, resolve.Place(loaded, ("events", name), clip.label)
        if value is None:
            by_clip = event.frames.by_clip
            key = _clip_key(by_clip, relative, others, resolve.Place(loaded, (*place.keys, "frames"), relative))
            if key is None:
                continue
            value, place = by_clip[key], place.at("frames", key)
        found[name] = float(value if isinstance(value, int) else resolve.frame(value, place, clip.motion, events={}))
    return found


def event_frames(
    specs: Mapping[str, EventSpec], facts: ClipFacts, place: Place, *, known: Mapping[str, float]
) -> dict[str, float]:
    """Return the frame of every event of a clip that is known or has a rule; found ones to a part of a frame.

    Arguments and errors are those of `found_events`.
    """
    return found_events(specs, facts, place, known=known).frames


class FoundEvents(NamedTuple):
    """The `frames` of a clip's events, and the first and last frame of the `windows` that rules looked in."""

    frames: dict[str, float]
    windows: dict[str, tuple[int, int]]


def found_events(
    specs: Mapping[str, EventSpec], facts: ClipFacts, place: Place, *, known: Mapping[str, float]
) -> FoundEvents:
    """Return `event_frames`, and where the events were looked for that needed a rule.

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
    frames: dict[str, float] = dict(known)
    windows: dict[str, tuple[int, int]] = {}
    for name, frame in known.items():
        if not facts.first <= frame <= facts.last:
            message = (
                f"in {place.clip}: frame {frame:g} is outside the take, whose frames are {facts.first} to {facts.last}"
            )
            raise place.at(name).error(message)
    # A rule may wait for another's event; the spec has refused rings, so each round finds at least one.
    waiting = {name: spec.detect for name, spec in specs.items() if spec.detect is not None and name not in frames}
    effectors = rule_effectors(waiting, facts, place)
    while waiting:
        ready = [name for name, rule in waiting.items() if not waits_for(rule) & waiting.keys()]
        for name in ready:
            rule, where = waiting.pop(name), place.at(name).at("detect")
            windows[name] = _window(rule, facts, where, events=frames)
            frames[name] = _found(rule, effectors[name], facts, windows[name])
    return FoundEvents(frames, {name: windows[name] for name in specs if name in windows})


def waits_for(rule: DetectRule) -> set[str]:
    """Return the events whose frames a rule needs."""
    times = [] if rule.between is None else [rule.between.start, rule.between.stop]
    return {name for name in (rule.after, *(time.event for time in times)) if name is not None}


def rule_effectors(rules: Mapping[str, DetectRule], facts: ClipFacts, place: Place) -> dict[str, Effector]:
    """Return the points that rules are about, by their events.

    Raises
    ------
    SpecError, MotionEditErrors
        Of all that the clip lacks.
    """
    faults = Faults()
    found: dict[str, Effector] = {}
    for name, rule in rules.items():
        try:
            found[name] = _effector(rule, facts.clip.motion.skeleton, place.at(name).at("detect"))
        except MotionEditError as error:
            faults.add(error)
    faults.raise_all(f"joints that {place.clip} lacks")
    return found


def _effector(rule: DetectRule, skeleton: Skeleton, place: Place) -> Effector:
    """Return the point that a rule is about: the same of all clips that share a skeleton."""
    key = Same(rule), skeleton
    known = _EFFECTORS.get(key)
    if known is None:
        known = _EFFECTORS.keep(key, resolve.effector(rule.effector, skeleton, place.at("effector")))
    return known


def _found(rule: DetectRule, effector: Effector, facts: ClipFacts, window: tuple[int, int]) -> float:
    return find_event(
        effector_positions(facts.poses, effector),
        Search("minimum" if rule.is_minimum else "maximum", _QUANTITIES[rule.measure], *window),
        up=facts.up,
        frame_time=facts.clip.motion.frame_time,
        to=None if rule.to is None else np.array(rule.to),
    )


def clip_warp(
    loaded: LoadedSpec[Document],
    timeline: Timeline,
    *,
    first: int,
    last: int,
    events: Mapping[str, float],
    label: str,
) -> TimeWarp:
    """Return `make_warp` of a clip.

    Raises
    ------
    SpecError
        Events do not follow each other, and the spec says when they are.
    EventOrderError
        It does not.
    """
    try:
        return make_warp(timeline, first=first, last=last, events=events, label=label)
    except EventOrderError as error:
        for name in error.names:
            if loaded.has(("events", name)):
                raise loaded.error(("events", name), f"in {label}: {error.message}") from None
        raise


def events_at_edge(found: FoundEvents) -> list[str]:
    """Return a line for each event that was found at an end of where it was looked for: the extreme may lie beyond."""
    return [
        f"event '{name}' lies at the edge of its window, frame {found.frames[name]:g} of {window[0]} to {window[1]}: "
        "widen between: or after:, or give its frame"
        for name, window in found.windows.items()
        if window[0] < window[1] and any(abs(found.frames[name] - edge) < 0.5 for edge in window)
    ]


def _window(rule: DetectRule, facts: ClipFacts, place: Place, *, events: Mapping[str, float]) -> tuple[int, int]:
    """Return the first and last frame in which an event is looked for."""
    start, stop = facts.first, facts.last
    if rule.between is not None:
        start, stop = resolve.frame_range(rule.between, place.at("between"), facts.clip.motion, events=events)
    elif rule.after is not None:
        if rule.after not in events:
            raise place.at("after").error(f"in {place.clip}: event '{rule.after}' has no frame")
        start = int(events[rule.after]) + 1
    return min(max(start, facts.first), stop), stop


def _clip_key(by_clip: Mapping[str, object], relative: str, others: Collection[str], place: Place) -> str | None:
    """Return the key that means a clip: its path or its name, each with or without .bvh."""
    path = _posix(relative)
    keys = _keys_by_path(tuple(by_clip))
    for whole_path in (path, _without_suffix(path)):
        if whole_path in keys:
            return keys[whole_path]
    for name in _names(path):
        if name not in keys:
            continue
        named = [other for other in _paths_by_name(tuple(others)).get(name, ()) if other != path]
        if any(name in (other, _without_suffix(other)) for other in named):
            # It is the whole path of another clip.
            return None
        twins = [other for other in named if name in _names(other)]
        if twins:
            message = f"'{keys[name]}' may be {path} or {twins[0]}; give the clip's path"
            raise place.at(keys[name]).error(message)
        return keys[name]
    return None


# Of thousands of clips, each is looked for in a table of thousands: what is the same for all is made once.
@lru_cache(maxsize=8)
def _keys_by_path(keys: tuple[str, ...]) -> dict[str, str]:
    """Return the keys of a table by the paths that they are."""
    return {_posix(key): key for key in keys}


@lru_cache(maxsize=2)
def _paths_by_name(others: tuple[str, ...]) -> dict[str, list[str]]:
    """Return the paths of clips by all that may mean one of them, each with or without .bvh."""
    found: dict[str, list[str]] = {}
    for path in map(_posix, others):
        for name in {path, _without_suffix(path), *_names(path)}:
            found.setdefault(name, []).append(path)
    return found


def _names(path: str) -> tuple[str, str]:
    name = path.rpartition("/")[2]
    return name, _without_suffix(name)


def _posix(path: str) -> str:
    path = path.replace("\\", "/")
    return path if _NO_NAMES.isdisjoint(path.split("/")) else str(PurePosixPath(path))


def _without_suffix(path: str) -> str:
    return path[:-4] if path.casefold().endswith(".bvh") else path
