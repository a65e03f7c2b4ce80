"""Joints with two rotation channels are two hinges, a root with two position channels moves along those."""

from dataclasses import replace

import numpy as np
import pytest
from human import skeleton_of, standing
from hypothesis import given, settings
from hypothesis import strategies as st

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.hinges import channel_hinges
from motionedit.core.euler import joint_angles
from motionedit.core.kinematics import Effector, forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.settings import Body, LayeredSettings, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint

PAIRS = [(a, b) for a in "XYZ" for b in "XYZ" if a != b]
FRAMES = 9


def with_channels(skeleton, changes):
    """Return the skeleton with other channels for some joints."""
    channels = [changes.get(name, own) for name, own in zip(skeleton.names, skeleton.channels, strict=True)]
    return replace(skeleton, channels=tuple(map(tuple, channels)))


def bent(skeleton, seed):
    """Return a motion in which every joint turns about the axes of its channels alone."""
    rng = np.random.default_rng(seed)
    motion = standing(skeleton, FRAMES)
    rotations = motion.rotations.copy()
    for joint, axes in enumerate(skeleton.rotation_axes):
        angles = 0.4 * rng.normal(size=len(axes)) + 0.03 * rng.normal(size=(FRAMES, len(axes)))
        rotations[:, joint] = rot.from_euler(angles, axes)
    return Motion(skeleton, rotations, motion.translations, motion.frame_time)


def reach(motion, shift, monkeypatch, solver):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", solver)
    skeleton = motion.skeleton
    hinges = [hinge for each in channel_hinges(skeleton).values() for hinge in each]
    body = Body(find_masses(skeleton, find_anatomy(skeleton)), tuple(hinges), 0, 0)
    point = ControlPoint("hold", 2, 6, None, np.array(shift))
    effector = Effector(skeleton.names.index("LeftHand"), np.array([0.0, -0.1, 0.0]))
    constraint = Position(name="hand", effector=effector, points=(point,))
    return edit_by_priorities(motion, [constraint], body, LayeredSettings(smoothing=Passes(1)))


@settings(max_examples=25)
@given(st.sampled_from(PAIRS), st.sampled_from(PAIRS), st.integers(0, 1000))
def test_both_solvers_turn_a_joint_by_its_two_channels_alone(elbow, shoulder, seed):
    changes = {
        "LeftForeArm": [f"{axis}rotation" for axis in elbow],
        "LeftArm": [f"{axis}rotation" for axis in shoulder],
        "Spine1": ["Xrotation"],
    }
    motion = bent(with_channels(skeleton_of(), changes), seed)
    with pytest.MonkeyPatch.context() as patch:
        edits = [reach(motion, (0.08, 0.1, 0.1), patch, solver) for solver in ("", "numpy")]
    for edit in edits:
        assert edit.errors[0].positions.max() < 1e-5
        # What the file's channels cannot say would be lost in it.
        again = from_channels(edit.motion)
        assert rot.angle_between(again, edit.motion.rotations).max() < 1e-7
    assert rot.angle_between(edits[0].motion.rotations, edits[1].motion.rotations).max() < 1e-8


def from_channels(motion):
    """Return a motion's rotations rebuilt from the angles of its channels."""
    skeleton = motion.skeleton
    angles = joint_angles(motion, start=np.zeros(skeleton.channel_count))
    rotations = np.broadcast_to(rot.IDENTITY, motion.rotations.shape).copy()
    for joint, axes in enumerate(skeleton.rotation_axes):
        columns = skeleton.columns(joint, "rotation")
        if axes:
            rotations[:, joint] = rot.from_euler(np.radians(angles[:, columns]), axes)
    return rotations


def test_a_root_moves_along_the_position_channels_that_it_has(monkeypatch):
    turns = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = with_channels(skeleton_of(), {"Hips": ("Xposition", "Zposition", *turns)})
    motion = bent(skeleton, 5)
    edit = reach(motion, (0.3, 0.0, 0.3), monkeypatch, "")
    assert edit.errors[0].positions.max() < 1e-5
    moved = edit.motion.translations - motion.translations
    assert np.abs(moved[..., 1]).max() == 0.0
    assert np.abs(moved[4, 0, [0, 2]]).min() > 1e-3


def test_a_root_below_a_turned_one_moves_along_its_own_axes(monkeypatch):
    from human import BONES, above

    skeleton = skeleton_of(above(BONES, "Root"))
    turns = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = with_channels(skeleton, {"Root": turns, "Hips": ("Yposition", *turns)})
    motion = bent(skeleton, 3)
    hinges = channel_hinges(skeleton)
    assert hinges == {}
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "")
    travel = skeleton.names.index("Hips")
    body = Body(find_masses(skeleton, find_anatomy(skeleton)), (), travel, 0)
    up = rot.rotate(forward(motion).rotations[:, 0], np.array([0.0, 1.0, 0.0]))
    point = ControlPoint("hold", 2, 6, None, 0.2 * up[2])
    constraint = Position(name="hips", effector=Effector(travel, np.zeros(3)), points=(point,))
    edit = edit_by_priorities(motion, [constraint], body, LayeredSettings(smoothing=Passes(0)))
    moved = edit.motion.translations - motion.translations
    assert np.abs(moved[..., [0, 2]]).max() < 1e-12
    assert moved[2, 0, 1] == pytest.approx(0.2, abs=1e-6)
    np.testing.assert_array_equal(edit.motion.rotations[:, 0], motion.rotations[:, 0])


def test_a_joint_of_three_channels_has_no_such_hinge_and_one_of_two_has_two():
    skeleton = with_channels(skeleton_of(), {"LeftLeg": ("Xrotation",), "LeftArm": ("Zrotation", "Yrotation")})
    found = {skeleton.names[joint]: hinges for joint, hinges in channel_hinges(skeleton).items()}
    assert set(found) == {"LeftLeg", "LeftArm"}
    assert [(hinge.axis.tolist(), hinge.is_second) for hinge in found["LeftArm"]] == [
        ([0.0, 0.0, 1.0], False),
        ([0.0, 1.0, 0.0], True),
    ]
