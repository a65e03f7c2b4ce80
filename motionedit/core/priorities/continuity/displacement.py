"""Keeping an edit continuous in time: low-passed displacement maps, and the paper's own filters ([PRIO] section 5)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled
from motionedit.core.euler import solve_angles
from motionedit.core.kinematics import forward_of
from motionedit.core.motion import Motion
from motionedit.core.priorities.solver.constants import NO_DISPLACEMENT
from motionedit.core.rotation_vectors import unwrapped
from motionedit.core.timeline.interpolation import gaussian, low_pass

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from motionedit.core.arrays import FloatArray
    from motionedit.core.body.hinges import Hinge

# Half the length of the FIR filter in periods of its cutoff.
_FIR_PERIODS = 1.0


def smoothed_displacement(
    before: Motion, after: Motion, *, sigma: float, first: int, hinges: Sequence[Hinge] = (), use_up: bool = False
) -> Motion:
    """Return the input plus the low-passed displacement of the edit: the next pass's start and reference.

    d = log(q_in^-1 q_out) per joint and the shift in the world, through a zero-phase Gaussian; of a hinge it is
    the turn about its axis a, d = a . log(q_out q_in^-1), and of a joint of two the nearest that they can do.

    Parameters
    ----------
    sigma : float
        Frames.
    first : int
        Frames before it, a rest pose, keep their displacement and lend none.
    use_up : bool
        The result may take the place of `after`, so that of a long clip there is one less.
    """
    translations = _filtered(before, after, lambda shifts: low_pass(shifts, sigma=sigma), first=first)
    kernel, taps = compiled(), gaussian(sigma, len(before) - first)
    axes = _axes(hinges, len(before.skeleton))
    if kernel is not None:
        # Joint by joint: what is written is read no more.
        rotations = after.rotations if use_up else np.empty_like(before.rotations)
        inputs = [np.ascontiguousarray(a) for a in (before.rotations, after.rotations, axes, taps)]
        kernel.smooth(*inputs, rotations, len(before), first, NO_DISPLACEMENT)
        return on_channels(Motion(before.skeleton, rotations, translations, before.frame_time), hinges)
    turns = rot.log(rot.between(before.rotations, after.rotations))
    bent = np.flatnonzero(axes.any(axis=1))
    about = rot.log(rot.multiply(after.rotations[:, bent], rot.conjugate(before.rotations[:, bent])))
    turns[:, bent] = np.sum(about * axes[bent], axis=2, keepdims=True) * axes[bent]
    turns[first:] = unwrapped(turns[first:])
    turns[np.abs(turns) < NO_DISPLACEMENT] = 0.0
    moving = turns.any(axis=(0, 2))
    rotations = before.rotations.copy()
    smooth = turns[:, moving]
    smooth[first:] = low_pass(smooth[first:], sigma=sigma)
    hinged = np.any(axes[moving] != 0.0, axis=1)[None, :, None]
    still, turned = before.rotations[:, moving], rot.exp(smooth)
    rotations[:, moving] = np.where(hinged, rot.multiply(turned, still), rot.multiply(still, turned))
    return on_channels(Motion(before.skeleton, rotations, translations, before.frame_time), hinges)


def _filtered(before: Motion, after: Motion, smooth: Callable[[FloatArray], FloatArray], *, first: int) -> FloatArray:
    """Return the translations of an edit whose shifts (F, 3) went through a filter from frame `first` on.

    They do so along the axes of the world: what carries the travel may hang on a joint that turns.
    """
    skeleton, shifts = before.skeleton, after.translations - before.translations
    for place in np.flatnonzero(shifts[first:].any(axis=(0, 2))).tolist():
        parent, shift = int(skeleton.parents[skeleton.translated[place]]), shifts[first:, place]
        if parent < 0:
            shift[:] = smooth(shift)
        else:
            turns = forward_of(before, parent)[1][first:]
            shift[:] = rot.unrotate(turns, smooth(rot.rotate(turns, shift)))
    return before.translations + shifts


def _axes(hinges: Sequence[Hinge], joints: int) -> FloatArray:
    """Return the axes of joints of one hinge, shape (J, 3), zeros of all others."""
    axes = np.zeros((joints, 3))
    for hinge in hinges:
        axes[hinge.joint] = 0.0 if hinge.is_second else hinge.axis
    return axes


def on_channels(motion: Motion, hinges: Sequence[Hinge]) -> Motion:
    """Return a motion whose joints of two hinges turn about these alone: each at the nearest such rotation.

    A low-passed displacement is about any axis, and what two channels cannot say would be lost in the file.
    """
    axes = motion.skeleton.rotation_axes
    joints = [hinge.joint for hinge in hinges if hinge.is_second]
    if not joints:
        return motion
    rotations = motion.rotations.copy()
    for joint in joints:
        angles = solve_angles(rotations[:, joint].T, axes[joint])
        rotations[:, joint] = rot.from_euler(angles.T, axes[joint])
    return Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)


def filtered_root(before: Motion, after: Motion, *, cutoff: float, first: int) -> Motion:
    """Return the edit with the root's displacement through the paper's FIR low-pass; `cutoff` in Hz."""
    by = cutoff * before.frame_time
    translations = _filtered(before, after, lambda shifts: fir_low_pass(shifts, cutoff=by), first=first)
    return Motion(after.skeleton, after.rotations, translations, after.frame_time)


def fir_low_pass(rows: FloatArray, *, cutoff: float) -> FloatArray:
    """Return rows (F, D) through a windowed-sinc (Hamming) low-pass of linear phase, delay taken out, ends held.

    `cutoff` is in cycles per frame; 0.5 and more changes nothing.
    """
    if cutoff >= 0.5:
        return rows.copy()
    radius = int(np.ceil(_FIR_PERIODS / cutoff))
    n = np.arange(-radius, radius + 1)
    taps = np.sinc(2.0 * cutoff * n) * np.hamming(2 * radius + 1)
    taps /= taps.sum()
    padded = np.concatenate((np.repeat(rows[:1], radius, axis=0), rows, np.repeat(rows[-1:], radius, axis=0)))
    return np.stack([np.convolve(column, taps, mode="valid") for column in padded.T], axis=1)
