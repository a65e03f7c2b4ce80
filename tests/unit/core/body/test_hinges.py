"""Knees and elbows as hinges: about which axis they turn, how far, and what an edit may do with them."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation
from hypothesis import given
from hypothesis import strategies as st
from sklearn.decomposition import TruncatedSVD

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends, turns_about
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.hinges import FULL_BEND, channel_hinges, find_hinges, hinge_of, plain_hinge, with_limits_of
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion

SKELETON = skeleton_of()
LIMBS = ("LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm")
# Square to the limbs, which hang along y.
AXIS = np.array([0.8, 0.0, -0.6])
ANGLES = np.linspace(0.2, 1.5, 40)
LEAST = np.radians(3.0)


def bent(joint, vectors):
    """Return a motion whose joint has the rotation vectors (F, 3), rad."""
    vectors = np.asarray(vectors, dtype=float)
    motion = standing(SKELETON, frames=len(vectors))
    rotations = motion.rotations.copy()
    rotations[:, SKELETON.names.index(joint)] = rot.exp(vectors)
    return Motion(SKELETON, rotations, motion.translations, 0.01)


def hinges_of(motion, *, first=0):
    """Return the hinges of knees and elbows by their names."""
    anatomy = find_anatomy(motion.skeleton)
    bends = find_bends(motion.skeleton, forward(motion), anatomy, first=first)
    return {motion.skeleton.names[hinge.joint]: hinge for hinge in find_hinges(bends)}


def angle_of(hinge, rotations):
    """Return a hinge's angle in local rotations (F, 4)."""
    lower = np.tile(hinge.lower, (len(rotations), 1))
    return turns_about(hinge.axis, hinge.upper, rot.rotate(rotations, lower))


def test_every_knee_and_every_elbow_is_a_hinge_however_it_turns_in_the_input():
    rng = np.random.default_rng(2)
    assert tuple(hinges_of(standing(SKELETON))) == LIMBS
    assert tuple(hinges_of(bent("LeftLeg", 0.5 * rng.normal(size=(40, 3))))) == LIMBS


@pytest.mark.parametrize("joint", LIMBS)
def test_a_limb_that_bends_about_one_axis_is_a_hinge_about_it(joint):
    motion = bent(joint, ANGLES[:, None] * AXIS)
    hinge = hinges_of(motion)[joint]
    np.testing.assert_allclose(hinge.axis, AXIS, atol=1e-6)
    np.testing.assert_allclose(angle_of(hinge, motion.rotations[:, hinge.joint]), ANGLES, atol=1e-6)
    assert hinge.limits == pytest.approx((LEAST, FULL_BEND))
    assert not hinge.is_second


def test_a_limb_that_bends_to_the_other_side_has_the_other_axis():
    np.testing.assert_allclose(hinges_of(bent("LeftLeg", -ANGLES[:, None] * AXIS))["LeftLeg"].axis, -AXIS, atol=1e-6)


@pytest.mark.parametrize(("least", "most"), [(0.02, 1.0), (0.2, 2.7), (-0.3, 2.8), (0.01, 2.9)])
def test_limits_are_three_and_150_degrees_or_what_the_input_does_beyond(least, most):
    hinge = hinges_of(bent("LeftLeg", np.linspace(least, most, 40)[:, None] * AXIS))["LeftLeg"]
    assert hinge.limits == pytest.approx((min(least, LEAST), max(most, np.radians(150.0))), abs=1e-6)


def test_a_rest_pose_in_front_is_left_out():
    v = ANGLES[:, None] * AXIS
    v[0] = -1.5 * AXIS
    assert hinges_of(bent("LeftLeg", v))["LeftLeg"].limits[0] == pytest.approx(-1.5, abs=1e-6)
    assert hinges_of(bent("LeftLeg", v), first=1)["LeftLeg"].limits[0] == pytest.approx(LEAST)


@given(st.integers(0, 2**32 - 1))
def test_a_noisy_input_keeps_the_axis_and_its_angles_are_within_the_limits(seed):
    noise = 0.05 * np.random.default_rng(seed).normal(size=(40, 3))
    motion = bent("RightForeArm", ANGLES[:, None] * AXIS + noise)
    hinge = hinges_of(motion)["RightForeArm"]
    assert hinge.axis @ AXIS > np.cos(0.1)
    assert np.linalg.norm(hinge.axis) == pytest.approx(1.0)
    angles = angle_of(hinge, motion.rotations[:, hinge.joint])
    assert angles.min() >= hinge.limits[0] - 1e-12
    assert angles.max() <= hinge.limits[1] + 1e-12


