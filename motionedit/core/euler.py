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
            values[:, columns] = np.degrees(angles)
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

    `seed`, shape (len(axes),), stands before frame 0. With one axis or two the rotation nearest q is taken; with
    three, within `GIMBAL_BAND` of gimbal lock, the last angle stays that of the frame before.
    """
    first = solve_angles(q, axes)
    if len(axes) < 3:
        return _unwrap(first, seed)
    locked = np.abs(np.cos(first[:, 1])) < np.sin(GIMBAL_BAND)
    if not locked.any():
        return _nearest(first, seed)
    angles = np.empty_like(first)
    bounds = np.concatenate(([0], np.flatnonzero(locked[1:] != locked[:-1]) + 1, [len(q)]))
    for start, stop in pairwise(bounds.tolist()):
        if locked[start]:
            last = np.full(stop - start, seed[2])
            turned = rot.multiply(q[start:stop], rot.conjugate(rot.about_axis(axes[2], last)))
            angles[start:stop, :2] = _unwrap(solve_angles(turned, axes[:2]), seed[:2])
            angles[start:stop, 2] = last
        else:
            angles[start:stop] = _nearest(first[start:stop], seed)
        seed = angles[stop - 1]
    return angles


def solve_angles(q: FloatArray, axes: tuple[int, ...]) -> FloatArray:
    """Return one solution of Euler angles (rad), shape (..., len(axes)): exact with three axes, else the nearest.

    R = R_i(a) R_j(b) R_k(c) with the half angles of q (Bernardes and Viollet 2022); with two axes q . (q_i q_j) is a
    2 x 2 bilinear form of half angles, whose largest singular value has the same closed form.
    """
    w = q[..., 0]
    if len(axes) == 1:
        angle: FloatArray = 2.0 * np.arctan2(q[..., 1 + axes[0]], w)[..., None]
        return angle
    i, j = axes[:2]
    k = 3 - i - j
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    x, y, z = q[..., 1 + i], q[..., 1 + j], sign * q[..., 1 + k]
    if len(axes) == 2:
        plus, minus = np.arctan2(x + y, w - z), np.arctan2(x - y, w + z)
        return np.stack((plus + minus, plus - minus), axis=-1)
    # Sum and difference of the outer half angles; their lengths give the middle one, exact near gimbal lock too.
    plus, minus = np.arctan2(x + z, w + y), np.arctan2(x - z, w - y)
    middle = 2.0 * np.arctan2(np.hypot(x + z, w + y), np.hypot(x - z, w - y)) - np.pi / 2.0
    return np.stack((plus + minus, middle, sign * (plus - minus)), axis=-1)


def other_solution(angles: FloatArray) -> FloatArray:
    """Return the other triple of the same rotations, (a + pi, pi - b, c + pi), shape (..., 3)."""
    return angles * np.array([1.0, -1.0, 1.0]) + np.pi


def _nearest(first: FloatArray, seed: FloatArray) -> FloatArray:
    before = np.concatenate((seed[None], first[:-1]))
    other = other_solution(first)
    change = _distance(before, other) < _distance(before, first)
    changed = np.logical_xor.accumulate(change)
    return _unwrap(np.where(changed[:, None], other, first), seed)


def _distance(a: FloatArray, b: FloatArray) -> FloatArray:
    d = a - b
    d -= _TURN * np.rint(d / _TURN)
    distance: FloatArray = np.abs(d).sum(axis=-1)
    return distance


def _unwrap(angles: FloatArray, seed: FloatArray) -> FloatArray:
    steps = np.diff(angles, axis=0, prepend=seed[None])
    unwrapped: FloatArray = angles - _TURN * np.cumsum(np.rint(steps / _TURN), axis=0)
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
