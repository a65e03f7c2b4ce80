"""Constraints that follow the reference, another motion of the same body: there, there and back, and where none is."""

import numpy as np
import pytest
from prioritized_edits import DATA, WALK

import motionedit
from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion

SKATING = DATA / "walk-skating.bvh"
FOOT = {"type": "position", "effector": "LeftFoot", "priority": 1, "follow": "reference"}


def test_what_follows_the_reference_rides_its_path(edit):
    after = motionedit.read(edit([FOOT], "--reference", WALK, clip=SKATING).path).motion
    ankle = after.skeleton.names.index("LeftFoot")
    truth = forward(motionedit.read(WALK).motion).positions[:, ankle]
    assert forward(after).positions[:, ankle] == pytest.approx(truth, abs=1e-3)


def test_what_follows_no_reference_is_refused(edit):
    refused = edit([FOOT], clip=SKATING).result
    assert refused.exit_code == 2
    assert "constraints.0.follow: there is no reference to follow; give reference: or --reference" in refused.stderr


@pytest.mark.parametrize("solver", ["compiled", "numpy"])
@pytest.mark.parametrize(
    "keeps",
    [
        {"type": "posture", "joints": ["RightArm", "RightForeArm"]},
        {"type": "orientation", "effector": "RightArm", "recruit": {"joints": ["RightArm"]}},
        {"type": "position", "effector": "RightForeArm"},
    ],
)
def test_what_follows_the_reference_at_times_is_led_there_and_back(edit, tmp_path, monkeypatch, keeps, solver):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
    walk = motionedit.read(WALK).motion
    arm = walk.skeleton.names.index("RightArm")
    turned = walk.rotations.copy()
    turned[:, arm] = rot.multiply(turned[:, arm], rot.exp(np.radians([0.0, 0.0, 40.0])))
    motion = Motion(walk.skeleton, turned, walk.translations, walk.frame_time)
    (tmp_path / "turned.bvh").write_bytes(new_bytes(motion))
    points = [{"during": [50, 70]}]
    edited = edit([{**keeps, "follow": "reference", "points": points}], "--reference", "turned.bvh")
    assert edited.result.exit_code == 0, edited.result.stderr
    place = forward(motionedit.read(edited.path).motion).positions[:, arm + 1]
    there, here = (forward(each).positions[:, arm + 1] for each in (motion, walk))
    assert place[50:71] == pytest.approx(there[50:71], abs=1e-2)
    assert place[[0, 25, 95, 144]] == pytest.approx(here[[0, 25, 95, 144]], abs=1e-2)
    # Over the 19 frames of an ease, not within one of them.
    away = np.linalg.norm(place - here, axis=1) / np.linalg.norm(there - here, axis=1)
    assert np.abs(np.diff(away)).max() < 0.15
