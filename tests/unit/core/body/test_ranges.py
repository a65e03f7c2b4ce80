"""Joints beyond their range in the input, knees and elbows that are bent back: turns of known angles."""

import numpy as np
import pytest
from human import BONES, above, skeleton_of, split, standing, with_rotation

from motionedit.core.body.bends import find_bends
from motionedit.core.body.bent_back import bent_back
from motionedit.core.body.bones import travel_joint
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ranges import beyond_range, regions_of
from motionedit.core.kinematics import forward


def turned(motion, joint, degrees, frames=slice(10, 12), axis=0):
    vector = np.zeros(3)
    vector[axis] = np.radians(degrees)
    return with_rotation(motion, joint, frames, vector)


def swinging(joint, degrees, bones=BONES):
    """Return a body whose joint swings to both sides by so many degrees."""
    motion = standing(skeleton_of(bones))
    for frame, share in enumerate(np.sin(np.linspace(0.0, 2.0 * np.pi, 20))):
        motion = turned(motion, joint, degrees * share, [frame])
    return motion


def found(before, after, *, touched=None, first=0):
    skeleton = before.skeleton
    regions = regions_of(skeleton, find_anatomy(skeleton), travel=travel_joint(before))
    touched = np.ones(len(skeleton), dtype=bool) if touched is None else touched
    lines = beyond_range(before, after, regions, first=first, touched=touched)
    names = skeleton.names
    return {(names[one.joint], names[one.against]): one for one in lines}


@pytest.mark.parametrize(
    ("joint", "parent", "most"),
    [
        ("LeftFoot", "LeftLeg", 45),
        ("RightHand", "RightForeArm", 45),
        ("LeftShoulder", "Spine1", 45),
        ("Head", "Neck", 60),
        ("Spine", "Hips", 60),
        ("RightArm", "RightShoulder", 150),
        ("LeftUpLeg", "LHipJoint", 150),
    ],
)
def test_a_joint_is_seen_beyond_its_own_range_by_more_than_what_its_kind_may(joint, parent, most):
    own = 12.0
    before = swinging(joint, own)
    # The largest angle of 20 samples of the sine.
    own = 12.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 20)).max()
    assert (joint, parent) not in found(before, turned(before, joint, own + most - 0.1))
    one = found(before, turned(before, joint, own + most + 0.1))[joint, parent]
    assert (one.frame, one.most) == (10, most)
    assert one.degrees == pytest.approx(most + 0.1)


def test_neck_and_spine_are_seen_as_one_where_each_joint_takes_a_part():
    before = standing(skeleton_of())
    after = turned(turned(before, "Neck", 35.0), "Head", 35.0)
    (one,) = found(before, after).values()
    assert found(before, after).keys() == {("Head", "Spine1")}
    assert one.degrees == pytest.approx(70.0)


def test_a_range_is_against_the_mean_of_the_input_whatever_its_zero_is():
    # Half the frames turned by 40 degrees: the mean is 20 degrees away from both.
    before = turned(standing(skeleton_of()), "LeftFoot", 40.0, slice(0, 10))
    after = turned(before, "LeftFoot", 92.0, [15])
    assert found(before, after)["LeftFoot", "LeftLeg"].degrees == pytest.approx(92.0 - 20.0 - 20.0)


def test_knees_elbows_the_carrier_of_travel_and_what_is_not_touched_have_no_range():
    before = standing(skeleton_of(above(BONES, "Root")))
    for joint in ("LeftLeg", "RightForeArm", "Root"):
        assert not found(before, turned(before, joint, 140.0))
    after, touched = turned(before, "Head", 140.0), np.zeros(len(before.skeleton), dtype=bool)
    assert not found(before, after, touched=touched)
    touched[before.skeleton.names.index("Head")] = True
    assert found(before, after, touched=touched)


def test_a_rest_pose_is_neither_range_nor_seen():
    before = turned(standing(skeleton_of()), "Head", 90.0, [0])
    assert not found(before, turned(before, "Head", 140.0, [0]), first=1)
    assert found(before, turned(before, "Head", 80.0), first=1)
    assert not found(before, turned(before, "Head", 80.0), first=0)


def back(before, after):
    anatomy = find_anatomy(before.skeleton)
    bends = find_bends(before.skeleton, forward(before), anatomy, first=0)
    touched = np.ones(len(before.skeleton), dtype=bool)
    lines = bent_back(before, after, anatomy, bends, first=0, touched=touched)
    return {before.skeleton.names[one.joint]: one for one in lines}


WITH_TWISTS = split(split(BONES, "LeftLeg", "LeftThighTwist", 0.5), "RightLeg", "RightThighTwist", 0.5)


@pytest.mark.parametrize("bones", [BONES, WITH_TWISTS])
def test_a_knee_that_is_bent_back_is_seen_from_five_degrees_on(bones):
    # A knee bends by turns about +x: the shank goes to the back.
    before = turned(standing(skeleton_of(bones)), "LeftLeg", 30.0, slice(0, 5))
    assert not back(before, turned(before, "LeftLeg", -4.9))
    one = back(before, turned(before, "LeftLeg", -8.0))["LeftLeg"]
    assert (one.frame, one.against) == (10, None)
    assert one.degrees == pytest.approx(8.0)
    assert not back(before, turned(before, "LeftLeg", 140.0))


def test_a_knee_that_the_input_bends_back_is_seen_beyond_that():
    before = turned(turned(standing(skeleton_of()), "LeftLeg", 60.0, slice(0, 9)), "LeftLeg", -10.0, [15])
    assert not back(before, turned(before, "LeftLeg", -14.0))
    assert back(before, turned(before, "LeftLeg", -20.0))["LeftLeg"].degrees == pytest.approx(10.0)


@pytest.mark.compiled
@pytest.mark.parametrize("bones", [BONES, WITH_TWISTS])
def test_limbs_that_are_let_off_at_once_are_not_bent_back(bones, monkeypatch):
    before = turned(standing(skeleton_of(bones)), "LeftLeg", 30.0, slice(0, 5))
    afters = [
        turned(turned(before, "LeftLeg", knee, [place]), "RightForeArm", elbow, [19])
        for knee, elbow, place in ((-8.0, 20.0, 0), (40.0, -60.0, 3), (-6.0, -70.0, 19), (0.0, 9.0, 12))
    ]
    seen = [back(before, after) for after in afters]
    assert any(seen)
    assert not all(seen)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    for found, after in zip(seen, afters, strict=True):
        other = back(before, after)
        assert found.keys() == other.keys()
        for name, one in found.items():
            assert one.degrees == pytest.approx(other[name].degrees, rel=1e-12)


def test_an_elbow_that_the_input_keeps_straight_is_bent_back_where_bodies_do_not_bend():
    # Arms hang: the hand comes to the front by turns about -x.
    before = standing(skeleton_of())
    assert not back(before, turned(before, "RightForeArm", -70.0))
    assert back(before, turned(before, "RightForeArm", 20.0))["RightForeArm"].degrees == pytest.approx(20.0)
