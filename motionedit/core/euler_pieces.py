"""The frames that an edit touched as Euler angles, which meet what stands around them, in pieces for long clips."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.euler import TOGETHER, TURN, angles_near, gimbal_locked, near, nearest, radians, solve_angles
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion

    GivenRows = Callable[[int, int], FloatArray]


@dataclass(frozen=True, eq=False)
class Piece:
    """The touched frames from `start` up to `stop` of one joint.

    They are solved from `seed`, shape (A,) rad, before them, or are kept as `angles`, shape (stop - start, A) degrees.
    """

    start: int
    stop: int
    seed: FloatArray
    angles: FloatArray | None


def touched_pieces(motion: Motion, touched: BoolArray, *, given: GivenRows, size: int) -> dict[int, list[Piece]]:
    """Return the touched frames of each joint in pieces that can be solved by themselves, for `piece_angles`.

    Each run of touched frames starts from the input's angles at the frame before it, or at frame 0, and meets the
    frame after it without a turn that the input has not.

    Parameters
    ----------
    touched : shape (F, J)
        Where a joint's rotation is to be written.
    given : callable
        given(start, stop) are the input's channel values of those frames, shape (stop - start, C).
    size : int
        No piece reaches over a multiple of this many frames. Clips of no more frames keep their angles, longer ones
        solve them again piece by piece, which costs time but hardly any memory.
    """
    # Joints mostly ask for the same few rows, and are touched at the same frames.
    rows = cache(lambda start, stop: radians(given(start, stop)))
    spans: dict[bytes, list[tuple[int, int]]] = {}
    turned = np.asarray(touched.any(axis=0))
    pieces = {}
    for group in motion.skeleton.rotation_groups:
        places = np.flatnonzero(turned[group.joints])
        step = max(TOGETHER // len(motion), 1)
        for first in range(0, len(places), step):
            some = places[first : first + step]
            q = np.ascontiguousarray(motion.rotations.transpose(2, 1, 0)[:, group.joints[some]])
            solved = solve_angles(q, group.axes)
            locked = np.any(gimbal_locked(solved), axis=-1).tolist()
            for k, (joint, columns) in enumerate(zip(group.joints[some].tolist(), group.columns[some], strict=True)):
                track = _Track(q[:, k], group.axes, solved[:, k], locked[k])
                mask = touched[:, joint]
                key = mask.tobytes()
                if key not in spans:
                    spans[key] = runs(mask)
                pieces[joint] = _pieces(track, columns, given=rows, spans=spans[key], size=size)
    return pieces


@dataclass(frozen=True, eq=False)
class _Track:
    """A joint's rotations `q` (4, F), its `axes`, and one solution of each frame, `solved` (A, F) rad.

    `locked` says whether any frame is at gimbal lock.
    """

    q: FloatArray
    axes: tuple[int, ...]
    solved: FloatArray
    locked: bool

    def near(self, frames: slice, seed: FloatArray) -> FloatArray:
        """Return the angles of some frames, shape (n, A), each nearest the one before, as `angles_near`."""
        if not self.locked:
            return nearest(self.solved[:, frames], seed).T
        return near(self.q[:, frames], self.axes, self.solved[:, frames], seed)


def _pieces(
    track: _Track, columns: IntArray, *, given: GivenRows, spans: Sequence[tuple[int, int]], size: int
) -> list[Piece]:
    """Return one joint's pieces over its runs of touched frames; the input's values (rad) are given(start, stop)."""
    pieces = []
    for start, stop in spans:
        angles, plain = _run(track, lambda a, b: given(a, b)[:, columns], start, stop)
        keep = not plain or track.q.shape[1] <= size
        seed = given(max(start - 1, 0), max(start, 1))[0, columns]
        cuts = [start, *range((start // size + 1) * size, stop, size), stop]
        for first, last in pairwise(cuts):
            kept = np.degrees(angles[first - start : last - start]) if keep else None
            pieces.append(Piece(first, last, seed, kept))
            seed = angles[last - 1 - start].copy()
    return pieces


def piece_angles(motion: Motion, joint: int, *, piece: Piece) -> FloatArray:
    """Return the angles of a piece of touched frames, shape (stop - start, A), degrees."""
    if piece.angles is not None:
        return piece.angles
    q = motion.rotations[piece.start : piece.stop, joint]
    angles: FloatArray = np.degrees(angles_near(q, motion.skeleton.rotation_axes[joint], seed=piece.seed))
    return angles


def _run(track: _Track, given: GivenRows, start: int, stop: int) -> tuple[FloatArray, bool]:
    """Return the angles (rad) of one run of touched frames, shape (stop - start, A), and whether none was put right.

    The input's angles (rad) are given(first, last).
    """
    seed = given(max(start - 1, 0), max(start, 1))[0]
    angles = track.near(slice(start, stop), seed)
    if stop == track.q.shape[1]:
        return angles, True
    last, following = given(stop - 1, stop + 1)
    if not _turns(last - angles[-1]).any():
        return angles, True
    steps = np.diff(given(start, stop), axis=0, prepend=seed[None])
    return _meet_end(track, slice(start, stop), angles, steps, (seed, last, following)), False


def runs(mask: BoolArray) -> list[tuple[int, int]]:
    """Return the (start, stop) of each run of True, stop exclusive."""
    padded = np.concatenate(([False], mask, [False]))
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(a), int(b)) for a, b in zip(edges[0::2], edges[1::2], strict=True)]


def _turns(extra: FloatArray) -> IntArray:
    """Return the half turns by which the step to the first untouched frame exceeds the input's own there."""
    turns: IntArray = np.rint(extra / np.pi).astype(np.intp)
    return turns


def _meet_end(
    track: _Track,
    frames: slice,
    angles: FloatArray,
    steps: FloatArray,
    ends: tuple[FloatArray, FloatArray, FloatArray],
) -> FloatArray:
    """Return a run's angles such that its last frame meets the input's next without a turn that the input has not.

    First the input's own wraps are carried: where its values jump by 360 degrees, so do the run's. Where that is not
    enough, the run is solved backwards from its end too and changes over from the one to the other at the frame
    where that jumps least: the jump cannot be avoided, for the edit winds another way round than the input.

    `steps`, shape of angles, are the input's from the frame before each; `ends` its angles at the frame before the
    run, at the run's last and at the frame after.
    """
    before, last, following = ends
    carried = angles + TURN * np.cumsum(np.rint(steps / TURN), axis=0)
    if not _turns(last - carried[-1]).any():
        return carried
    backward = near(track.q[:, frames][:, ::-1], track.axes, track.solved[:, frames][:, ::-1], following)[::-1]
    jumps = np.abs(backward - np.concatenate((before[None], angles[:-1]))).sum(axis=-1)
    change = int(np.argmin(jumps))
    return np.concatenate((angles[:change], backward[change:]))
