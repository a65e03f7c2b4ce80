"""Cones of swing and twist about where a clip has its joints, never tighter than what it does."""

from types import SimpleNamespace

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation
from scipy.spatial.transform import Rotation

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.limits import NECK, SPINE, Range, given_limits, human_limits, swing_and_twist
from motionedit.core.kinematics import forward
from motionedit.dataclass import replace

SKELETON = skeleton_of()
INDEX = SKELETON.names.index


def limits_of(motion, first=0):
    anatomy = find_anatomy(motion.skeleton)
    found = human_limits(motion, forward(motion), anatomy, travel=0, first=first)
    return by_name(found, motion.skeleton)


def by_name(limits, skeleton):
    rows = zip(limits.joints.tolist(), limits.centers, limits.along, limits.swing, limits.twist, strict=True)
    return {
        skeleton.names[joint]: SimpleNamespace(center=center, along=along, swing=swing, twist=twist)
        for joint, center, along, swing, twist in rows
    }


@pytest.mark.parametrize("seed", range(5))
def test_a_swing_after_a_twist_is_taken_apart_again(seed):
    rng = np.random.default_rng(seed)
    along = rng.normal(size=3)
    along /= np.linalg.norm(along)
    square = np.cross(along, rng.normal(size=3))
    square /= np.linalg.norm(square)
    swing, twist = rng.uniform(0.1, 3.0), rng.uniform(-3.0, 3.0)
    q = (Rotation.from_rotvec(swing * square) * Rotation.from_rotvec(twist * along)).as_quat()[[3, 0, 1, 2]]
    found = swing_and_twist(q[None], along)
    np.testing.assert_allclose([found[0][0], found[1][0]], [swing, twist], atol=1e-9)


def test_necks_spines_and_limbs_have_limits_and_knees_and_elbows_have_none():
    found = limits_of(standing(SKELETON))
    assert {"Head", "LeftArm", "RightHand", "LeftUpLeg", "RightFoot"} <= set(found)
    assert not {"LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm", "Hips"} & set(found)


def test_a_limit_is_never_tighter_than_what_the_clip_does_and_a_rest_pose_does_not_count():
    plain = limits_of(standing(SKELETON))["Head"]
    nodding = with_rotation(standing(SKELETON), "Head", slice(4, 6), (2.5, 0.0, 0.0))
    wide = limits_of(nodding)["Head"]
    assert plain.swing < np.radians(NECK.swing) + 1e-12
    q = rot.multiply(rot.conjugate(wide.center), nodding.rotations[:, INDEX("Head")])
    assert wide.swing == pytest.approx(swing_and_twist(q, wide.along)[0].max(), abs=1e-12)
    assert wide.swing > plain.swing
    assert limits_of(nodding, first=6)["Head"].swing == plain.swing


SPINES = [name for name in SKELETON.names if name.startswith("Spine")]


@pytest.mark.parametrize("turn", [0.0, 0.9, 3.0])
def test_a_back_bends_forward_farther_than_back(turn):
    standing_so = with_rotation(standing(SKELETON), "Hips", slice(None), (0.0, turn, 0.0))
    found, share = limits_of(standing_so), 1.0 / np.sqrt(len(SPINES))
    assert SPINES
    for name in SPINES:
        limit = found[name]
        # The body faces along z, and its joints as the world where it does not turn: forward is about x.
        for end, beyond in ((share * SPINE.swing, 0.1), (-share * SPINE.back, -0.1)):
            bends = np.radians([[end - beyond], [end + beyond]]) * np.array([1.0, 0.0, 0.0])
            swings, _ = swing_and_twist(rot.between(limit.center, rot.exp(bends)), limit.along)
            assert swings[0] < limit.swing < swings[1]


def test_given_limits_are_of_the_joints_that_are_named():
    motion = standing(SKELETON)
    given = {INDEX("Head"): Range(20.0, 10.0), INDEX("LeftArm"): Range(90.0, 45.0)}
    found = given_limits(motion, forward(motion), given, first=0)
    assert found.joints.tolist() == sorted(given)
    limits = by_name(found, SKELETON)
    np.testing.assert_allclose(limits["Head"].swing, np.radians(20.0))
    np.testing.assert_allclose(limits["LeftArm"].twist, np.radians(45.0))


def heaped():
    """Return the skeleton with all children of the hips where the hips are."""
    offsets = SKELETON.offsets.copy()
    offsets[SKELETON.parents == INDEX("Hips")] = 0.0
    return replace(SKELETON, offsets=offsets)


def spread():
    """Return hips between two joints, as far on one side as on the other."""
    sides = [("Left", "Hips", [10.0, 0.0, 0.0]), ("Right", "Hips", [-10.0, 0.0, 0.0])]
    return skeleton_of([("Hips", None, [0.0, 0.0, 0.0]), *sides])


@pytest.mark.parametrize("skeleton", [heaped(), spread()], ids=["heaped", "spread"])
def test_a_joint_has_a_bone_where_its_children_are_heaped_or_opposite(skeleton):
    motion = standing(skeleton)
    found = given_limits(motion, forward(motion), {0: Range(5.0, 5.0)}, first=0)
    np.testing.assert_allclose(np.linalg.norm(found.along, axis=1), 1.0)
    swing, _ = swing_and_twist(rot.exp(np.array([0.5, 0.5, 0.5])), found.along[0])
    assert swing > 0.1


def test_no_given_limits_are_none():
    motion = standing(SKELETON)
    assert len(given_limits(motion, forward(motion), {}, first=0)) == 0


def test_the_middle_of_a_limit_is_the_mean_of_the_clip():
    motion = with_rotation(standing(SKELETON), "Head", slice(None), (0.0, 0.7, 0.0))
    limits = given_limits(motion, forward(motion), {INDEX("Head"): Range(10.0, 10.0)}, first=0)
    assert rot.angle_between(limits.centers[0], rot.exp(np.array([0.0, 0.7, 0.0]))) < 1e-6
