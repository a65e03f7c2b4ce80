"""Which way is up: by the floor, the OFFSETs and the way the body stands, and what is said where they disagree."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, HIPS_HEIGHT, ROOT_CHANNELS, skeleton_of, standing, with_rotation
from hypothesis import given, settings
from hypothesis import strategies as st
from rig_rows import DOG
from rigs import FILES, Rig, found_in, mirrored, motion_of
from takes import TAKES, Take, about, clock, smooth, walks, wave, waving

from motionedit.core import rotations as rot
from motionedit.core.body.bones import bones_of, travel_joint
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ground import axis_name, axis_vector
from motionedit.core.body.up import find_up
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.skeleton import Skeleton

RATE = 60.0
PASSING = {"handstands": "-y", "lies": "-z", "falls": "-z", "swims": "z"}


def up_of(motion, *, first=0):
    """Return the name of the axis that is up, and what is said about it."""
    travel = travel_joint(motion)
    bones, poses = bones_of(motion, travel), forward(motion)
    found = find_up(motion, bones, poses, find_anatomy(bones, poses=poses), first=first, travel=travel)
    np.testing.assert_array_equal(found.axis, axis_vector(axis_name(found.axis)))
    return axis_name(found.axis), found.warning


def turned(motion, vector):
    """Return the motion in a world turned by a rotation vector: its OFFSETs stay as they are."""
    turn = rot.exp(np.asarray(vector, dtype=float))
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    translations[:, 0] = rot.rotate(turn, translations[:, 0])
    return Motion(motion.skeleton, rotations, translations, motion.frame_time)


TO_Z_UP = [np.pi / 2, 0.0, 0.0]


@pytest.mark.parametrize("name", FILES)
def test_up_is_the_axis_and_the_sign_along_which_a_body_stands(name):
    turn = FILES[name]
    assert up_of(standing(skeleton_of(turn=turn), at=turn @ np.array([0.3, HIPS_HEIGHT, 2.0]))) == (name, None)


@pytest.mark.parametrize("name", FILES)
def test_a_walk_says_what_is_up_under_any_axis(name):
    assert up_of(motion_of(Rig(up=name), walks(RATE))) == (name, None)


@pytest.mark.parametrize("take", PASSING)
def test_a_body_that_mostly_does_not_stand_has_the_way_of_its_offsets_and_that_is_said(take):
    for up in "yz":
        found = found_in(Rig(up=up), TAKES[take](RATE))
        assert found.up == up
    (warning,) = found_in(Rig(), TAKES[take](RATE)).warnings
    assert warning.startswith(f"up is taken to be y, but the body mostly stands along {PASSING[take]}")
    assert warning.endswith("'up' in a spec, --up elsewhere, says which it is")


def test_a_fall_in_less_than_half_of_the_frames_needs_no_word():
    motion = with_rotation(standing(skeleton_of(), frames=21), "Hips", slice(0, 10), [np.radians(150.0), 0.0, 0.0])
    assert up_of(motion) == ("y", None)


def test_a_floor_outweighs_offsets_that_stand_along_another_axis():
    assert up_of(turned(motion_of(Rig(), walks(RATE)), TO_Z_UP)) == ("z", None)


def test_a_body_that_stands_still_along_z_over_offsets_along_y_is_unsure():
    axis, warning = up_of(turned(standing(skeleton_of()), TO_Z_UP))
    assert axis == "y"
    assert "the body mostly stands along z" in warning


@pytest.mark.parametrize("take", ["walks", "stands", "sits", "jumps"])
@pytest.mark.parametrize("axes", ["along x", "along y", "along mirrored x", "rolled"])
def test_offsets_that_fold_bones_along_their_own_axes_have_no_say(take, axes):
    for up in "yz":
        found = found_in(Rig(up=up, axes=axes), TAKES[take](RATE))
        assert (found.up, found.warnings) == (up, ())


def leaning(*, offsets, body, frames=20):
    """Return a body whose OFFSETs lean from y to z by some degrees, and which itself leans by others."""
    turn = rot.to_matrix(rot.exp(np.radians([offsets, 0.0, 0.0])))
    return with_rotation(
        standing(skeleton_of(turn=turn), frames), "Hips", slice(None), np.radians([body - offsets, 0.0, 0.0])
    )


@pytest.mark.parametrize(("body", "up"), [(0.0, "y"), (30.0, "y"), (55.0, "z"), (90.0, "z")])
@pytest.mark.parametrize("offsets", [30.0, 45.0, 60.0])
def test_offsets_that_stand_along_no_axis_have_no_say(offsets, body, up):
    assert up_of(leaning(offsets=offsets, body=body))[0] == up


def test_a_floor_has_a_say_where_it_could_outweigh_a_body_that_leans_as_its_offsets_do(monkeypatch):
    none_along_y = {name: float(name == "y") for name in ("x", "y", "z", "-x", "-y", "-z")}
    monkeypatch.setattr("motionedit.core.body.up._floors", lambda *_, **__: none_along_y)
    axis, warning = up_of(leaning(offsets=25.0, body=25.0))
    assert (axis, warning is None) == ("y", False)
    assert up_of(leaning(offsets=15.0, body=25.0)) == ("y", None)


@pytest.mark.parametrize("body", [0.0, 30.0, 55.0])
def test_offsets_that_stand_nearly_along_an_axis_have_a_say(body):
    assert up_of(leaning(offsets=20.0, body=body))[0] == "y"
    assert up_of(leaning(offsets=70.0, body=90.0 - body))[0] == "z"


def test_a_body_that_leans_far_from_its_offsets_is_unsure():
    axis, warning = up_of(leaning(offsets=0.0, body=60.0))
    assert axis == "y"
    assert "the body mostly stands along z" in warning


def test_where_nothing_tells_y_from_z_it_is_y_and_that_is_said():
    axis, warning = up_of(leaning(offsets=45.0, body=45.0))
    assert axis == "y"
    assert warning.startswith("up is taken to be y, but ")


def test_a_way_that_is_nearly_as_likely_is_named():
    axis, warning = up_of(leaning(offsets=45.0, body=41.0))
    assert axis == "y"
    assert "but z is nearly as likely; 'up' in a spec" in warning


def test_the_frames_of_a_rest_pose_have_no_say():
    motion = with_rotation(
        leaning(offsets=45.0, body=90.0, frames=5), "Hips", slice(0, 3), np.radians([-45.0, 0.0, 0.0])
    )
    assert up_of(motion, first=0)[0] == "y"
    assert up_of(motion, first=3)[0] == "z"


@given(st.floats(0.0, 60.0), st.floats(-180.0, 180.0))
@settings(max_examples=50)
def test_a_lean_is_no_other_axis(lean, heading):
    turn = rot.multiply(rot.exp(np.radians([0.0, heading, 0.0])), rot.exp(np.radians([lean, 0.0, 0.0])))
    assert up_of(with_rotation(standing(skeleton_of()), "Hips", slice(None), rot.log(turn)))[0] == "y"


@given(st.floats(-180.0, 180.0), st.sampled_from(list(TAKES)), st.sampled_from("yz"))
@settings(max_examples=50)
def test_where_a_body_faces_does_not_matter(facing, take, up):
    assert found_in(Rig(up=up, facing=facing), TAKES[take](RATE)).up == up


def climbs(rate, seconds=4.0):
    """Up a ladder of 3 m, without a walk."""
    t = clock(seconds, rate)
    hips = np.stack((np.zeros(len(t)), HIPS_HEIGHT + 3.0 * smooth(t, 0.5, 3.5), np.zeros(len(t))), axis=1)
    return Take(waving(t), hips, rate)


def rolls_over(rate, seconds=3.0):
    """Somersaults forward, from stand to stand."""
    t = clock(seconds, rate)
    turn = 2.0 * np.pi * smooth(t, 0.5, 2.5)
    hips = np.stack((np.zeros(len(t)), 0.4 + 0.58 * np.abs(np.cos(0.5 * turn)), 0.4 * turn), axis=1)
    return Take({"Hips": about(0, turn, t)}, hips, rate)


@pytest.mark.parametrize("take", [climbs, rolls_over])
def test_who_leaves_the_floor_is_still_upright(take):
    for up in "yz":
        assert found_in(Rig(up=up), take(RATE)).up == up


def trots(turn, *, frames=120):
    """Return a dog that trots forward, in a file whose axes are the rows of `turn`."""
    skeleton = skeleton_of(mirrored(DOG), {"Head": (0.0, -0.02, 0.18)}, turn=turn)
    t = np.arange(frames) / RATE
    motion = standing(skeleton, frames, frame_time=1.0 / RATE)
    translations = np.stack((np.zeros(frames), 0.52 + wave(t, 0.01, 3.0), 1.2 * t), axis=1)[:, None] @ turn.T
    rotations = motion.rotations.copy()
    for joint, phase in (("LeftThigh", 0.0), ("RightThigh", 0.5), ("LeftArm", 0.5), ("RightArm", 0.0)):
        swing = rot.exp(wave(t, 0.4, 1.5, phase)[:, None] * turn[:, 0])
        rotations[:, skeleton.names.index(joint)] = swing
    return Motion(skeleton, rotations, translations, 1.0 / RATE)


@pytest.mark.parametrize("name", ["y", "z"])
def test_a_dog_stands_on_four_legs(name):
    motion = trots(FILES[name])
    anatomy = find_anatomy(motion.skeleton)
    names = motion.skeleton.names
    assert [names[leg.ankle] for leg in anatomy.legs] == ["LeftFoot", "RightFoot"]
    assert [names[arm.wrist] for arm in anatomy.arms] == ["LeftWrist", "RightWrist"]
    assert names[anatomy.head] == "Head"
    assert up_of(motion)[0] == name


@pytest.mark.parametrize("facing", [0.0, 180.0])
def test_a_root_that_stays_behind_and_what_stands_beside_the_body_are_asked_for_no_floor(facing):
    rig = Rig(carrier="root", controls=True, facing=facing)
    assert up_of(turned(motion_of(rig, walks(RATE)), TO_Z_UP)) == ("z", None)


def test_what_hangs_on_a_body_is_asked_for_no_floor():
    take = TAKES["lies"](RATE)
    spin = 2.0 * np.pi * 0.7 * clock(2.0, RATE)
    turns = {
        "LeftSword1": about(0, spin, spin),
        "RightSword1": about(0, spin + 2.0, spin),
        "Tail1": about(0, -spin, spin),
    }
    take = replace(take, turns=take.turns | turns)
    assert [found_in(Rig(up=up, extras=("swords", "tail")), take).up for up in "yz"] == ["y", "z"]


def test_a_long_clip_is_looked_at_in_parts():
    motion = standing(skeleton_of(), frames=3000)
    lying = with_rotation(motion, "Hips", slice(0, 1400), [np.radians(90.0), 0.0, 0.0])
    assert up_of(lying) == ("y", None)


def test_arms_and_a_head_alone_say_what_is_up():
    upper = [row for row in BONES if not any(part in row[0] for part in ("Leg", "Foot", "Toe", "HipJoint"))]
    turn = FILES["z"]
    motion = standing(skeleton_of(upper, turn=turn), at=turn @ np.array([0.0, 1.0, 0.0]))
    assert up_of(motion)[0] == "z"


def test_up_of_a_thing_without_a_body_is_y():
    skeleton = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 0, 1]]), (ROOT_CHANNELS, ()))
    assert up_of(standing(skeleton)) == ("y", None)


def test_a_skeleton_of_no_size_has_y_up():
    motion = standing(skeleton_of([(name, parent, (0.0, 0.0, 0.0)) for name, parent, _ in BONES], {}))
    assert up_of(motion)[0] == "y"
