import numpy as np
import pytest
from human import skeleton_of, standing
from sklearn.decomposition import TruncatedSVD

from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.body.hinges import FULL_BEND, find_hinges, hinge_of
from motionedit.core.motion import Motion


def bent(joint, vectors, *, first=0):
    """Return a motion whose joint has the rotation vectors (F, 3), rad, and its hinges."""
    vectors = np.asarray(vectors, dtype=float)
    motion = standing(skeleton_of(), frames=len(vectors))
    rotations = motion.rotations.copy()
    rotations[:, motion.skeleton.names.index(joint)] = rot.exp(vectors)
    motion = Motion(motion.skeleton, rotations, motion.translations, 0.01)
    return motion, find_hinges(motion, find_anatomy(motion.skeleton), first=first)


AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
ANGLES = np.linspace(0.2, 1.5, 40)


@pytest.mark.parametrize("joint", ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"])
def test_a_knee_or_an_elbow_that_bends_about_one_axis_is_a_hinge(joint):
    motion, (hinge,) = bent(joint, ANGLES[:, None] * AXIS)
    assert motion.skeleton.names[hinge.joint] == joint
    np.testing.assert_allclose(hinge.axis, AXIS, atol=1e-12)
    assert hinge.off_axis == pytest.approx(0.0, abs=1e-12)
    assert hinge.limits == pytest.approx((0.0, FULL_BEND))


def test_the_axis_is_signed_so_that_the_mean_angle_is_positive():
    _, (hinge,) = bent("LeftLeg", -ANGLES[:, None] * AXIS)
    np.testing.assert_allclose(hinge.axis, -AXIS, atol=1e-12)


def test_limits_are_widened_to_what_the_input_does():
    _, (hinge,) = bent("LeftLeg", np.linspace(-0.3, 2.8, 40)[:, None] * AXIS)
    assert hinge.limits == pytest.approx((-0.3, 2.8))


def test_a_joint_that_bends_about_two_axes_is_no_hinge():
    wobble = np.sin(np.linspace(0.0, 20.0, 40))[:, None] * np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0)
    motion, hinges = bent("LeftLeg", ANGLES[:, None] * AXIS + 0.3 * wobble)
    assert hinges == []
    _, hinges = bent("LeftLeg", ANGLES[:, None] * AXIS + 0.03 * wobble)
    assert len(hinges) == 1
    assert hinge_of(motion, 1, first=0) is None  # a joint that does not bend


def test_off_axis_energy_is_what_an_uncentred_pca_leaves():
    rng = np.random.default_rng(3)
    v = ANGLES[:, None] * AXIS + 0.2 * rng.normal(size=(40, 3))
    motion, _ = bent("LeftLeg", v)
    hinge = hinge_of(motion, motion.skeleton.names.index("LeftLeg"), first=0)
    pca = TruncatedSVD(n_components=2, algorithm="arpack", random_state=0).fit(v)
    assert hinge.off_axis == pytest.approx(1.0 - pca.singular_values_[0] ** 2 / np.sum(v * v), abs=1e-9)
    assert abs(hinge.axis @ pca.components_[0]) == pytest.approx(1.0, abs=1e-9)


def test_a_rest_pose_in_front_is_left_out():
    v = ANGLES[:, None] * AXIS
    v[0] = [0.0, 2.0, 0.0]
    assert bent("LeftLeg", v)[1] == []
    assert len(bent("LeftLeg", v, first=1)[1]) == 1


def test_a_body_without_limbs_has_no_hinges():
    motion = standing(skeleton_of([("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]))
    assert find_hinges(motion, find_anatomy(motion.skeleton), first=0) == []
