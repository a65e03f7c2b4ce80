"""What a report says of an edit's side effects: foot sliding and jerk, before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from motionedit.core.contacts import find_plants
from motionedit.core.quality import foot_drift, foot_slide_max, jerk_rms

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray
    from motionedit.core.contacts import Plant
    from motionedit.jobs.clip_facts import ClipFacts


def edit_metrics(facts: ClipFacts, after: FloatArray, *, retimed: bool = False) -> dict[str, Any]:
    """Return the `metrics` of a clip's record.

    Parameters
    ----------
    after : shape (F, J, 3)
        World positions of the edited motion.
    retimed : bool
        The edited motion has another timing, so that the input's plants say nothing of its frames.
    """
    motion = facts.clip.motion
    plants = find_plants(motion, facts.poses, facts.anatomy, up=facts.up, first=facts.first)
    before = _of(facts, facts.poses.positions, plants)
    if retimed:
        return {"before": before, "after": {"foot_slide_max": None, "jerk_rms": None}, "foot_drift_max": None}
    drift = foot_drift(facts.poses.positions, after, plants)
    return {"before": before, "after": _of(facts, after, plants), "foot_drift_max": drift}


def _of(facts: ClipFacts, positions: FloatArray, plants: list[Plant]) -> dict[str, float]:
    frame_time = facts.clip.motion.frame_time
    return {
        "foot_slide_max": foot_slide_max(positions, plants, up=facts.up, frame_time=frame_time),
        "jerk_rms": jerk_rms(positions, frame_time=frame_time, first=facts.first),
    }
