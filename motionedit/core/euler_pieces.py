"""The frames that an edit touched as Euler angles, which meet what stands around them, in pieces for long clips."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.euler import (
    DEGREES,
    angles_near,
    gimbal_locked,
    joints_together,
    near,
    nearest_in_runs,
    radians,
    room_together,
    rows_of_tracks,
    solved_tracks,
)
from motionedit.dataclass import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

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


def touched_angles(motion: Motion, touched: BoolArray, *, given: GivenRows, columns: IntArray, out: FloatArray) -> None:
    """Write the angles of the touched frames of each joint, degrees, as `touched_pieces` has them, all at once.

    Parameters
    ----------
    touched, given
        As of `touched_pieces`.
    columns : shape (C,)
        Where each channel goes in the rows of the result.
    out : shape (F, K)
        Receives them. Of a joint that is touched anywhere, frames that are not get any angles, or none.
    """
    rows = np.flatnonzero(touched.any(axis=1))
    if not len(rows):
        return
    # One frame more on either side: what the runs meet there.
    start, stop = max(int(rows[0]) - 1, 0), min(int(rows[-1]) + 2, len(motion))
    here = _Given(lambda one, other: given(start + one, start + other), whole=True, frames=stop - start)
    for solved in _solved(motion.at(slice(start, stop)), touched[start:stop], here):
        rows_of_tracks(solved.angles, columns[solved.columns], factor=DEGREES, out=out[start:stop])


def touched_pieces(motion: Motion, touched: BoolArray, *, given: GivenRows, size: int) -> dict[int, list[Piece]]:
    """Return the touched frames of each joint in pieces that can be solved by themselves, for `piece_angles`.

    Each run of touched frames starts from the input's angles at the frame before it, or at frame 0, and meets the
    frame after it without a turn that the input has not. They are solved again piece by piece, which costs time but
    hardly any memory.

    Parameters
    ----------
    touched : shape (F, J)
        Where a joint's rotation is to be written.
    given : callable
        given(start, stop) are the input's channel values of those frames, shape (stop - start, C).
    size : int
        No piece reaches over a multiple of this many frames.
    """
    pieces: dict[int, list[Piece]] = {}
    for solved in _solved(motion, touched, _Given(given, whole=False, frames=len(motion))):
        angles = solved.angles
        degrees = angles if solved.plain.all() else np.degrees(angles)
        for i, (k, start, stop) in enumerate(solved.runs.tolist()):
            keep, seed = not solved.plain[i], solved.seeds[i]
            for one, other in pairwise((start, *range((start // size + 1) * size, stop, size), stop)):
                piece = Piece(one, other, seed, degrees[k, :, one:other].T if keep else None)
                pieces.setdefault(int(solved.joints[k]), []).append(piece)
                seed = angles[k, :, other - 1].copy()
    return pieces


@dataclass(frozen=True, eq=False)
class _Solved:
    """G joints that were solved together: their `columns` (G, A), their R `runs`, and what `_angles_of` returns."""

    joints: IntArray
    columns: IntArray
    runs: IntArray
    angles: FloatArray
    seeds: FloatArray
    plain: BoolArray


def _solved(motion: Motion, touched: BoolArray, values: _Given) -> Iterator[_Solved]:
    """Yield the touched joints, some at a time, with their angles in their runs of touched frames.

    The angles' memory serves the next ones, too.
    """
    room = room_together(len(motion), len(motion.skeleton))
    everywhere = bool(touched.all())
    turned = np.asarray(touched.any(axis=0))
    for group in motion.skeleton.rotation_groups:
        places = np.flatnonzero(turned[group.joints])
        for joints, columns in joints_together(group.joints[places], group.columns[places], frames=len(motion)):
            runs = _whole(len(joints), len(motion)) if everywhere else _runs_of(touched[:, joints].T)
            tracks = _Tracks(motion.rotations, joints, group.axes)
            yield _Solved(joints, columns, runs, *_angles_of(tracks, columns, runs, values, room))


class _Given:
    """The input's channel values, rad: the rows that are asked for, or all of a short clip where these are several."""

    def __init__(self, given: GivenRows, *, whole: bool, frames: int) -> None:
        self._given = given
        # Joints mostly ask for the same few rows.
        self._rows: dict[tuple[int, int], FloatArray] = {}
        self._frames = frames if whole else None
        self._whole: FloatArray | None = None

    def between(self, start: int, stop: int) -> FloatArray:
        """Return the values of some frames, shape (stop - start, C)."""
        if self._whole is not None:
            return self._whole[start:stop]
        known = self._rows.get((start, stop))
        if known is None:
            known = self._rows[start, stop] = radians(self._given(start, stop))
        return known

    def at(self, frames: IntArray, columns: IntArray) -> FloatArray:
        """Return the values of R frames, of each the columns, shape (R, A), that are its own."""
        if len(frames) and (frames == frames[0]).all():
            # Where every joint is touched from the first frame on, nothing else is read.
            one: FloatArray = self.between(int(frames[0]), int(frames[0]) + 1)[0, columns]
            return one
        if self._whole is None and self._frames is not None:
            self._whole = self.between(0, self._frames)
        if self._whole is not None:
            return self._whole[frames[:, None], columns]
        rows = [self.between(frame, frame + 1)[0, own] for frame, own in zip(frames.tolist(), columns, strict=True)]
        return np.array(rows).reshape(columns.shape)


