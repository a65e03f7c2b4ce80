"""The second phase of normalize, on one clip: both stages of [PC] section 5 in one resample, then alignment."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np

from motionedit.core.body.quality import find_defects
from motionedit.core.bvh import other_rows_pieces
from motionedit.core.timeline.alignment import aligned
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.sampled_rows import sampled_rows
from motionedit.core.timeline.warp import make_warp
from motionedit.dataclass import dataclass
from motionedit.jobs.batch.one_clip import Outcome

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.bvh import Clip
    from motionedit.core.motion import Motion
    from motionedit.core.timeline.alignment import Alignment
    from motionedit.core.timeline.warp import Timeline
    from motionedit.jobs.batch.plan import ClipTask
    from motionedit.jobs.normalize.measures import ClipMeasure
    from motionedit.spec.values import Unit


@dataclass(frozen=True)
class ResampleClip:
    """The work on the clip of one measure: onto the common timeline, and into its alignment.

    With `verify` the outcome says what motion the written clip is to be.
    """

    measure: ClipMeasure
    timeline: Timeline
    alignment: Alignment
    unit: Unit | None
    verify: bool = False

    def __call__(self, clip: Clip, task: ClipTask) -> Outcome:
        """Return the normalized clip."""
        del task
        measure = self.measure
        warp = make_warp(
            self.timeline, first=measure.first, last=measure.last, events=measure.events, label=measure.label
        )
        at = warp.to_source(np.arange(self.timeline.frames, dtype=np.float64))
        frame_time = 1.0 / self.timeline.frame_rate
        first = clip.text.values_between(0, 1)[0]
        rows = sampled_rows(clip.motion, at, self.alignment, travel=measure.travel, start=first)
        places = ", ".join(f"{name} {frame:.2f}" for name, frame in measure.events.items())
        line = f"frames {measure.first} to {measure.last} -> {self.timeline.frames}; {places}"
        content, sha256 = list(other_rows_pieces(clip, rows, frame_time=frame_time)), hashlib.sha256()
        for piece in content:
            sha256.update(piece)
        digest = sha256.hexdigest()
        return Outcome(
            content,
            {**self._record(), "clip_sha256": digest},
            warnings=(*measure.warnings, *_defects(clip.motion, first=measure.first)),
            motion=self._resampled(clip, at, frame_time=frame_time) if self.verify else None,
            details=(line.rstrip("; "),),
            digest=digest,
        )

    def _resampled(self, clip: Clip, at: FloatArray, *, frame_time: float) -> Motion:
        resampled = resample(clip.motion, at, frame_time=frame_time)
        return aligned(resampled, self.alignment, travel=self.measure.travel)

    def _record(self) -> dict[str, Any]:
        return {
            "unit": None if self.unit is None else self.unit.name,
            "frames": [self.measure.frames, self.timeline.frames],
            "first_frame": self.measure.first,
            "events": dict(self.measure.events),
        }


def _defects(motion: Motion, *, first: int) -> tuple[str, ...]:
    names = motion.skeleton.names
    return tuple(
        f"'{names[defect.joint]}' jumps by {np.degrees(defect.angle):.0f} degrees into frame {defect.worst}: a capture "
        "defect? fit-pca can leave it out (exclude_joints)"
        for defect in find_defects(motion, first=first)
    )
