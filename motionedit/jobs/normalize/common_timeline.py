"""The common timeline of measured clips: frame count, rate and event frames, [PC] eq. (13) and (14)."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import median
from motionedit.core.timeline import round_half_up
from motionedit.core.timeline.warp import Timeline
from motionedit.errors import MotionEditError
from motionedit.jobs.clip.crop import crop_events
from motionedit.jobs.clip.events import clip_warp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.jobs.normalize.measures import ClipMeasure
    from motionedit.spec.load import LoadedSpec
    from motionedit.spec.normalize import NormalizeSpec
    from motionedit.spec.times import Time

# Frame rates that differ by less than this share are one rate written with fewer or more digits.
RATE_TOLERANCE = 2e-3

# An event whose places after the first stage spread by more than this share of the timeline was found badly.
SPREAD_TOLERANCE = 0.05


# A clip that lasts this many times as long as the others, or as short, may be something else.
ODD_DURATION = 2.0


def common_timeline(loaded: LoadedSpec[NormalizeSpec], measures: Sequence[ClipMeasure]) -> tuple[Timeline, list[str]]:
    """Return the common timeline of clips, eq. (13) and (14), and warnings about it.

    Raises
    ------
    SpecError
        The clips' rates differ and the spec gives none, the timeline would have one frame, or events do not follow each
        other on it.
    """
    warnings = [f"'{measures[0].label}' is the only clip: there are no means to take"] if len(measures) == 1 else []
    rate = _rate(loaded, measures, warnings)
    # F = T Fr, eq. (13), and one more for the last sample.
    durations = np.array([measure.duration for measure in measures])
    duration = float(durations.mean())
    warnings += _odd_durations(measures, durations)
    given = loaded.model.frames
    frames = given if isinstance(given, int) else round_half_up(duration * rate) + 1
    if frames < 2:
        message = f"the mean duration {duration:.3g} s at {rate:.4g} Hz makes one frame; set frames or frame_rate"
        raise loaded.error(("frames",), message)
    events = _events(loaded, measures, Timeline(frames, rate), warnings)
    return Timeline(frames, rate, events), warnings


def _odd_durations(measures: Sequence[ClipMeasure], durations: FloatArray) -> list[str]:
    """Return a warning of the clip whose duration is the furthest from the others', if it is far."""
    times = np.abs(np.log(durations / median(durations)))
    odd = int(np.argmax(times))
    if len(measures) < 3 or times[odd] <= np.log(ODD_DURATION):
        return []
    usual = float(median(np.delete(durations, odd)))
    lasts = f"'{measures[odd].label}' lasts {durations[odd]:.3g} s, the others about {usual:.3g} s"
    return [f"{lasts}: is it one of them? from: and to: say what counts of each clip"]


def _rate(loaded: LoadedSpec[NormalizeSpec], measures: Sequence[ClipMeasure], warnings: list[str]) -> float:
    """Return the timeline's rate: the spec's, else the clips' own, which must be one."""
    rates = np.array([1.0 / measure.frame_time for measure in measures])
    slow, fast = int(np.argmin(rates)), int(np.argmax(rates))
    slowest = f"{measures[slow].label} has {rates[slow]:.4g} Hz"
    rate = loaded.model.frame_rate
    if rate is None:
        if rates[fast] > (1.0 + RATE_TOLERANCE) * rates[slow]:
            fastest = f"{measures[fast].label} {rates[fast]:.4g} Hz"
            message = f"the clips' rates differ: {slowest}, {fastest}; set frame_rate: {rates[slow]:.4g}"
            raise loaded.error(("frame_rate",), message)
        return float(median(rates))
    if rate > (1.0 + RATE_TOLERANCE) * rates[slow]:
        warnings.append(
            f"frame_rate {rate:.4g} is finer than a clip ({slowest}): the corners between its frames will show in "
            "the components"
        )
    return rate


def _events(
    loaded: LoadedSpec[NormalizeSpec], measures: Sequence[ClipMeasure], timeline: Timeline, warnings: list[str]
) -> tuple[tuple[str, int], ...]:
    """Return the events' frames on the timeline, in their order: mean key frames, eq. (14), or the spec's targets."""
    places = []
    ends = {name for name, end in crop_events(loaded.model.crop).items() if end}
    for name, event in loaded.model.events.items():
        if name in ends:
            continue
        shares = np.array([(m.events[name] - m.first) / (m.last - m.first) for m in measures])
        if isinstance(event.target, str):
            places.append((name, round_half_up(float(shares.mean()) * (timeline.frames - 1))))
        else:
            places.append((name, _target(loaded, name, event.target, timeline)))
        if shares.std() > SPREAD_TOLERANCE:
            odd = measures[int(np.argmax(np.abs(shares - median(shares))))].label
            warnings.append(
                f"event '{name}' lies at {shares.min():.0%} to {shares.max():.0%} of the clips, furthest off "
                f"in {odd}: was it found rightly? A badly found event is worse than none"
            )
    places.sort(key=lambda place: place[1])
    if any(b <= a for a, b in itertools.pairwise([0, *(frame for _, frame in places), timeline.frames - 1])):
        named = ", ".join(f"'{name}' at {frame}" for name, frame in places)
        message = f"must lie strictly inside the timeline of {timeline.frames} frames, one after the other: {named}"
        raise loaded.error(("events",), message)
    return tuple(places)


def _target(loaded: LoadedSpec[NormalizeSpec], name: str, target: Time, timeline: Timeline) -> int:
    try:
        return target.frame(frames=timeline.frames, frame_time=1.0 / timeline.frame_rate, events={})
    except ValueError as error:
        message = f"on the timeline of {timeline.frames} frames: {error}"
        raise loaded.error(("events", name, "target"), message) from None


def events_out_of_order(
    loaded: LoadedSpec[NormalizeSpec], measures: Sequence[ClipMeasure], timeline: Timeline
) -> dict[str, MotionEditError]:
    """Return the clips that cannot be warped to the timeline because their events do not follow each other."""
    failures: dict[str, MotionEditError] = {}
    for measure in measures:
        try:
            span = {"first": measure.first, "last": measure.last}
            clip_warp(loaded, timeline, **span, events=measure.events, label=measure.label)
        except MotionEditError as error:
            failures[measure.label] = error
    return failures
