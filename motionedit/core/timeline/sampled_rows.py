"""A motion at parts of its frames, aligned, as rows of a file: what normalize writes of a clip."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.arrays import frozen
from motionedit.core.compiled import compiled
from motionedit.core.euler import DEGREES, HELD, MOST_MIDDLE, arc_tangents, joint_angles, radians
from motionedit.core.motion import position_columns
from motionedit.core.slerp import ways_of
from motionedit.core.timeline.alignment import aligned
from motionedit.core.timeline.resample import frames_before, resample

if TYPE_CHECKING:
    from motionedit.core.arrays import FloatArray, IntArray
    from motionedit.core.motion import Motion
    from motionedit.core.skeleton import Skeleton
    from motionedit.core.timeline.alignment import Alignment


def sampled_rows(motion: Motion, at: FloatArray, alignment: Alignment, *, travel: int, start: FloatArray) -> FloatArray:
    """Return the channel values of a motion at frames `at` (N,) of its own, aligned, shape (N, C).

    They are the `joint_angles` of what `resample` and `aligned` make of it, to the bit, in a third of the time.

    Parameters
    ----------
    travel : int
        The joint that carries the travel.
    start : shape (C,), degrees and clip units
        The row that the first one is nearest to.
    """
    rows = _in_few_loops(motion, at, alignment, start=start) if travel == 0 else None
    if rows is None:
        sampled = resample(motion, at, frame_time=motion.frame_time)
        rows = joint_angles(aligned(sampled, alignment, travel=travel), start=start)
    return rows


def _in_few_loops(motion: Motion, at: FloatArray, alignment: Alignment, *, start: FloatArray) -> FloatArray | None:
    """Return the rows where the root carries the travel.

    None where nothing is compiled; where a joint has other than three axes, or is locked somewhere; of a long clip.
    """
    kernel, skeleton = compiled(), motion.skeleton
    groups = skeleton.rotation_groups
    if kernel is None or any(len(group.axes) != 3 for group in groups) or len(at) * len(skeleton) > HELD:
        return None
    frames, t = frames_before(motion, at)
    ways = ways_of(kernel, motion.rotations, frames, t)
    width, seeds = skeleton.channel_count, radians(start)
    rows = np.empty((len(at), width))
    given = ways.rotations, len(skeleton), ways.frames, ways.t, ways.parts
    for group in groups:
        sums = np.empty((6, len(group.joints), len(at)))
        kernel.sampled_sums(*given, alignment.rotation, group.joints, *group.axes, sums)
        arc_tangents(sums)
        own = seeds[group.columns], group.columns
        if not kernel.angle_columns(sums, len(at), *group.axes, MOST_MIDDLE, DEGREES, *own, width, rows):
            return None
    placed, columns = _places(skeleton)
    if len(columns):
        moved = np.ascontiguousarray(motion.translations), len(columns), ways.frames, ways.t, placed
        kernel.place_columns(*moved, alignment.rotation, alignment.origin, columns, width, rows)
    return rows


@lru_cache(maxsize=8)
def _places(skeleton: Skeleton) -> tuple[int, IntArray]:
    """Return the root's place among `translated`, -1 where it has none, and their columns along x, y, z, (P, 3)."""
    columns = np.full((len(skeleton.translated), 3), -1, dtype=np.int64)
    for p, joint in enumerate(skeleton.translated.tolist()):
        for axis, column in position_columns(skeleton, joint):
            columns[p, axis] = column
    return int(skeleton.translation_places[0]), frozen(columns)