@given(st.floats(-3.1, 3.1), st.floats(-1.0, 1.0), st.integers(0, 2**32 - 1))
def test_a_turn_about_the_axis_adds_to_the_angle_and_what_is_along_it_does_not_count(turn, along, seed):
    rng = np.random.default_rng(seed)
    axis, start = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
    square = start - (start @ axis) * axis
    stop = rot.rotate(rot.exp(turn * axis), square / np.linalg.norm(square))
    assert turns_about(axis, start, stop + along * axis) == pytest.approx(turn, abs=1e-9)


@given(st.floats(-3.1, 3.1), st.integers(0, 2**32 - 1))
def test_a_plain_hinge_has_the_angle_of_its_rotation(turn, seed):
    axis = np.random.default_rng(seed).normal(size=3)
    axis /= np.linalg.norm(axis)
    hinge = plain_hinge(0, axis, (-1.0, 2.0))
    assert (hinge.limits, hinge.off_axis) == ((-1.0, 2.0), 0.0)
    assert angle_of(hinge, rot.exp(turn * axis)[None])[0] == pytest.approx(turn, abs=1e-9)


def test_the_hinge_that_fits_a_joint_is_signed_so_that_its_mean_angle_is_positive():
    knee = SKELETON.names.index("LeftLeg")
    oblique = np.array([2.0, -1.0, 2.0]) / 3.0
    for sign in (1.0, -1.0):
        hinge = hinge_of(bent("LeftLeg", sign * ANGLES[:, None] * oblique), knee, first=0)
        np.testing.assert_allclose(hinge.axis, sign * oblique, atol=1e-12)
        assert hinge.off_axis == pytest.approx(0.0, abs=1e-12)
        assert hinge.limits == pytest.approx((0.0, FULL_BEND))
    assert hinge_of(standing(SKELETON, 40), knee, first=0) is None  # a joint that does not bend


def test_off_axis_energy_is_what_an_uncentred_pca_leaves():
    v = ANGLES[:, None] * AXIS + 0.2 * np.random.default_rng(3).normal(size=(40, 3))
    hinge = hinge_of(bent("LeftLeg", v), SKELETON.names.index("LeftLeg"), first=0)
    pca = TruncatedSVD(n_components=2, algorithm="arpack", random_state=0).fit(v)
    assert hinge.off_axis == pytest.approx(1.0 - pca.singular_values_[0] ** 2 / np.sum(v * v), abs=1e-9)
    assert abs(hinge.axis @ pca.components_[0]) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("axes", ["X", "XY", "ZX", "YZ"])
def test_the_hinges_of_few_channels_have_the_angles_of_the_channels(axes):
    channels = [own if name != "LeftLeg" else [f"{a}rotation" for a in axes] for name, own in named_channels()]
    skeleton = type(SKELETON)(SKELETON.names, SKELETON.parents, SKELETON.offsets, tuple(map(tuple, channels)))
    (hinges,) = channel_hinges(skeleton).values()
    angles = np.random.default_rng(5).uniform(-1.4, 1.4, size=(20, len(axes)))
    rotations = rot.from_euler(angles, tuple("XYZ".index(a) for a in axes))
    for hinge, expected in zip(hinges, angles.T, strict=True):
        side = np.tile(hinge.upper, (20, 1))
        # The second one's axis is in the joint's frame, where what the parent has is seen turned.
        upper = rot.rotate(rot.conjugate(rotations), side) if hinge.is_second else side
        lower = np.tile(hinge.lower, (20, 1)) if hinge.is_second else rot.rotate(rotations, hinge.lower)
        np.testing.assert_allclose(turns_about(hinge.axis, upper, lower), expected, atol=1e-12)


def named_channels():
    return zip(SKELETON.names, SKELETON.channels, strict=True)


def test_a_channel_that_turns_the_other_way_round_has_the_limits_turned_round():
    knee = SKELETON.names.index("LeftLeg")
    found = plain_hinge(knee, np.array([-1.0, 0.0, 0.0]), (0.1, 2.0))
    along = plain_hinge(knee, np.array([1.0, 0.0, 0.0]), (-9.0, 9.0))
    other = plain_hinge(knee, np.array([0.0, 1.0, 0.0]), (-9.0, 9.0))
    first, second = with_limits_of((along, other), found)
    assert (first.limits, second.limits) == ((-2.0, -0.1), (-9.0, 9.0))
    np.testing.assert_array_equal(first.axis, along.axis)


def test_a_body_without_limbs_has_no_hinges():
    assert hinges_of(standing(skeleton_of([("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]))) == {}


def test_a_straight_limb_has_the_hinge_of_its_body_and_keeps_to_where_it_stands():
    motion = with_rotation(standing(SKELETON), "Hips", slice(None), (0.0, 0.7, 0.0))
    for name, hinge in hinges_of(motion).items():
        assert hinge.limits == pytest.approx((0.0, FULL_BEND), abs=1e-9), name
        assert abs(hinge.axis @ hinge.lower) < 0.02, name
