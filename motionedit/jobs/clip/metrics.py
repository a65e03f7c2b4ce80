"""What a report says of an edit's side effects: sliding feet, jerk and steps, before and after."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from motionedit.core import rotations as rot
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.body.quality import foot_drift, foot_slide_max
from motionedit.core.body.trace import Trace, trace_of
from motionedit.core.feet.measures import foot_measures

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from motionedit.core.body.center_of_mass import Masses
    from motionedit.core.body.contacts import Plant
    from motionedit.core.body.steps import Steps
    from motionedit.core.kinematics import WorldPoses
    from motionedit.jobs.clip.facts import ClipFacts


def feet_of(facts: ClipFacts, blocks: Iterable[WorldPoses], *, masses: Masses | None = None) -> Trace:
    """Return what `edit_metrics` needs of a motion whose world transforms come in blocks: the tracks are the feet's."""
    tracked = partial(sole_tracks, anatomy=facts.anatomy)
    return trace_of(blocks, tracked, frame_time=facts.clip.motion.frame_time, first=facts.first, masses=masses)


def edit_metrics(facts: ClipFacts, before: Trace, after: Trace | None, *, steps: Steps | None) -> dict[str, Any]:
    """Return the `metrics` of a clip's record.

    Parameters
    ----------
    before, after : Trace
        Of the clip and the edited motion, by `feet_of`; None where that has another timing, so that the input's plants
        say nothing of its frames.
    steps : Steps or None
        Of the change that the edit made, None where the edited motion has another timing.
    """
    plants = facts.phases
    metrics: dict[str, Any] = {"before": clip_metrics(facts, before, plants, facts.steps)}
    if after is None:
        return {**metrics, "after": dict.fromkeys(metrics["before"]), "foot_drift_max": None}
    drift = foot_drift(before.tracks, after.tracks, plants)
    metrics |= {"after": clip_metrics(facts, after, plants, steps), "foot_drift_max": drift}
    if before.center is not None and after.center is not None:
        metrics["com_shift_max"] = float(rot.length(after.center - before.center).max())
    return metrics


def clip_metrics(facts: ClipFacts, trace: Trace, plants: Sequence[Plant], steps: Steps | None) -> dict[str, Any]:
    """Return what is measured of one motion: the clip's own, or an edited one with its change's `steps`."""
    joint, frame_time = None if steps is None else steps.joint, facts.clip.motion.frame_time
    feet = foot_measures(trace.tracks, plants, facts.anatomy, up=facts.up, first=facts.first, frame_time=frame_time)
    return {
        "foot_slide_max": foot_slide_max(trace.tracks, plants, up=facts.up, frame_time=frame_time),
        "foot_skate_mean": feet.skate_mean,
        "foot_skate_ratio": feet.skate_ratio,
        "foot_sliding_share": feet.sliding_share,
        "foot_drift_max": feet.drift_max,
        "floor_penetration_share": feet.penetration_share,
        "floor_penetration_max": feet.penetration_max,
        "foot_floating_max": feet.floating_max,
        "jerk_rms": trace.jerk_rms,
        "step_max": None if steps is None else 0.0 if joint is None else float(steps.degrees[joint]),
        "step_frame": None if steps is None or joint is None else int(steps.frames[joint]),
        "step_joint": None if joint is None else facts.clip.motion.skeleton.names[joint],
    }
