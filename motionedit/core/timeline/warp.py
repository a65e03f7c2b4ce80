"""The time warp between a clip's frames and the common timeline ([PC] eq. 12 to 14)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.timeline.interpolation import monotone_cubic
from motionedit.dataclass import dataclass
from motionedit.errors import ClipError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from motionedit.core.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Timeline:
    """The common time of a database: F frames at one rate, with the events' places.

    Attributes
    ----------
    frames : int
        F, eq. (13) with one more for the last sample.
    frame_rate : float
        Hz.
    events : tuple of (name, frame)
        Mean key frames, eq. (14), increasing.
    """

    frames: int
    frame_rate: float
    events: tuple[tuple[str, int], ...] = ()

    def frames_at(self, places: FloatArray) -> IntArray:
        """Return the frames nearest to places, of any one shape; halves go up."""
        return np.clip(np.floor(places + 0.5).astype(np.intp), 0, self.frames - 1)


@dataclass(frozen=True, eq=False)
class TimeWarp:
    """Knots that pair frames of a clip with frames of the timeline, both strictly increasing, shape (K,)."""

    source: FloatArray
    timeline: FloatArray

    def to_source(self, frames: FloatArray) -> FloatArray:
        """Return the clip's frames of timeline frames: piecewise linear, both stages of [PC] section 5 in one."""
        return np.interp(frames, self.timeline, self.source)

    def to_timeline(self, frames: FloatArray) -> FloatArray:
        """Return the places s(f) on the timeline of clip frames, clamped outside.

        Monotone cubic: a kink of s at an event would be a kink of the edit.
        """
        return monotone_cubic(self.source, self.timeline, frames)


class EventOrderError(ClipError):
    """Events of a clip that do not follow each other inside it; `names` are those of the first two, as far as known."""

    names: tuple[str, ...] = ()


def make_warp(timeline: Timeline, *, first: int, last: int, events: Mapping[str, float], label: str) -> TimeWarp:
    """Return the warp of a clip.

    Parameters
    ----------
    first, last : int
        The clip's frames that the timeline spans: after a rest pose, to the end.
    events : mapping
        The clip's frame of every event of the timeline; parts of a frame are welcome.

    Raises
    ------
    EventOrderError
        If first frame, events in the timeline's order and last frame do not increase strictly.
    """
    source = [float(first), *(float(events[name]) for name, _ in timeline.events), float(last)]
    for i in range(1, len(source)):
        if not source[i] > source[i - 1]:
            names = ["its first frame", *(f"'{name}'" for name, _ in timeline.events), "its last frame"]
            message = (
                f"{names[i]} at frame {source[i]:g} is not after {names[i - 1]} at frame {source[i - 1]:g}; "
                "events must follow each other inside the clip, in the same order in every clip"
            )
            error = EventOrderError(message, file=label)
            error.names = tuple(name for name, _ in timeline.events[max(i - 2, 0) : i])
            raise error
    frames = [0.0, *(float(frame) for _, frame in timeline.events), float(timeline.frames - 1)]
    return TimeWarp(np.array(source), np.array(frames))
