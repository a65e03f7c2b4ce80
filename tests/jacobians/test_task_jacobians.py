"""Every task's Jacobian against central differences, in the increments the layered solver applies."""

import numpy as np
import pytest
from human import skeleton_of

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import Effector, WorldPoses, forward
from motionedit.core.measure import Level, Measure
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds.aim import AimTask
from motionedit.core.priorities.kinds.com import CenterOfMassTask
from motionedit.core.priorities.kinds.distance import DistanceTask
from motionedit.core.priorities.kinds.floor import FloorTask
from motionedit.core.priorities.kinds.orientation import OrientationTask
from motionedit.core.priorities.kinds.pose import PoseTask
from motionedit.core.priorities.kinds.position import PositionTask
from motionedit.core.priorities.kinds.posture import PostureTask
from motionedit.core.priorities.solver.points import Columns, Point, Recruited

STEP = 1e-6
FRAMES = 3
SKELETON = skeleton_of()
HAND, HEAD, SPINE, FOOT = (SKELETON.names.index(name) for name in ("RightHand", "Head", "Spine1", "LeftFoot"))
COLUMNS = Columns(SKELETON, np.arange(len(SKELETON)), 0)
EVERYTHING = Recruited(np.ones(len(SKELETON), dtype=bool), root=True)


def motion_of(rotations, translations):
    return Motion(SKELETON, rotations, translations, 0.01)


@pytest.fixture
def motion():
    rng = np.random.default_rng(0)
    rotations = rot.exp(rng.normal(scale=0.5, size=(FRAMES, len(SKELETON), 3)))
    return motion_of(rotations, rng.normal(size=(FRAMES, 1, 3)))


def moved(motion, unknown, amount):
    """Return the motion with one unknown changed: a world-axis increment of a joint, or the root's translation."""
    joint, axis = divmod(unknown, 3)
    if joint == len(SKELETON):
        return motion_of(motion.rotations, motion.translations + amount * np.eye(3)[axis])
    rotations = motion.rotations.copy()
    w = np.broadcast_to(amount * np.eye(3)[axis], (FRAMES, 3))
    parent = SKELETON.parents[joint]
    if parent >= 0:
        w = rot.rotate(rot.conjugate(forward(motion).rotations[:, parent]), w)
    rotations[:, joint] = rot.multiply(rot.exp(w), rotations[:, joint])
    return motion_of(rotations, motion.translations)


def evaluated(task, motion):
    return task.evaluate(forward(motion), motion.rotations, np.arange(FRAMES))


def check(task, motion, *, atol=1e-6):
    _, J = evaluated(task, motion)
    differences = [
        (evaluated(task, moved(motion, u, -STEP))[0] - evaluated(task, moved(motion, u, STEP))[0]) / (2 * STEP)
        for u in range(COLUMNS.size)
    ]
    np.testing.assert_allclose(J, np.stack(differences, axis=-1), atol=atol)


def point(joint, offset=(0.0, 0.0, 0.0)):
    return Point(COLUMNS, Effector(joint, np.array(offset)), EVERYTHING)


def targets(seed=1):
    return np.random.default_rng(seed).normal(size=(FRAMES, 3))


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.1, -0.2, 0.05)])
@pytest.mark.parametrize("base", [None, SPINE, FOOT])
def test_position(motion, offset, base):
    measure = rot.to_matrix(rot.exp(np.array([0.3, -0.4, 0.9])))
    seen = Measure(measure, (0, 2), base)
    check(PositionTask(point(HAND, offset), targets(), seen, None if base is None else point(base)), motion)


@pytest.mark.parametrize("base", [None, SPINE])
def test_orientation_where_it_is_met(motion, base):
    poses = forward(motion)
    q = poses.rotations[:, HAND]
    if base is not None:
        q = rot.multiply(rot.conjugate(poses.rotations[:, base]), q)
    check(OrientationTask(point(HAND), q, None if base is None else point(base)), motion)


def test_pose(motion):
    position = PositionTask(point(FOOT), targets())
    check(PoseTask(position, OrientationTask(point(FOOT), forward(motion).rotations[:, FOOT])), motion)


