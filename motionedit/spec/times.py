"""Times, intervals and durations as specs write them, and the frames of a clip that they mean."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from motionedit.dataclass import dataclass
from motionedit.spec import grammar
from motionedit.spec.faults import Fault, FaultyValueError, did_you_mean, faulty, listed, show

if TYPE_CHECKING:
    from collections.abc import Mapping

_TIME = re.compile(grammar.TIME)
_INSTANT = re.compile(grammar.PLAIN_INSTANT)
_DURATION = re.compile(grammar.DURATION)
# What would be a time or a duration without its sign.
_NEGATIVE = re.compile(rf"-{grammar.INSTANT}")

# Words that stand beside event names in a spec and mean something else.
RESERVED_NAMES = ("first", "mean", "event")

TIME_WORDS = "a frame such as 94, or 3.76s, 71.2%, an event's name, or hit + 1.5s"
INSTANT_WORDS = "a frame such as 94, or a time such as 3.76s or 71.2%"
DURATION_WORDS = "whole frames such as 40, or seconds such as 0.8s"

# A half frame that binary fractions put a hair too low is still a half: 0.145 s at 0.01 s a frame is 14.5 frames.
_HALF_SLACK = 1e-6
_FARTHEST = 1e9


@dataclass(frozen=True)
class Time:
    """An instant of a clip: ``event`` (or the clip's start) + `frames` + `seconds` + `percent` of the duration.

    `text` is the time as written. The other parts are offsets that are added up; `event` may be None.
    """

    text: str
    event: str | None = None
    frames: int = 0
    seconds: float = 0.0
    percent: float = 0.0

    def instant(self, *, frames: int, frame_time: float, events: Mapping[str, float]) -> float:
        """Return the instant in frames, not rounded.

        Parameters
        ----------
        frames : int
            Number of frames of the clip; its duration is frames - 1 intervals.
        frame_time : float
            Seconds a frame.
        events : mapping
            Frame of each known event; it may lie between two frames.

        Raises
        ------
        ValueError
            Where the event is unknown; the message is one line.
        """
        start = 0.0
        if self.event is not None:
            if self.event not in events:
                raise ValueError(unknown_event(self.event, tuple(events)))
            start = events[self.event]
        return start + self.frames + self.seconds / frame_time + self.percent / 100.0 * (frames - 1)

    def frame(self, *, frames: int, frame_time: float, events: Mapping[str, float]) -> int:
        """Return the nearest frame, halves up, with the parameters of `instant`.

        Raises
        ------
        ValueError
            Where the event is unknown or the frame is outside the clip; the message is one line.
        """
        instant = self.instant(frames=frames, frame_time=frame_time, events=events)
        # Floors of huge or endless numbers are no help, in arithmetic or in a message.
        nearest = math.floor(instant + 0.5 + _HALF_SLACK) if abs(instant) < _FARTHEST else None
        if nearest is None or not 0 <= nearest < frames:
            where = "" if nearest is None or self.text == str(nearest) else f" (frame {nearest})"
            raise ValueError(f"{self.text}{where} is outside the clip, whose frames are 0 to {frames - 1}")
        return nearest


@dataclass(frozen=True)
class Interval:
    """From `start` to `stop`, both in."""

    start: Time
    stop: Time

    def frame_range(self, *, frames: int, frame_time: float, events: Mapping[str, float]) -> tuple[int, int]:
        """Return the first and the last frame, with the parameters and errors of `Time.frame`."""
        first = self.start.frame(frames=frames, frame_time=frame_time, events=events)
        last = self.stop.frame(frames=frames, frame_time=frame_time, events=events)
        if last < first:
            raise ValueError(
                f"[{self.start.text}, {self.stop.text}] ends at frame {last}, before it begins at frame {first}"
            )
        return first, last


@dataclass(frozen=True)
class Duration:
    """A length of time, as written in `text`: `amount` frames, or `amount` seconds where `is_seconds`."""

    text: str
    amount: float
    is_seconds: bool

    def in_frames(self, frame_time: float) -> float:
        """Return the number of frames at `frame_time` seconds a frame, not rounded."""
        return self.amount / frame_time if self.is_seconds else self.amount


def unknown_event(name: str, events: tuple[str, ...]) -> str:
    """Return the message for an event that is not there."""
    known = f"the events are {listed(events)}" if events else "there are no events"
    return f"no event {show(name)}; {did_you_mean(name, events, otherwise=known)}"


def parse_time(value: object) -> Time:
    """Return the time of a plain value: ``94``, ``3.76s``, ``71.2%``, ``hit``, ``hit + 1.5s``, ``hit - 10``.

    Raises
    ------
    FaultyValueError
        Where it is none of these, negative, or more than 100 %.
    """
    text = _text(value)
    if match := _TIME.fullmatch(text):
        amount, unit, event, sign, shift, shift_unit = match.groups()
        if event is None:
            return _instant(value, text, float(amount), unit)
        return _from_event(value, text, event, float(f"{sign or ''}{shift or 0}"), shift_unit)
    if _NEGATIVE.fullmatch(text):
        raise faulty(f"must not be negative: frames count from 0; not {show(value)}")
    raise faulty(f"must be a time: {TIME_WORDS}; not {show(value)}")


def parse_instant(value: object, *, words: str = INSTANT_WORDS) -> Time:
    """Return the time of a plain value that names no event: ``94``, ``3.76s``, ``71.2%``; `words` say what it may be.

    Raises
    ------
    FaultyValueError
        Where it is none of these, negative, or more than 100 %.
    """
    text = _text(value)
    if _INSTANT.fullmatch(text) or _NEGATIVE.fullmatch(text):
        return parse_time(value)
    raise faulty(f"must be {words}; not {show(value)}")


def _text(value: object) -> str:
    """Return a value as a text that the patterns know; other kinds of values are none of them."""
    match value:
        case bool():
            return ""
        case float() if value.is_integer():
            return str(int(value))
        case float() if math.isfinite(value):
            return repr(value)
        case int() | str():
            return str(value).strip()
    return ""


def _instant(value: object, text: str, amount: float, unit: str | None) -> Time:
    if not math.isfinite(amount):
        raise faulty("must be a finite time")
    if unit == "s":
        return Time(text, seconds=amount)
    if unit == "%":
        if amount > 100.0:
            raise faulty(f"must be from 0% to 100% of the clip, not {show(value)}")
        return Time(text, percent=amount)
    return Time(text, frames=_whole_frames(value, amount))


def _from_event(value: object, text: str, event: str, shift: float, unit: str | None) -> Time:
    if not math.isfinite(shift):
        raise faulty("must be a finite time")
    if unit == "s":
        return Time(text, event=event, seconds=shift)
    return Time(text, event=event, frames=_whole_frames(value, shift))


def _whole_frames(value: object, amount: float) -> int:
    if not amount.is_integer():
        raise faulty(f"must be a whole frame, or seconds such as 3.76s; not {show(value)}")
    return int(amount)


def parse_interval(value: object) -> Interval:
    """Return the interval of ``[from, to]``.

    Raises
    ------
    FaultyValueError
        Where it is not two times, or plainly ends before it begins.
    """
    if not isinstance(value, list) or len(value) != 2:
        raise faulty(f"must be an interval [from, to], both ends in; not {show(value)}")
    times: list[Time] = []
    faults: list[Fault] = []
    for i, item in enumerate(value):
        try:
            times.append(parse_time(item))
        except FaultyValueError as error:
            faults += [fault.under(i) for fault in error.faults]
    if faults:
        raise FaultyValueError(faults)
    start, stop = times
    if _certainly_before(stop, start):
        raise faulty(f"ends before it begins: {show(value)}; an interval is [from, to]")
    return Interval(start, stop)


def _certainly_before(a: Time, b: Time) -> bool:
    parts = [(t.event, t.frames != 0, t.seconds != 0.0, t.percent != 0.0) for t in (a, b)]
    kinds = [sum(part[1:]) for part in parts]
    if a.event != b.event:
        return False
    # Two kinds of amounts (frames against seconds) compare only once the clip's rate is known.
    if kinds == [1, 1] and parts[0] != parts[1]:
        return False
    return a.frames + a.seconds + a.percent < b.frames + b.seconds + b.percent


def parse_duration(value: object) -> Duration:
    """Return the duration of ``40`` (frames) or ``0.8s``.

    Raises
    ------
    FaultyValueError
        Where it is neither, negative, or a part of a frame.
    """
    text = _text(value)
    match = _DURATION.fullmatch(text)
    if match is None:
        if (negative := _NEGATIVE.fullmatch(text)) and negative[2] != "%":
            raise faulty(f"must not be negative, not {show(value)}")
        raise faulty(f"must be a duration: {DURATION_WORDS}; not {show(value)}")
    amount, unit = float(match[1]), match[2]
    if not math.isfinite(amount):
        raise faulty("must be a finite duration")
    if amount > _FARTHEST:
        raise faulty(f"must be a finite duration, of at most {_FARTHEST:.10g} frames or seconds; not {show(value)}")
    if unit != "s" and not amount.is_integer():
        raise faulty(f"must be {DURATION_WORDS}; not {show(value)}")
    return Duration(text, amount, unit == "s")


def parse_event_name(value: object) -> str:
    """Return an event's name: letters, digits and underscores, with hyphens between words.

    Raises
    ------
    FaultyValueError
        Where it is something else, or a word that means something else in a spec.
    """
    if not isinstance(value, str) or not re.fullmatch(grammar.EVENT, value):
        raise faulty(f"must be an event's name: letters, digits, _ and -, a letter first; not {show(value)}")
    if value in RESERVED_NAMES:
        raise faulty(f"'{value}' means something else in a spec; give the event another name")
    return value
