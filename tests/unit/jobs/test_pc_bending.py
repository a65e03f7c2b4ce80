"""An edit whose elbow is bent back is turned, and given up where what meets its goals bends it back again."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip
from motionedit.core.coefficients.edit import CoefficientEdit
from motionedit.core.motion import Motion
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.edit_pc.bending import edit_bending

WALK = Path(__file__).resolve().parents[3] / "data" / "walk.bvh"


@pytest.fixture(scope="module")
def bent_back():
    """Return (facts, elbow, edit): an edit that bends the left elbow back by 60 degrees for a second."""
    facts = facts_of(read_clip(WALK))
    motion = facts.clip.motion
    elbow = motion.skeleton.names.index("LeftForeArm")
    axis = next(bend.axis for bend in facts.bends if bend.joint == elbow)
    rotations = motion.rotations.copy()
    rotations[40:64, elbow] = rot.exp(np.radians(-60.0) * axis)
    nothing = np.zeros(rotations.shape[:2], dtype=bool)
    edited = Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)
    return facts, elbow, CoefficientEdit(edited, nothing, nothing[:, 0], (), np.zeros(0))


def as_it_is(given, *_):
    """Return a motion, or an edit, as it was given."""
    return given


def test_a_limb_that_was_bent_back_is_not_and_is_known_to_be_turned(bent_back):
    facts, elbow, edit = bent_back
    stood = []

    def standing(edit, still):
        stood.append(set(still))
        return edit

    found = edit_bending(edit, as_it_is, standing, [], facts)
    axis = next(bend.axis for bend in facts.bends if bend.joint == elbow)
    assert (rot.log(found.motion.rotations[40:64, elbow]) @ axis >= 0.0).all()
    np.testing.assert_array_equal(found.motion.rotations[:40, elbow], edit.motion.rotations[:40, elbow])
    assert found.touched[:, elbow].all()
    assert not np.delete(found.touched, elbow, axis=1).any()
    assert stood == [set(), {elbow}]


def test_an_edit_stays_where_its_goals_bend_the_limb_back_each_time(bent_back):
    facts, elbow, edit = bent_back
    asked = []

    def again(_motion, _requests, still):
        asked.append(set(still))
        return edit.motion

    assert edit_bending(edit, again, as_it_is, [], facts) is edit
    assert len(asked) >= 2
    assert all(still == {elbow} for still in asked)
