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
    from motionedit.core.arrays import BoolArray, FloatArray, IntArray
    from motionedit.core.motion import Motion

TURN = 2.0 * np.pi
_MOST_WOUND = 1e8  # degrees: six of the digits after the point are left
# Within this angle (rad, 1e-4 degrees) of gimbal lock the last angle is kept. The rebuilt rotation is off by no more
# than that; a wider band would cost more than the 2e-4 degrees that are promised.
GIMBAL_BAND = np.radians(1e-4)
# Rotations that are solved together: a short clip's joints cost less than the calls they would take one by one, and
# what is solved together stays in the processor's cache.
TOGETHER = 1 << 13


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
    for group in skeleton.rotation_groups:
        step = max(TOGETHER // len(motion), 1)
        for first in range(0, len(group.joints), step):
            joints, columns = group.joints[first : first + step], group.columns[first : first + step]
            q = np.ascontiguousarray(motion.rotations.transpose(2, 0, 1)[:, :, joints])
            angles = _angles_of_joints(q, group.axes, radians(start[columns.T]))
            values[:, columns.reshape(-1)] = np.degrees(angles).transpose(1, 2, 0).reshape(len(motion), -1)
    return values


def angles_near(q: FloatArray, axes: tuple[int, ...], *, seed: FloatArray) -> FloatArray:
    """Return the Euler angles (rad) of rotations q, shape (F, 4), each nearest the frame before.

    `seed`, shape (A,), stands before frame 0. With one axis or two the rotation nearest q is taken; with three,
    within `GIMBAL_BAND` of gimbal lock, the last angle stays that of the frame before. The result has shape (F, A).
    """
    parts = np.ascontiguousarray(q.T)
    return near(parts, axes, solve_angles(parts, axes), seed)


def near(q: FloatArray, axes: tuple[int, ...], solved: FloatArray, seed: FloatArray) -> FloatArray:
    """Return what `angles_near` does, shape (F, A), from q (4, F) and one solution of each frame, (A, F)."""
    locked = gimbal_locked(solved)
    if not locked.any():
        return nearest(solved, seed).T
    angles = np.empty_like(solved)
    bounds = np.concatenate(([0], np.flatnonzero(locked[1:] != locked[:-1]) + 1, [len(locked)]))
    for start, stop in pairwise(bounds.tolist()):
        if locked[start]:
            undone = rot.conjugate(rot.about_axis(axes[2], seed[2]))
            turned = rot.multiply(q[:, start:stop].T, undone)
            angles[:2, start:stop] = _unwrap(solve_angles(turned.T, axes[:2]), seed[:2])
            angles[2, start:stop] = seed[2]
        else:
            angles[:, start:stop] = nearest(solved[:, start:stop], seed)
        seed = angles[:, stop - 1]
    return angles.T


def _angles_of_joints(q: FloatArray, axes: tuple[int, ...], seed: FloatArray) -> FloatArray:
    """Return what `angles_near` does for G joints at once, shape (A, F, G), from q (4, F, G) and seeds (A, G)."""
    first = solve_angles(q, axes)
    if len(axes) < 3:
        return _unwrap(first, seed)
    locked = gimbal_locked(first).any(axis=0)
    distance = _distances(first, first, seed)
    far = np.flatnonzero((distance >= np.pi).any(axis=0))
    if len(far):
        first[:, :, far] = _changed_over(first[:, :, far], seed[:, far], distance[:, far])
    near = _unwrap(first, seed)
    for joint in np.flatnonzero(locked).tolist():
        near[:, :, joint] = angles_near(q[:, :, joint].T, axes, seed=seed[:, joint]).T
    return near


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
    locked: BoolArray = np.abs(solved[1]) > np.pi / 2.0 - GIMBAL_BAND
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


def nearest_in_runs(first: FloatArray, runs: IntArray, seeds: FloatArray) -> FloatArray:
    """Return what `nearest` does in runs of G joints' frames, shape (G, A, F), from solutions (A, G, F).

    A run, shape (R, 3), is a joint's place, its first frame and the one after its last; it has its own seed, (R, A).
    """
    angles, kernel = np.array(first.swapaxes(0, 1), order="C"), compiled()
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
    d -= TURN * np.rint(d * (1.0 / TURN))
    distance: FloatArray = np.abs(d, out=d).sum(axis=0)
    return distance


def radians(degrees: FloatArray) -> FloatArray:
    """Return a file's angles in radians, those that no body has wound up to without their whole turns.

    Near such an angle no other one can be written: the digits would not reach below a turn.
    """
    wound = np.abs(degrees) > _MOST_WOUND
    return np.radians(np.where(wound, np.fmod(degrees, 360.0), degrees) if wound.any() else degrees)


def _unwrap(angles: FloatArray, seed: FloatArray) -> FloatArray:
    """Return the angles, shape (A, F, ...), by whole turns nearest the frame before."""
    turns = np.empty_like(angles)
    np.subtract(angles[:, 1:], angles[:, :-1], out=turns[:, 1:])
    np.subtract(angles[:, 0], seed, out=turns[:, 0])
    turns *= 1.0 / TURN
    np.rint(turns, out=turns)
    if not turns.any():
        return angles
    unwrapped: FloatArray = angles - TURN * np.cumsum(turns, axis=1)
    return unwrapped
