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
from motionedit.core.motion import position_columns, rotation_columns

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion

_TURN = 2.0 * np.pi
# Within this angle (rad, 1e-4 degrees) of gimbal lock the last angle is kept. The rebuilt rotation is off by no more
# than that; a wider band would cost more than the 2e-4 degrees that are promised.
GIMBAL_BAND = np.radians(1e-4)


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
    for joint in range(len(skeleton)):
        columns = rotation_columns(skeleton, [joint])[0]
        if columns:
            seed = np.radians(start[columns])
            angles = angles_near(motion.rotations[:, joint], skeleton.rotation_axes[joint], seed=seed)
            for column, angle in zip(columns, angles.T, strict=True):
                values[:, column] = np.degrees(angle)
    return values


def angle_track(motion: Motion, joint: int, *, given: FloatArray, touched: BoolArray) -> FloatArray:
    """Return one joint's rotation channels, degrees, with the touched frames solved anew.

    Parameters
    ----------
    given : shape (F, A), degrees
        The input's values of the joint's rotation channels. Each run of touched frames starts from the frame before
        it, or from frame 0, and meets the frame after it without a whole turn that the input has not.
    touched : shape (F,)
        Where the joint's rotation is to be written.

    Returns
    -------
    shape (F, A)
        Degrees; as given where not touched.
    """
    axes = motion.skeleton.rotation_axes[joint]
    q = motion.rotations[:, joint]
    radians = np.radians(given)
    track = given.copy()
    for start, stop in runs(touched):
        track[start:stop] = np.degrees(_run(q, axes, radians, start, stop))
    return track


def angles_near(q: FloatArray, axes: tuple[int, ...], *, seed: FloatArray) -> FloatArray:
    """Return the Euler angles (rad) of rotations q, shape (F, 4), each nearest the frame before.

    `seed`, shape (A,), stands before frame 0. With one axis or two the rotation nearest q is taken; with three,
    within `GIMBAL_BAND` of gimbal lock, the last angle stays that of the frame before. The result has shape (F, A).
    """
    first = solve_angles(np.ascontiguousarray(q.T), axes)
    if len(axes) < 3:
        return _unwrap(first, seed).T
    locked = np.abs(first[1]) > np.pi / 2.0 - GIMBAL_BAND
    if not locked.any():
        return _nearest(first, seed).T
    angles = np.empty_like(first)
    bounds = np.concatenate(([0], np.flatnonzero(locked[1:] != locked[:-1]) + 1, [len(q)]))
    for start, stop in pairwise(bounds.tolist()):
        if locked[start]:
            undone = rot.conjugate(rot.about_axis(axes[2], seed[2]))
            turned = rot.multiply(q[start:stop], undone)
            angles[:2, start:stop] = _unwrap(solve_angles(turned.T, axes[:2]), seed[:2])
            angles[2, start:stop] = seed[2]
        else:
            angles[:, start:stop] = _nearest(first[:, start:stop], seed)
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
    sign = 1.0 if (j - i) % 3 == 1 else -1.0  # e_i e_j = sign e_k
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
    np.add(plus, minus, out=angles[0])
    np.subtract(2.0 * np.arctan2(length, other_length), np.pi / 2.0, out=angles[1])
    np.multiply(sign, plus - minus, out=angles[2])
    return angles


def other_solution(angles: FloatArray) -> FloatArray:
    """Return the other triple of the same rotations, (a + pi, pi - b, c + pi), shape (3, ...)."""
    a, b, c = angles
    return np.stack((a + np.pi, np.pi - b, c + np.pi))


def _nearest(first: FloatArray, seed: FloatArray) -> FloatArray:
    """Return, of the triples and their other solutions, shape (3, F), those nearest the frame before, unwrapped."""
    distance = _distances(first, first, seed)
    # The two solutions of one rotation are at least a whole turn apart, so a step below half a turn needs no change.
    if np.any(distance >= np.pi):
        other = other_solution(first)
        changed = np.logical_xor.accumulate(_distances(first, other, seed) < distance)
        first = np.where(changed, other, first)
    return _unwrap(first, seed)


def _distances(before: FloatArray, after: FloatArray, seed: FloatArray) -> FloatArray:
    """Return the sum over the angles of the steps from each frame of `before` to the next of `after`, shape (F,)."""
    d = np.empty_like(after)
    np.subtract(after[:, 1:], before[:, :-1], out=d[:, 1:])
    np.subtract(after[:, 0], seed, out=d[:, 0])
    d -= _TURN * np.rint(d * (1.0 / _TURN))
    distance: FloatArray = np.abs(d, out=d).sum(axis=0)
    return distance


def _unwrap(angles: FloatArray, seed: FloatArray) -> FloatArray:
    """Return the angles, shape (A, F), by whole turns nearest the frame before."""
    turns = np.empty_like(angles)
    np.subtract(angles[:, 1:], angles[:, :-1], out=turns[:, 1:])
    np.subtract(angles[:, 0], seed, out=turns[:, 0])
    turns *= 1.0 / _TURN
    np.rint(turns, out=turns)
    if not turns.any():
        return angles
    unwrapped: FloatArray = angles - _TURN * np.cumsum(turns, axis=1)
    return unwrapped


def _run(q: FloatArray, axes: tuple[int, ...], given: FloatArray, start: int, stop: int) -> FloatArray:
    """Return the angles (rad) of one run of touched frames, shape (stop - start, len(axes))."""
    angles = angles_near(q[start:stop], axes, seed=given[max(start - 1, 0)])
    if stop < len(given) and _turns(given, angles, stop).any():
        return _meet_end(q[start:stop], axes, given, angles, start)
    return angles


def runs(mask: BoolArray) -> list[tuple[int, int]]:
    """Return the (start, stop) of each run of True, stop exclusive."""
    padded = np.concatenate(([False], mask, [False]))
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(a), int(b)) for a, b in zip(edges[0::2], edges[1::2], strict=True)]


def _turns(given: FloatArray, angles: FloatArray, stop: int) -> IntArray:
    """Return the half turns by which the step to the first untouched frame differs from the input's own there."""
    extra = given[stop - 1] - angles[-1]
    turns: IntArray = np.rint(extra / np.pi).astype(np.intp)
    return turns


def _meet_end(q: FloatArray, axes: tuple[int, ...], given: FloatArray, angles: FloatArray, start: int) -> FloatArray:
    """Return a run's angles such that its last frame meets the input's next without a turn that the input has not.

    First the input's own wraps are carried: where its values jump by 360 degrees, so do the run's. Where that is not
    enough, the run is solved backwards from its end too and changes over from the one to the other at the frame
    where that jumps least: the jump cannot be avoided, for the edit winds another way round than the input.
    """
    stop = start + len(q)
    before = given[max(start - 1, 0)]
    steps = np.diff(given[start:stop], axis=0, prepend=before[None])
    carried = angles + _TURN * np.cumsum(np.rint(steps / _TURN), axis=0)
    if not _turns(given, carried, stop).any():
        return carried
    backward = angles_near(q[::-1], axes, seed=given[stop])[::-1]
    joined = np.concatenate((before[None], angles))
    jumps = np.abs(np.concatenate((backward, given[stop][None])) - joined).sum(axis=-1)
    change = int(np.argmin(jumps[:-1]))
    return np.concatenate((angles[:change], backward[change:]))