def test_center_of_mass(motion):
    masses = find_masses(SKELETON, find_anatomy(SKELETON))
    check(CenterOfMassTask(COLUMNS, EVERYTHING, masses, targets()), motion)


@pytest.mark.parametrize("at_a_joint", [False, True])
def test_aim_where_it_is_met(motion, at_a_joint):
    poses = forward(motion)
    axis = np.array([0.0, 0.6, 0.8])
    look = rot.rotate(poses.rotations[:, HEAD], axis)
    if at_a_joint:
        way = poses.positions[:, HAND] - poses.positions[:, HEAD]
        axis = rot.rotate(rot.conjugate(poses.rotations[:1, HEAD]), way[:1])[0]
        task = AimTask(point(HEAD), axis / np.linalg.norm(axis), np.zeros((FRAMES, 3)), point(HAND))
        one = slice(0, 1)
        _, J = task.evaluate(
            WorldPoses(poses.positions[one], poses.rotations[one]), motion.rotations[one], np.arange(1)
        )
        differences = []
        for u in range(COLUMNS.size):
            plus, minus = (evaluated(task, moved(motion, u, sign * STEP))[0][0] for sign in (1, -1))
            differences.append((minus - plus) / (2 * STEP))
        np.testing.assert_allclose(J[0], np.stack(differences, axis=-1), atol=1e-5)
    else:
        check(AimTask(point(HEAD), axis, poses.positions[:, HEAD] + 1.7 * look, None), motion, atol=1e-5)


def test_aim_at_a_point_that_goes_with_another_joint(motion):
    poses = forward(motion)
    axis = np.array([0.0, 0.6, 0.8])
    way = poses.positions[:, HEAD] + 1.7 * rot.rotate(poses.rotations[:, HEAD], axis) - poses.positions[:, HAND]
    seen = rot.rotate(rot.conjugate(poses.rotations[:, HAND]), way)
    check(AimTask(point(HEAD), axis, seen, point(HAND)), motion, atol=1e-5)


def test_posture_where_it_is_met(motion):
    places = np.array([HEAD, SPINE])
    check(PostureTask(COLUMNS, places, motion.rotations[:, places]), motion)


@pytest.mark.parametrize("bound", ["distance", "at_least", "at_most"])
@pytest.mark.parametrize(
    ("other", "offset"), [(FOOT, (0.0, 0.0, 0.0)), (SPINE, (0.1, 0.0, 0.3)), (HEAD, (0.0, 0.2, 0.0))]
)
def test_distance(motion, bound, other, offset):
    lengths = np.array([0.3, 0.8, 1.4])
    check(DistanceTask(point(HAND, (0.0, -0.1, 0.05)), point(other, offset), lengths, bound), motion)


def test_no_joint_above_both_ends_of_a_distance_has_a_part_in_it(motion):
    _, J = evaluated(DistanceTask(point(HAND), point(FOOT), np.ones(FRAMES)), motion)
    np.testing.assert_allclose(J[..., :3], 0.0, atol=1e-12)
    np.testing.assert_array_equal(J[..., -3:], 0.0)


def test_two_points_that_meet_have_a_row_that_parts_them(motion):
    other = Point(COLUMNS, Effector(HAND, np.zeros(3)), Recruited(np.zeros(len(SKELETON), dtype=bool), root=False))
    e, J = evaluated(DistanceTask(point(HAND), other, np.full(FRAMES, 0.2)), motion)
    np.testing.assert_array_equal(e, 0.2)
    np.testing.assert_allclose(J, point(HAND).position_rows(forward(motion))[:, :1], atol=1e-12)


def test_floor(motion):
    points = (point(FOOT), point(HAND, (0.1, -0.2, 0.05)), point(HEAD))
    check(FloorTask(points, Level(np.array([0.0, 0.6, 0.8]), 0.4), FRAMES), motion)


def test_joints_that_are_not_recruited_have_no_part(motion):
    recruited = Recruited(np.arange(len(SKELETON)) == HAND - 1, root=False)
    task = PositionTask(Point(COLUMNS, Effector(HAND, np.zeros(3)), recruited), targets())
    _, J = evaluated(task, motion)
    used = np.flatnonzero(np.abs(J).max(axis=(0, 1)))
    assert set(used // 3) == {HAND - 1}