@dataclass(frozen=True, eq=False)
class _Tracks:
    """G `joints` that turn about the same `axes`, among those of `rotations` (F, J, 4)."""

    rotations: FloatArray
    joints: IntArray
    axes: tuple[int, ...]

    def between(self, k: int, start: int, stop: int) -> FloatArray:
        """Return the rotations of the k-th joint at some frames, shape (stop - start, 4)."""
        return self.rotations[start:stop, self.joints[k]]


def _angles_of(
    tracks: _Tracks, columns: IntArray, runs: IntArray, given: _Given, room: FloatArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the angles (rad) of joints in their runs of touched frames, the runs' seeds, and which are plain.

    Parameters
    ----------
    columns : shape (G, A)
        The columns of the joints' channels.
    runs : shape (R, 3)
        By `_runs_of`.
    room : FloatArray
        Memory for the angles, as of `solved_tracks`.

    Returns
    -------
    angles : shape (G, A, F)
        Each nearest the frame before, from the seed on; beyond the runs any.
    seeds : shape (R, A)
        The input's angles at the frames before the runs.
    plain : shape (R,)
        Whether nothing was put right where the run ends.
    """
    of, starts, stops = runs.T
    axes, frames = tracks.axes, len(tracks.rotations)
    solved = solved_tracks(tracks.rotations, tracks.joints, axes, room=room)
    seeds = given.at(np.maximum(starts - 1, 0), columns[of])
    locked, inner = np.flatnonzero(gimbal_locked(solved).any(axis=-1)).tolist(), np.flatnonzero(stops < frames)
    angles = nearest_in_runs(solved, runs, seeds, use_up=not (locked or len(inner)))
    for k in locked:
        for i in np.flatnonzero(of == k).tolist():
            start, stop = int(starts[i]), int(stops[i])
            q = tracks.between(k, start, stop)
            angles[k, :, start:stop] = near(q, axes, solved[:, k, start:stop], seeds[i]).T
    plain = np.ones(len(runs), dtype=np.bool_)
    if not len(inner):
        return angles, seeds, plain
    own = columns[of[inner]]
    last, following = given.at(stops[inner] - 1, own), given.at(stops[inner], own)
    turned = _turns(last - angles[of[inner], :, stops[inner] - 1]).any(axis=1)
    for i in np.flatnonzero(turned).tolist():
        k, start, stop = runs[inner[i]].tolist()
        track = _Track(tracks.between(k, start, stop), axes, solved[:, k, start:stop])
        ends = seeds[inner[i]], last[i], following[i]
        steps = np.diff(given.between(start, stop)[:, columns[k]], axis=0, prepend=ends[0][None])
        angles[k, :, start:stop] = _meet_end(track, angles[k, :, start:stop].T, steps, ends).T
    plain[inner[turned]] = False
    return angles, seeds, plain


@dataclass(frozen=True, eq=False)
class _Track:
    """A joint's rotations `q` (n, 4) in a run, its `axes`, and one solution of each frame, `solved` (A, n) rad."""

    q: FloatArray
    axes: tuple[int, ...]
    solved: FloatArray


def piece_angles(motion: Motion, joint: int, *, piece: Piece) -> FloatArray:
    """Return the angles of a piece of touched frames, shape (stop - start, A), degrees."""
    if piece.angles is not None:
        return piece.angles
    q = motion.rotations[piece.start : piece.stop, joint]
    angles: FloatArray = np.degrees(angles_near(q, motion.skeleton.rotation_axes[joint], seed=piece.seed))
    return angles


def _runs_of(masks: BoolArray) -> IntArray:
    """Return (row, start, stop) of each run of True in G masks (G, F), stop exclusive, shape (R, 3)."""
    padded = np.zeros((len(masks), masks.shape[1] + 2), dtype=np.bool_)
    padded[:, 1:-1] = masks
    of, edges = np.nonzero(padded[:, 1:] != padded[:, :-1])
    return np.column_stack((of[::2], edges[::2], edges[1::2]))


def _whole(joints: int, frames: int) -> IntArray:
    """Return the runs of so many joints that are touched at all frames, as `_runs_of`."""
    return np.column_stack((np.arange(joints), np.zeros(joints, np.intp), np.full(joints, frames)))


def _turns(extra: FloatArray) -> IntArray:
    """Return the half turns by which the step to the first untouched frame exceeds the input's own there."""
    turns: IntArray = np.rint(extra / np.pi).astype(np.intp)
    return turns


def _meet_end(
    track: _Track, angles: FloatArray, steps: FloatArray, ends: tuple[FloatArray, FloatArray, FloatArray]
) -> FloatArray:
    """Return a run's angles such that its last frame meets the input's next without a turn that the input has not.

    First the input's own wraps are carried: where its values jump by 360 degrees, so do the run's. Where that is not
    enough, the run is solved backwards from its end too and changes over from the one to the other at the frame
    where that jumps least: the jump cannot be avoided, for the edit winds another way round than the input.

    `steps`, shape of angles, are the input's from the frame before each; `ends` its angles at the frame before the
    run, at the run's last and at the frame after.
    """
    before, last, following = ends
    carried = angles + rot.TURN * np.cumsum(np.rint(steps / rot.TURN), axis=0)
    if not _turns(last - carried[-1]).any():
        return carried
    backward = near(track.q[::-1], track.axes, track.solved[:, ::-1], following)[::-1]
    jumps = np.abs(backward - np.concatenate((before[None], angles[:-1]))).sum(axis=-1)
    change = int(np.argmin(jumps))
    return np.concatenate((angles[:change], backward[change:]))
