"""Edits by a database of four near copies of one kick: what they do not vary by a body may do all the same."""

from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.motion import Motion

KICK = Path(__file__).resolve().parents[2] / "data" / "kick.bvh"
HIGHEST = 36  # the frame of the kick


@pytest.fixture(scope="module")
def copies(tmp_path_factory):
    """Return a model of four kicks that differ by a fraction of a degree."""
    kick, random, folder = motionedit.read(KICK), np.random.default_rng(5), tmp_path_factory.mktemp("kicks")
    slow = np.sin(np.linspace(0.0, np.pi, len(kick.motion)))[:, None, None]
    for number in range(4):
        turns = rot.exp(np.radians(0.3) * slow * random.normal(size=(1, len(kick.motion.skeleton), 3)))
        rotations = frozen(rot.multiply(kick.motion.rotations, turns))
        motion = Motion(kick.motion.skeleton, rotations, kick.motion.translations, kick.motion.frame_time)
        motionedit.write(kick.with_motion(motion), folder / f"kick{number}.bvh")
    frames = {f"kick{number}": HIGHEST for number in range(4)}
    return motionedit.fit_pca(motionedit.normalize(folder, {"events": {"kick": {"frames": frames}}}))


def edited(copies, effector, shift, **spec):
    goal = {"name": "higher", "at": "kick", "effector": effector, "shift": shift}
    content = {"unit": "cm", "events": {"kick": HIGHEST}, "goals": [goal], **spec}
    return motionedit.edit_pc(KICK, copies, content)


@pytest.mark.parametrize("height", [5.0, 10.0, 20.0])
def test_a_kick_goes_higher_than_any_of_its_near_copies_on_a_foot_that_stands(copies, height):
    edit = edited(copies, "RightFoot", [0.0, height, 0.0])
    assert edit.report["status"] == "ok"
    assert edit.report["goals"][0]["error_max"] < 0.01
    assert edit.report["metrics"]["foot_drift_max"] < 0.5
    before, after = (kinematics.forward(clip.motion).positions for clip in (motionedit.read(KICK), edit.clip))
    jerks = [float(np.sqrt(np.mean(np.diff(path, 3, axis=0) ** 2))) for path in (before, after)]
    assert jerks[1] < 1.15 * jerks[0]


def test_what_legs_that_stand_do_not_reach_is_said_so(copies):
    high = edited(copies, "Head", [0.0, 12.0, 0.0])
    assert high.report["status"] == "unreachable"
    assert "out of reach with feet that stand" in high.warnings[0]
    assert high.report["metrics"]["foot_drift_max"] < 0.5
