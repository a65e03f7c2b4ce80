"""Rotations back to Euler angles that stay continuous from frame to frame, for whole tracks at once.

A rotation has two triples of Tait-Bryan angles, (a, b, c) and (a + pi, pi - b, c + pi), each up to whole turns. The
one nearest the frame before is taken. The distance between two frames' triples does not change when both are swapped
for the other solution, so whether to change over between two frames does not depend on what was chosen before: the
choices are a running exclusive or, the whole turns a running sum.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled
from motionedit.core.motion import position_columns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion

# As `np.degrees` has it.
DEGREES = 180.0 / np.pi
MOST_WOUND = 1e8  # degrees: six of the digits after the point are left
# Within this angle (rad, 1e-4 degrees) of gimbal lock the last angle is kept. The rebuilt rotation is off by no more
# than that; a wider band would cost more than the 2e-4 degrees that are promised.
GIMBAL_BAND = np.radians(1e-4)
MOST_MIDDLE = np.pi / 2.0 - GIMBAL_BAND  # rad: middle angles beyond it, to either side, are in the band
# Rotations that are solved together stay in the processor's cache.
_TOGETHER = 1 << 13
# Rotations whose angles are held at once, near the processor: all of a short clip, some joints of a long one.
HELD = 1 << 16


def joint_angles(motion: Motion, *, start: FloatArray) -> FloatArray:
    """Return the channel values of a motion, each the Euler solution nearest the frame before.

    Parameters
    ----------
    motion : Motion
        F frames.
    start : shape (C,), degrees and clip units
        The row that frame 0 is nearest to: the input's first.

    Returns
    -------
    shape (F, C)
        Degrees and clip units, in the file's channel order.
    """
    skeleton = motion.skeleton
    values = np.empty((len(motion), skeleton.channel_count))
    for p, joint in enumerate(skeleton.translated.tolist()):
        for axis, column in position_columns(skeleton, joint):
            values[:, column] = motion.translations[:, p, axis]
    room = room_together(len(motion), len(skeleton))
    for group in skeleton.rotation_groups:
        for joints, columns in joints_together(group.joints, group.columns, frames=len(motion)):
            solved = solved_tracks(motion.rotations, joints, group.axes, room=room)
            seeds = radians(start[columns])
            locked = np.flatnonzero(gimbal_locked(solved).any(axis=-1)).tolist()
            whole = [(k, 0, len(motion)) for k in range(len(joints))]
            angles = nearest_in_runs(solved, np.array(whole, dtype=np.int64), seeds, use_up=not locked)
            for k in locked:
                angles[k] = near(motion.rotations[:, joints[k]], group.axes, solved[:, k], seeds[k]).T
            rows_of_tracks(angles, columns, factor=DEGREES, out=values)
    return values


def joints_together(joints: IntArray, columns: IntArray, *, frames: int) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield as many joints at a time, with their columns (G, A), as are held at once in a clip of so many frames."""
    step = max(HELD // frames, 1)
    for first in range(0, len(joints), step):
        yield joints[first : first + step], columns[first : first + step]


def room_together(frames: int, joints: int) -> FloatArray:
    """Return memory for the angles of as many of so many joints as `joints_together` yields at a time."""
    return np.empty(3 * min(max(HELD, frames), frames * joints))


def rows_of_tracks(tracks: FloatArray, columns: IntArray, *, factor: float, out: FloatArray) -> None:
    """Write tracks, shape (G, A, F), times a factor into columns (G, A) of rows `out`, shape (F, C)."""
    kernel = compiled()
    if kernel is None:
        out[:, columns.reshape(-1)] = (tracks * factor).reshape(-1, tracks.shape[2]).T
        return
    places = np.ascontiguousarray(columns, dtype=np.int64)
    kernel.rows_of_tracks(np.ascontiguousarray(tracks), places, tracks.shape[2], factor, out)


def solved_tracks(
    rotations: FloatArray, joints: IntArray, axes: tuple[int, ...], *, room: FloatArray | None = None
) -> FloatArray:
    """Return one solution of the Euler angles (rad) of some joints at all frames, shape (A, G, F).

    `rotations`, shape (F, J, 4), are those of all joints: block by block, for to pick joint after joint out of a
    long clip takes longer than to solve them. `room`, at least as many numbers as there are angles, is the result's
    memory, if it is given: a system gives memory slowly.
    """
    # Joint by joint in memory, as they are made continuous.
    count = len(joints) * len(axes) * len(rotations)
    whole = np.empty(count) if room is None else room[:count]
    solved = whole.reshape(len(joints), len(axes), len(rotations)).swapaxes(0, 1)
    kernel = compiled() if len(axes) == 3 else None
    rotations = np.ascontiguousarray(rotations, dtype=np.float64)
    places = np.ascontiguousarray(joints, dtype=np.int64)
    blocks = list(_blocks(len(rotations), len(joints)))
    scratch = np.empty(6 * len(joints) * max((block.stop for block in blocks[:1]), default=0))
    for block in blocks:
        if kernel is None:
            q = np.ascontiguousarray(rotations[block, joints].transpose(2, 1, 0))
            solved[:, :, block] = solve_angles(q, axes)
        else:
            shape = 6, len(joints), block.stop - block.start
            sums = scratch[: 6 * shape[1] * shape[2]].reshape(shape)
            kernel.euler_sums(rotations[block], rotations.shape[1], places, *axes, sums)
            solved[:, :, block] = _angles_of_sums(sums, axes)
    return solved


def _angles_of_sums(sums: FloatArray, axes: tuple[int, ...]) -> FloatArray:
    """Return what `solve_angles` does of three axes, shape (3, ...), from its sums (6, ...), which are used up."""
    arc_tangents(sums)
    plus, minus, middle = sums[::2]
    np.add(plus, minus, out=sums[1])
    np.subtract(plus, minus, out=sums[5])
    sums[5] *= rot.sign_of(axes)
    np.multiply(middle, 2.0, out=sums[3])
    sums[3] -= np.pi / 2.0
    return sums[1::2]


def arc_tangents(sums: FloatArray) -> None:
    """Put the arc tangents of three pairs, shape (6, ...), in place of the first of each."""
    for k in (0, 2, 4):
        np.arctan2(sums[k], sums[k + 1], out=sums[k])


def _blocks(frames: int, joints: int) -> Iterator[slice]:
    """Yield blocks of frames of so many joints that are solved together."""
    step = max(_TOGETHER // joints, 1)
    for start in range(0, frames, step):
        yield slice(start, min(start + step, frames))


def angles_near(q: FloatArray, axes: tuple[int, ...], *, seed: FloatArray) -> FloatArray:
    """Return the Euler angles (rad) of rotations q, shape (F, 4), each nearest the frame before.

    `seed`, shape (A,), stands before frame 0. With one axis or two the rotation nearest q is taken; with three,
    within `GIMBAL_BAND` of gimbal lock, the last angle stays that of the frame before. The result has shape (F, A).
    """
    return near(q, axes, solve_angles(np.ascontiguousarray(q.T), axes), seed)


def near(q: FloatArray, axes: tuple[int, ...], solved: FloatArray, seed: FloatArray) -> FloatArray:
    """Return what `angles_near` does, shape (F, A), from q (F, 4) and one solution of each frame, (A, F)."""
    locked = gimbal_locked(solved)
    if not locked.any():
        return nearest(solved, seed).T
    angles = np.empty_like(solved)
    bounds = np.concatenate(([0], np.flatnonzero(locked[1:] != locked[:-1]) + 1, [len(locked)]))
    for start, stop in pairwise(bounds.tolist()):
        if locked[start]:
            undone = rot.conjugate(rot.about_axis(axes[2], seed[2]))
            turned = rot.multiply(q[start:stop], undone)
            angles[:2, start:stop] = _unwrap(solve_angles(turned.T, axes[:2]), seed[:2])
            angles[2, start:stop] = seed[2]
        else:
            angles[:, start:stop] = nearest(solved[:, start:stop], seed)
        seed = angles[:, stop - 1]
    return angles.T


def solve_angles(q: FloatArray, axes: tuple[int, ...]) -> FloatArray:
    """Return one solution of Euler angles (rad), shape (A, ...): exact with three axes, else the nearest rotation.

    R = R_i(a) R_j(b) R_k(c), from the sum and the difference of half angles (Bernardes and Viollet 2022). With two
    axes q . (q_i q_j) is a 2 x 2 bilinear form of half angles, whose largest singular value has the same closed form.

    Parameters
    ----------
    q : shape (4, ...)
        Unit quaternions, part by part.
    axes : 1 to 3 different axes
        In channel order.
    """
    if len(axes) == 1:
        angle: FloatArray = 2.0 * np.arctan2(q[1 + axes[0]], q[0])[None]
        return angle
    i, j = axes[:2]
    sign = rot.sign_of(axes)
    w, x, y, z = q[0], q[1 + i], q[1 + j], sign * q[1 + (3 - i - j)]
    if len(axes) == 2:
        plus, minus = np.arctan2(x + y, w - z), np.arctan2(x - y, w + z)
        return np.stack((plus + minus, plus - minus))
    sine, cosine = x + z, w + y  # of half the sum of the outer angles, times that of the middle one
    other_sine, other_cosine = x - z, w - y  # of half their difference
    plus, minus = np.arctan2(sine, cosine), np.arctan2(other_sine, other_cosine)
    # By the lengths, not by an arc sine: exact near gimbal lock too.
    length = np.sqrt(sine * sine + cosine * cosine)
    other_length = np.sqrt(other_sine * other_sine + other_cosine * other_cosine)
    angles = np.empty((3, *w.shape))
    angles[0] = plus + minus
    angles[1] = 2.0 * np.arctan2(length, other_length) - np.pi / 2.0
    angles[2] = sign * (plus - minus)
    return angles


def other_solution(angles: FloatArray) -> FloatArray:
    """Return the other triple of the same rotations, (a + pi, pi - b, c + pi), shape (3, ...)."""
    a, b, c = angles
    return np.stack((a + np.pi, np.pi - b, c + np.pi))


def gimbal_locked(solved: FloatArray) -> BoolArray:
    """Return at which frames angles (A, ..., F) are so near gimbal lock that the last one is kept, shape (..., F)."""
    if len(solved) < 3:
        return np.zeros(solved.shape[1:], dtype=np.bool_)
    locked: BoolArray = np.abs(solved[1]) > MOST_MIDDLE
    return locked


def nearest(first: FloatArray, seed: FloatArray) -> FloatArray:
    """Return angles (A, F) nearest the frame before, by whole turns, and of triples by their other solutions."""
    kernel = compiled()
    if kernel is not None:
        whole = np.array([[0, 0, first.shape[1]]])
        angles: FloatArray = nearest_in_runs(first[:, None], whole, seed[None])[0]
        return angles
    if len(first) < 3:
        return _unwrap(first, seed)
    distance = _distances(first, first, seed)
    # The two solutions of one rotation are at least a whole turn apart, so a step below half a turn needs no change.
    if np.any(distance >= np.pi):
        first = _changed_over(first, seed, distance)
    return _unwrap(first, seed)


def nearest_in_runs(first: FloatArray, runs: IntArray, seeds: FloatArray, *, use_up: bool = False) -> FloatArray:
    """Return what `nearest` does in runs of G joints' frames, shape (G, A, F), from solutions (A, G, F).

    A run, shape (R, 3), is a joint's place, its first frame and the one after its last; it has its own seed, (R, A).
    Solutions that are used up may be the result's memory.
    """
    joint_by_joint = first.swapaxes(0, 1)
    angles = np.ascontiguousarray(joint_by_joint) if use_up else np.array(joint_by_joint, order="C")
    kernel = compiled()
    if kernel is not None:
        whole = np.ascontiguousarray(runs, dtype=np.int64), np.ascontiguousarray(seeds)
        kernel.nearest_angles(angles, *whole, angles.shape[2])
        return angles
    for (joint, start, stop), seed in zip(runs.tolist(), seeds, strict=True):
        angles[joint, :, start:stop] = nearest(first[:, joint, start:stop], seed)
    return angles


def _changed_over(first: FloatArray, seed: FloatArray, distance: FloatArray) -> FloatArray:
    """Return the triples, or their other solutions where these are nearer the frame before: `distance` is theirs."""
    other = other_solution(first)
    changed = np.logical_xor.accumulate(_distances(first, other, seed) < distance, axis=0)
    return np.where(changed, other, first)


def _distances(before: FloatArray, after: FloatArray, seed: FloatArray) -> FloatArray:
    """Return the sum over the angles of the steps from each frame of `before` to the next of `after`, (F, ...)."""
    d = np.empty_like(after)
    np.subtract(after[:, 1:], before[:, :-1], out=d[:, 1:])
    np.subtract(after[:, 0], seed, out=d[:, 0])
    d -= rot.TURN * np.rint(d * (1.0 / rot.TURN))
    distance: FloatArray = np.abs(d, out=d).sum(axis=0)
    return distance


def radians(degrees: FloatArray) -> FloatArray:
    """Return a file's angles in radians, those that no body has wound up to without their whole turns.

    Near such an angle no other one can be written: the digits would not reach below a turn.
    """
    wound = np.abs(degrees) > MOST_WOUND
    return np.radians(np.where(wound, np.fmod(degrees, 360.0), degrees) if wound.any() else degrees)


def _unwrap(angles: FloatArray, seed: FloatArray) -> FloatArray:
    """Return the angles, shape (A, F, ...), by whole turns nearest the frame before."""
    turns = np.empty_like(angles)
    np.subtract(angles[:, 1:], angles[:, :-1], out=turns[:, 1:])
    np.subtract(angles[:, 0], seed, out=turns[:, 0])
    turns *= 1.0 / rot.TURN
    np.rint(turns, out=turns)
    if not turns.any():
        return angles
    unwrapped: FloatArray = angles - rot.TURN * np.cumsum(turns, axis=1)
    return unwrapped
