"""What an edit adds to knees and elbows: turns about their axes, within limits, whatever the input does."""

from dataclasses import replace

import numpy as np
import pytest
from person import BODY, HARD, SKELETON, edited, end, held_feet, joint, swaying

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends, turns_about
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.hinges import find_hinges
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 60
LIMBS = ("LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm")


def noisy(seed):
    """Return the person with knees and elbows that shake about all axes."""
    motion, rng = swaying(FRAMES), np.random.default_rng(seed)
    rotations = motion.rotations.copy()
    for name in LIMBS:
        rotations[:, joint(name)] = rot.multiply(
            rotations[:, joint(name)], rot.exp(rng.normal(scale=0.04, size=(FRAMES, 3)))
        )
    return Motion(SKELETON, rotations, motion.translations, motion.frame_time)


def hinged(motion):
    bends = find_bends(SKELETON, forward(motion), find_anatomy(SKELETON), first=0)
    return replace(BODY, hinges=tuple(find_hinges(bends)), bends=bends)


def reaching(shift):
    point = ControlPoint("hold", 25, 35, None, np.array(shift))
    return Position(name="hand", priority=4, effector=end("RightHand"), points=(point,), ease_in=12, ease_out=12)


def angles(hinge, rotations):
    return turns_about(hinge.axis, hinge.upper, rot.rotate(rotations, np.tile(hinge.lower, (len(rotations), 1))))


@pytest.fixture(params=["compiled", "numpy"])
def solver(request, monkeypatch):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", request.param if request.param == "numpy" else "")


# In reach; up to the shoulder, which folds the elbow; out of reach, which stretches it.
SHIFTS = [(0.1, 0.1, 0.2), (0.0, 0.4, 0.0), (-1.0, 0.5, 0.5)]


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("shift", SHIFTS)
@pytest.mark.parametrize("passes", [0, 3])
def test_what_is_added_to_a_hinge_is_about_its_axis_after_all_passes_too(shift, passes):
    motion = noisy(3)
    body = hinged(motion)
    edit = edited(motion, [*held_feet(FRAMES), reaching(shift)], LayeredSettings(smoothing=Passes(passes)), body)
    elbow = joint("RightForeArm")
    assert rot.angle_between(edit.motion.rotations[:, elbow], motion.rotations[:, elbow]).max() > 0.05
    for hinge in body.hinges:
        after, before = (each.rotations[:, hinge.joint] for each in (edit.motion, motion))
        v = rot.log(rot.multiply(after, rot.conjugate(before)))
        assert np.linalg.norm(np.cross(v, hinge.axis), axis=1).max() < 1e-9


@pytest.mark.usefixtures("solver")
@pytest.mark.parametrize("shift", [*SHIFTS, (0.3, -0.6, -0.8)])
@pytest.mark.parametrize("seed", [0, 1])
def test_no_elbow_and_no_knee_bends_back_or_beyond_its_limits(shift, seed):
    motion = noisy(seed)
    body = hinged(motion)
    edit = edited(motion, [*held_feet(FRAMES), reaching(shift)], LayeredSettings(), body)
    for hinge in body.hinges:
        found = angles(hinge, edit.motion.rotations[:, hinge.joint])
        assert found.min() > hinge.limits[0] - 1e-9
        assert found.max() < hinge.limits[1] + 1e-9
        assert hinge.limits[0] >= 0.0


@pytest.mark.usefixtures("solver")
def test_an_arm_that_is_pulled_at_stretches_to_its_least_bend_and_no_further():
    motion = swaying(FRAMES)
    body = hinged(motion)
    (elbow,) = (hinge for hinge in body.hinges if hinge.joint == joint("RightForeArm"))
    pulled = replace(reaching((-3.0, 0.5, 1.0)), recruit=RecruitRule("up_to", joint=joint("RightArm")))
    hard, soft = (
        angles(elbow, edited(motion, [pulled], how, body).motion.rotations[:, elbow.joint])
        for how in (HARD, LayeredSettings())
    )
    assert elbow.limits[0] == pytest.approx(np.radians(3.0))
    assert hard.min() == pytest.approx(np.radians(3.0), abs=1e-9)
    assert np.radians(3.0) - 1e-9 <= soft.min() < angles(elbow, motion.rotations[:, elbow.joint]).min()
