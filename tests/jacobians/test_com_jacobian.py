"""The Jacobian of the center of mass, as its task has it, agrees with central differences."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, skeleton_of, split
from increments import turned

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds.com import CenterOfMassTask
from motionedit.core.priorities.solver.points import Columns, Recruited

STEP = 1e-6
HUMAN = skeleton_of()
SPLIT = skeleton_of(split(split(BONES, "LeftLeg", "LeftTwist", 0.4), "Spine1", "Middle", 0.3))
CHAIN = skeleton_of(BONES[:5], {})


def moving(skeleton):
    rng = np.random.default_rng(7)
    rotations = rot.exp(rng.normal(scale=0.6, size=(3, len(skeleton), 3)))
    return Motion(skeleton, rotations, rng.normal(size=(3, 1, 3)), 0.01)


def jacobian(motion, masses, joints):
    """Return d(CoM)/d(unknowns), shape (F, 3, 3 K + 3): increments of joints, then the root's translation."""
    columns, everything = Columns(motion.skeleton, joints, 0), Recruited(np.ones(len(joints), dtype=bool), root=True)
    task = CenterOfMassTask(columns, everything, masses, np.zeros((len(motion), 3)))
    return task.evaluate(forward(motion), motion.rotations, np.arange(len(motion)))[1]


@pytest.mark.parametrize("given", [None, {4: 3.0, 1: 1.0}], ids=["table", "given"])
@pytest.mark.parametrize("skeleton", [HUMAN, SPLIT, CHAIN], ids=["human", "split", "chain"])
def test_every_joint_moves_the_center_of_mass_as_its_columns_say(skeleton, given):
    motion = moving(skeleton)
    masses = find_masses(skeleton, find_anatomy(skeleton), given=given)
    joints = np.arange(len(skeleton))[::-1]
    J = jacobian(motion, masses, joints)
    assert J.shape == (3, 3, 3 * len(joints) + 3)
    for k, joint in enumerate(joints):
        for a in range(3):
            w = STEP * np.eye(3)[a]
            plus, minus = (center_of_mass(forward(turned(motion, joint, u)), masses) for u in (w, -w))
            np.testing.assert_allclose((plus - minus) / (2 * STEP), J[:, :, 3 * k + a], atol=1e-8)


def test_the_roots_translation_moves_the_center_of_mass_as_a_whole():
    motion = moving(HUMAN)
    masses = find_masses(HUMAN, find_anatomy(HUMAN))
    shifted = replace(motion, translations=motion.translations + np.array([1.0, 2.0, 3.0]))
    difference = center_of_mass(forward(shifted), masses) - center_of_mass(forward(motion), masses)
    np.testing.assert_allclose(difference, np.broadcast_to([1.0, 2.0, 3.0], (3, 3)), atol=1e-12)
    J = jacobian(motion, masses, np.arange(len(HUMAN)))
    np.testing.assert_array_equal(J[:, :, -3:], np.broadcast_to(np.eye(3), (3, 3, 3)))
