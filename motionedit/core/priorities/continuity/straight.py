"""Straight limbs: a singularity that no pull leaves, so that they are bent a little where a layer is not met.

A straight limb cannot begin to shorten: the first derivative of its length by its bend is nothing. One that gives way
to its other side in the input shortens to there, as far as it may. Frames in which a constraint is missed, and a knee
or an elbow straight or bent back that some constraint recruits, are solved again from a bend of a degree, and of as
much as it was bent back: the limb is then as long as before. A body that shall go down is missed, though the feet that
hold it up are not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.frames import Known, Solved, solve_from
from motionedit.dataclass import replace

if TYPE_CHECKING:
    from motionedit.core.arrays import BoolArray, FloatArray
    from motionedit.core.body.bends import Bend
    from motionedit.core.body.hinges import Hinge
    from motionedit.core.priorities.frames import Run

_LITTLE = float(np.radians(1.0))
_BACK = float(np.radians(0.2))  # so far back a limb counts as straight
MISSED = 1e-4  # metres or radians: what is farther from its goal


def bent_where_missed(run: Run, state: Solved) -> Solved:
    """Return a solved motion, frames with missed constraints and limbs straight or bent back solved again.

    A frame keeps what it had where that does not help.
    """
    if np.maximum.reduce(state.left, axis=None, initial=0.0) < MISSED:
        return state
    body, recruited = run.asked.body, frozenset().union(*(each.joints for each in run.asked.recruits))
    bends = [bend for bend in body.bends if bend.joint in recruited and _is_ever_straight(bend)]
    if not bends:
        return state
    missed = state.left.max(axis=1) > MISSED
    rotations = state.motion.rotations.copy()
    again = np.zeros(len(rotations), dtype=np.bool_)
    for bend in bends:
        back = _back(rotations, bend)
        frames = missed & (bend.straight | (back > 0.0)) & _is_recruited(run, bend)
        if not frames.any():
            continue
        hinges = [hinge for hinge in body.hinges if hinge.joint == bend.joint]
        turns = _LITTLE + 2.0 * back[frames]
        rotations[frames, bend.joint] = _bent(rotations[frames, bend.joint], turns, bend, hinges)
        again |= frames
    if not again.any():
        return state
    start = Motion(state.motion.skeleton, rotations, state.motion.translations, state.motion.frame_time)
    solved = solve_from(run, start, Known(~again, state.ranks))
    better = again & _is_better(solved, state)
    return _mixed(solved, state, better)


def _is_ever_straight(bend: Bend) -> bool:
    return bool(bend.straight.any()) or bend.bent[0] < -_BACK


def _back(rotations: FloatArray, bend: Bend) -> FloatArray:
    """Return how far a limb of a motion is bent back, shape (F,), rad: 0 where it is not, or no more than straight."""
    angles = bend.angles_in(rotations)
    return np.where(angles < -_BACK, -angles, 0.0)


def _is_recruited(run: Run, bend: Bend) -> BoolArray:
    """Return at which frames a constraint is active that recruits a knee or an elbow, shape (F,)."""
    there = np.zeros(len(run.motion), dtype=np.bool_)
    for recruits, targets in zip(run.asked.recruits, run.asked.targets, strict=True):
        if bend.joint in recruits.joints:
            there[targets.span] = True
    return there


def _is_better(after: Solved, before: Solved) -> BoolArray:
    """Return at which frames the most important layer that differs is nearer to its goals, shape (F,): met is met."""
    gains = np.maximum(before.left, MISSED) - np.maximum(after.left, MISSED)
    gains[np.abs(gains) < 0.1 * MISSED] = 0.0
    first = np.argmax(gains != 0.0, axis=1)
    better: BoolArray = gains[np.arange(len(gains)), first] > 0.0
    return better


def _bent(rotations: FloatArray, turns: FloatArray, bend: Bend, hinges: list[Hinge]) -> FloatArray:
    """Return a joint's local rotations bent by turns (F,), rad: about its bend's axis, or the nearest of its hinges."""
    if not hinges:
        return rot.multiply(rot.exp(turns[:, None] * bend.axis), rotations)
    identity = np.broadcast_to(rot.IDENTITY, rotations.shape)
    axes = [rot.rotate(rotations if hinge.is_second else identity, hinge.axis) for hinge in hinges]
    along = np.array([axis @ bend.axis for axis in axes])
    nearest = int(np.argmax(np.abs(along).mean(axis=1)))
    turned = rot.exp((turns * np.sign(along[nearest]))[:, None] * hinges[nearest].axis)
    return rot.multiply(rotations, turned) if hinges[nearest].is_second else rot.multiply(turned, rotations)


def _mixed(new: Solved, old: Solved, better: BoolArray) -> Solved:
    """Return the new solution at some frames, the old one at all others."""
    rotations = np.where(better[:, None, None], new.motion.rotations, old.motion.rotations)
    translations = np.where(better[:, None, None], new.motion.translations, old.motion.translations)
    return Solved(
        replace(old.motion, rotations=rotations, translations=translations),
        np.where(better, new.iterations, old.iterations),
        np.where(better, new.converged, old.converged),
        np.where(better[:, None], new.ranks, old.ranks),
        np.where(better[:, None], new.left, old.left),
    )
