"""Writing an edit of a short clip: its touched rows at once, in two compiled loops, where nothing is out of the way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.bvh.write import LONGEST_WHOLE, decimals_of_edits
from motionedit.core.compiled import compiled
from motionedit.core.euler import MOST_MIDDLE, MOST_WOUND, arc_tangents
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.bvh.text import Written
    from motionedit.core.motion import Motion


@dataclass(frozen=True, eq=False)
class ShortEdit:
    """The `text` of all rows from the first touched one to the last, in place of the bytes from `start` to `stop`."""

    text: memoryview
    start: int
    stop: int


def short_edit(
    clip: Written,
    motion: Motion,
    touched: BoolArray,
    moved: BoolArray | None,
    positions: list[tuple[int, int, int]],
) -> ShortEdit | None:
    """Return the touched rows of a short clip as `edited_pieces` has them; None where that has to take its own way.

    So it is where nothing is touched or everything, of joints without three axes, near gimbal lock, where an edit winds
    another way round than the input, and of numbers that are too large or not finite. `positions` are the place, axis
    and column of each position channel that is moved.
    """
    kernel, rows = compiled(), clip.text.rows
    if kernel is None or touched.all():
        return None
    is_new = touched.any(axis=1)
    if positions and moved is not None:
        is_new |= moved.any(axis=1)
    found = np.flatnonzero(is_new)
    if not len(found):
        return None
    start, stop = int(found[0]), int(found[-1]) + 1
    # One frame more on either side: what the runs of touched frames meet there.
    around = slice(max(start - 1, 0), min(stop + 1, len(motion)))
    given = np.ascontiguousarray(clip.text.values_between(around.start, around.stop))
    values, cells = np.empty(given.shape), np.zeros(given.shape, dtype=np.bool_)
    if not _put_angles(motion.at(around), np.ascontiguousarray(touched[around]), given, values=values, cells=cells):
        return None
    if moved is not None:
        for p, axis, column in positions:
            values[:, column], cells[:, column] = motion.translations[around, p, axis], moved[around, p]
    own = slice(start - around.start, stop - around.start)
    values, cells = values[own], cells[own]
    if not cells.any():
        return None
    begin, end, decimals = int(rows.starts[start]), int(rows.stops[stop - 1]), decimals_of_edits(clip)
    old = clip.text.file.between(begin, end)
    text = np.empty(len(old) + cells.size * (decimals + LONGEST_WHOLE), np.uint8)
    length = kernel.splice(old, cells, values, decimals, text)
    return None if length < 0 else ShortEdit(text.data[:length], begin, end)


def _put_angles(motion: Motion, touched: BoolArray, given: FloatArray, *, values: FloatArray, cells: BoolArray) -> bool:
    """Write the touched angles into rows of `values`, shape (F, C), degrees, and which `cells` they are.

    `given` are the input's rows. False where a joint's angles take more than that.
    """
    kernel, turned = compiled(), np.asarray(touched.any(axis=0))
    rotations = np.ascontiguousarray(motion.rotations)
    for group in motion.skeleton.rotation_groups:
        chosen = turned[group.joints]
        joints, columns = group.joints[chosen].astype(np.int64), group.columns[chosen].astype(np.int64)
        if not len(joints):
            continue
        if len(group.axes) != 3:
            return False
        sums = np.empty((6, len(joints), len(motion)))
        kernel.euler_sums(rotations, rotations.shape[1], joints, *group.axes, sums)
        arc_tangents(sums)
        arrays = sums, joints, columns, touched, given, values, cells
        sizes = len(joints), touched.shape[1], *given.shape
        if not kernel.touched_rows(*arrays, *sizes, rot.sign_of(group.axes), MOST_MIDDLE, MOST_WOUND):
            return False
    return True
