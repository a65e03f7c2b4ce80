"""What is compiled of whole motions, frame by frame and joint by joint, is what numpy finds."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, held_feet, swaying

from motionedit.core import rotations as rot
from motionedit.core.priorities.continuity.visible import steps_at
from motionedit.core.priorities.edit import changes, prepare
from motionedit.core.priorities.frames import Known, known_again
from motionedit.core.priorities.settings import LayeredSettings

MOTION = swaying(60)


def changed(seed, size):
    """Return the motion with some joints turned, and the root shifted, at some frames, by about `size`."""
    rng = np.random.default_rng(seed)
    turned, shifted = rng.random(MOTION.rotations.shape[:2]) < 0.02, rng.random((len(MOTION), 1, 1)) < 0.2
    turns = rot.exp(size * rng.normal(size=(*turned.shape, 3)))
    rotations = np.where(turned[..., None], rot.multiply(MOTION.rotations, turns), MOTION.rotations)
    shifts = np.where(shifted, size * rng.normal(size=MOTION.translations.shape), 0.0)
    return replace(MOTION, rotations=rotations, translations=MOTION.translations + shifts), turned, shifted[:, 0, 0]


@pytest.mark.compiled
@pytest.mark.parametrize("size", [1e-10, 1e-8, 0.1, 2.0])
def test_frames_that_are_the_same_and_joints_that_turn_and_step_are_those_of_numpy(size, monkeypatch):
    after, turned, shifted = changed(1, size)
    run = prepare(MOTION, held_feet(len(MOTION)), BODY, LayeredSettings())[0]
    done = Known(np.ones(len(MOTION), np.bool_), np.zeros((len(MOTION), 1), np.int64))
    found = []
    for solver in ("", "numpy"):
        monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
        found.append((known_again(run, done, after).done, *changes(MOTION, after, BODY.travel), steps_at(run, after)))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
    same, touched, moved, _ = found[0]
    np.testing.assert_array_equal(same, ~(turned.any(axis=1) | shifted))
    assert (touched.any(), moved.any()) == ((True, True) if size > 1e-9 else (False, False))


def test_where_no_frame_was_done_none_is_again():
    run = prepare(MOTION, held_feet(len(MOTION)), BODY, LayeredSettings())[0]
    none = Known(np.zeros(len(MOTION), np.bool_), np.zeros((len(MOTION), 1), np.int64))
    assert not known_again(run, none, MOTION).done.any()
