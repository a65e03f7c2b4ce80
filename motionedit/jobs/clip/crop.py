"""The part of a clip that counts where a spec, or the one that a database was normalized by, crops it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from motionedit.errors import ClipError
from motionedit.jobs.clip import resolve
from motionedit.spec.times import parse_time

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.jobs.clip.facts import ClipFacts
    from motionedit.jobs.clip.resolve import Place


def cropped(crop: Mapping[str, str], facts: ClipFacts, place: Place, *, events: Mapping[str, float]) -> tuple[int, int]:
    """Return the first and the last frame that count.

    Parameters
    ----------
    crop : mapping
        Times by `from` and `to`; what is not there is the clip's own end.
    place : Place
        Of the spec.

    Raises
    ------
    MotionEditError
        A time is outside the clip, names an event without a frame, or nothing lies between.
    """
    found = {"from": facts.first, "to": facts.last}
    for key, text in crop.items():
        found[key] = resolve.frame(parse_time(text), place.at(key), facts.clip.motion, events=events)
    first, last = max(found["from"], facts.first), found["to"]
    if first >= last:
        message = f"nothing is left from frame {first} (from:) to frame {last} (to:)"
        raise ClipError(message, file=facts.clip.label)
    return first, last


def crop_events(crop: Mapping[str, str]) -> dict[str, str]:
    """Return the events that a crop names, each with the end whose very instant it is, or an empty text."""
    names: dict[str, str] = {}
    for key, text in crop.items():
        event = parse_time(text).event
        if event is not None:
            names[event] = key if text.strip() == event else ""
    return names
