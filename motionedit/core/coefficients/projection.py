"""A clip as the model sees it: aligned, on the timeline, with its coefficients; and the way back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion
from motionedit.core.pca.coordinates import (
    pose_rows,
    rotation_tracks,
    rotations_in_space,
    rotations_of_tracks,
    split_rows,
)
from motionedit.core.rotation_vectors import relabelled
from motionedit.core.timeline.alignment import Alignment, TravelPath, travel_path, with_travel_path
from motionedit.core.timeline.resample import resample
from motionedit.dataclass import dataclass, replace

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.pca.coordinates import PoseSpace
    from motionedit.core.pca.model import MotionModel
    from motionedit.core.timeline.warp import TimeWarp

# Seconds: a place on the timeline comes to rest at its ends within some four of these.
_REST = 0.05


@dataclass(frozen=True, eq=False)
class Projection:
    """A clip's own frames in the model's pose space.

    Attributes
    ----------
    motion : Motion
        The clip, or the clip resampled to the timeline.
    travel : int
        The clip's joint that carries the travel.
    joints : shape (K,)
        The clip's joints behind the columns.
    alignment : Alignment
        Into the database's heading and place.
    places : shape (F,)
        s(f), each frame's place on the timeline.
    rows : shape (F, n)
        Theta of every frame.
    coefficients : shape (m,)
        alpha_0 of the clip.
    deviation : shape (F on the timeline, n)
        The clip on the timeline, less the mean motion.
    residual : float
        The sum of squares of what the components leave of it on the timeline.
    seconds : float
        How long the part of the clip lasts that lies on the timeline.
    """

    motion: Motion
    travel: int
    joints: IntArray
    alignment: Alignment
    places: FloatArray
    rows: FloatArray
    coefficients: FloatArray
    deviation: FloatArray
    residual: float
    seconds: float


def project(
    motion: Motion, model: MotionModel, *, joint_map: IntArray, alignment: Alignment, warp: TimeWarp, first: int
) -> Projection:
    """Return the clip in the model's space, in its own timing; alpha_0 is that of its resampled copy, eq. (3).

    Parameters
    ----------
    joint_map : shape (J,)
        The clip's joint of each of the model's.
    first : int
        The clip's first frame after a rest pose.
    """
    on_timeline = project_resampled(motion, model, joint_map=joint_map, alignment=alignment, warp=warp)
    places = _places(warp, len(motion), first=first, rate=model.timeline.frame_rate)
    return of_another(replace(on_timeline, places=places), model, motion)


def _places(warp: TimeWarp, frames: int, *, first: int, rate: float) -> FloatArray:
    """Return s(f) of each frame, shape (frames,).

    Where the clip goes on beyond the timeline s comes to rest at its end, by r log(1 + exp(x / r)): to stop there at
    once would be a corner of whatever changes along the timeline.
    """
    at = np.arange(frames, dtype=np.float64)
    start, stop = warp.source[0], warp.source[-1]
    places, end, soft = warp.to_timeline(at), warp.timeline[-1], _REST * rate
    beside = warp.to_timeline(np.array([start + 1.0, stop - 1.0]))
    if start > first:
        places = places + beside[0] * np.minimum(at - start, 0.0)
        places = soft * np.logaddexp(0.0, places / soft)
    if stop < frames - 1:
        places = places + (end - beside[1]) * np.maximum(at - stop, 0.0)
        places = end - soft * np.logaddexp(0.0, (end - places) / soft)
    return places


def project_resampled(
    motion: Motion, model: MotionModel, *, joint_map: IntArray, alignment: Alignment, warp: TimeWarp
) -> Projection:
    """Return the clip resampled to the timeline, in the model's space."""
    places = np.arange(model.timeline.frames, dtype=np.float64)
    resampled = resample(motion, warp.to_source(places), frame_time=1.0 / model.timeline.frame_rate)
    travel, joints = int(joint_map[model.travel]), joint_map[model.space.joints]
    rows = _rows(resampled, model, travel=travel, joints=joints, alignment=alignment, places=places)
    deviation = rows - model.mean_rows
    off = deviation.ravel()
    coefficients = model.components.components @ off
    residual = max(float(off @ off - coefficients @ coefficients), 0.0)
    seconds = float(warp.source[-1] - warp.source[0]) * motion.frame_time
    return Projection(
        motion=resampled,
        travel=travel,
        joints=joints,
        alignment=alignment,
        places=places,
        rows=rows,
        coefficients=frozen(coefficients),
        deviation=frozen(deviation),
        residual=residual,
        seconds=seconds,
    )


def _rows(
    motion: Motion,
    model: MotionModel,
    *,
    travel: int,
    joints: IntArray,
    alignment: Alignment,
    places: FloatArray,
) -> FloatArray:
    path = travel_path(motion, travel)
    q = rotations_in_space(motion, joints, path=path, alignment=alignment)
    tracks = rotation_tracks(q, model.space.references)
    mean = model.mean_rows[:, 3:].reshape(model.timeline.frames, -1, 3)
    tracks, _ = relabelled(tracks, mean[model.timeline.frames_at(places)])
    return pose_rows(tracks, model.space, path=path, alignment=alignment)


def of_another(projection: Projection, model: MotionModel, motion: Motion) -> Projection:
    """Return the projection with another motion of the same clip in place of its own, at the same coefficients."""
    rows = _rows(
        motion,
        model,
        travel=projection.travel,
        joints=projection.joints,
        alignment=projection.alignment,
        places=projection.places,
    )
    return replace(projection, motion=motion, rows=rows)


def with_rows(projection: Projection, space: PoseSpace, rows: FloatArray) -> Motion:
    """Return the clip with rows Theta, shape (F, n), in place of its own; all else as it was."""
    motion, alignment = projection.motion, projection.alignment
    travel, tracks = split_rows(rows, space)
    q = rotations_of_tracks(tracks, space.references)
    rotations = motion.rotations.copy()
    rotations[:, projection.joints[1:]] = q[:, 1:]
    turned = Motion(motion.skeleton, frozen(rotations), motion.translations, motion.frame_time)
    path = TravelPath(alignment.undo(travel), rot.between(alignment.rotation, q[:, 0]))
    return with_travel_path(turned, projection.travel, path)
