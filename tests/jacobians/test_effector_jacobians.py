"""The Jacobians of an effector's position and orientation, as their tasks have them, agree with central differences."""

import numpy as np
import pytest
from increments import turned

from motionedit.core import rotations as rot
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds.orientation import OrientationTask
from motionedit.core.priorities.kinds.position import PositionTask
from motionedit.core.priorities.solver.points import Columns, Point, Recruited
from motionedit.core.skeleton import Skeleton
from motionedit.core.units import METRES_PER_RADIAN

STEP = 1e-6
SKELETON = Skeleton(
    names=("root", "hip", "knee", "ankle", "other"),
    parents=np.array([-1, 0, 1, 2, 0]),
    offsets=np.random.default_rng(1).normal(size=(5, 3)),
    channels=(("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"),)
    + (("Zrotation", "Xrotation", "Yrotation"),) * 4,
)


@pytest.fixture
def motion():
    rng = np.random.default_rng(2)
    return Motion(SKELETON, rot.normalize(rng.normal(size=(4, 5, 4))), rng.normal(size=(4, 1, 3)), 0.01)


def point(effector, joints):
    """Return the effector as world-axis increments of some joints move it, and nothing else."""
    return Point(Columns(SKELETON, joints, 0), effector, Recruited(np.ones(len(joints), dtype=bool), root=False))


def jacobian(task, motion):
    """Return a task's Jacobian by its joints, shape (F, 3, 3 K)."""
    J = task.evaluate(forward(motion), motion.rotations, np.arange(len(motion)))[1]
    assert not J[:, :, -3:].any()
    return J[:, :, :-3]


@pytest.mark.parametrize("effector", [Effector(3, np.zeros(3)), Effector(3, np.array([0.3, -1.0, 0.5]))])
def test_position_jacobian(motion, effector):
    joints = SKELETON.chain(3)
    task = PositionTask(point(effector, joints), np.zeros((4, 3)))
    J = jacobian(task, motion)
    assert J.shape == (4, 3, 12)
    for k, joint in enumerate(joints):
        for a in range(3):
            w = STEP * np.eye(3)[a]
            plus = effector_positions(forward(turned(motion, joint, w)), effector)
            minus = effector_positions(forward(turned(motion, joint, -w)), effector)
            np.testing.assert_allclose((plus - minus) / (2 * STEP), J[:, :, 3 * k + a], atol=1e-8)


def test_orientation_jacobian(motion):
    joints = SKELETON.chain(3)
    task = OrientationTask(point(Effector(3, np.zeros(3)), joints), forward(motion).rotations[:, 3])
    J = jacobian(task, motion) / METRES_PER_RADIAN
    assert J.shape == (4, 3, 12)
    for k, joint in enumerate(joints):
        for a in range(3):
            w = STEP * np.eye(3)[a]
            plus = forward(turned(motion, joint, w)).rotations[:, 3]
            minus = forward(turned(motion, joint, -w)).rotations[:, 3]
            change = rot.log(rot.multiply(plus, rot.conjugate(minus))) / (2 * STEP)
            np.testing.assert_allclose(change, J[:, :, 3 * k + a], atol=1e-8)
