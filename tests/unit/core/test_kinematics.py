"""Forward kinematics agrees with closed forms and with one joint at a time in scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motionedit.core import kinematics, rotations
from motionedit.core.kinematics import Effector, effector_positions, forward, forward_of, shifted
from motionedit.core.motion import Motion
from motionedit.core.skeleton import Skeleton

TURNS = ("Zrotation", "Xrotation", "Yrotation")
PLACES = ("Xposition", "Yposition", "Zposition")


def random_motion(frames, *, seed=0):
    rng = np.random.default_rng(seed)
    parents = np.array([-1, 0, 1, 1, 0, 4, 5, 2])
    skeleton = Skeleton(
        names=tuple("abcdefgh"),
        parents=parents,
        offsets=rng.normal(size=(8, 3)),
        channels=(PLACES + TURNS, TURNS, TURNS, PLACES + TURNS, (), TURNS, TURNS, TURNS),
    )
    return Motion(
        skeleton,
        rotations.normalize(rng.normal(size=(frames, 8, 4))),
        rng.normal(size=(frames, 2, 3)),
        0.01,
    )


def one_by_one(motion, frame):
    """Return the world transforms of one frame, joint by joint, by scipy."""
    local = motion.skeleton.offsets.copy()
    local[motion.skeleton.translated] = motion.translations[frame]
    positions, turns = [], []
    for j, parent in enumerate(motion.skeleton.parents):
        turn = Rotation.from_quat(motion.rotations[frame, j], scalar_first=True)
        positions.append(local[j] if parent < 0 else positions[parent] + turns[parent].apply(local[j]))
        turns.append(turn if parent < 0 else turns[parent] * turn)
    return np.array(positions), turns


@pytest.mark.parametrize("frames", [1, 7])
def test_every_joint_is_where_scipy_puts_it(frames):
    motion = random_motion(frames)
    poses = forward(motion)
    for frame in range(frames):
        positions, turns = one_by_one(motion, frame)
        np.testing.assert_allclose(poses.positions[frame], positions, atol=1e-13)
        theirs = np.array([turn.as_quat(scalar_first=True) for turn in turns])
        assert rotations.angle_between(poses.rotations[frame], theirs).max() < 1e-13


def test_blocks_of_frames_make_no_difference(monkeypatch):
    motion = random_motion(101)
    whole = forward(motion)
    monkeypatch.setattr(kinematics, "_BLOCK_POSES", 8 * 10)
    np.testing.assert_allclose(forward(motion).positions, whole.positions, atol=1e-13)
    np.testing.assert_allclose(forward(motion).rotations, whole.rotations, atol=1e-13)


@pytest.mark.compiled
@pytest.mark.parametrize("frames", [1, 2, 3, 8])
def test_a_frame_is_the_same_to_the_bit_beside_any_others(frames):
    motion = random_motion(frames)
    whole = forward(motion)
    for f in range(frames):
        alone = forward(motion.at([f]))
        np.testing.assert_array_equal(alone.positions[0], whole.positions[f])
        np.testing.assert_array_equal(alone.rotations[0], whole.rotations[f])


def test_one_joint_alone_is_where_all_together_are():
    motion = random_motion(5)
    poses = forward(motion)
    for joint in range(8):
        positions, turns = forward_of(motion, joint)
        np.testing.assert_allclose(positions, poses.positions[:, joint], atol=1e-13)
        assert rotations.angle_between(turns, poses.rotations[:, joint]).max() < 1e-13


def test_a_planar_arm_reaches_its_closed_form():
    skeleton = Skeleton(
        ("a", "b", "c"), np.array([-1, 0, 1]), np.array([[0.0, 0, 0], [3, 0, 0], [2, 0, 0]]), (TURNS,) * 3
    )
    a, b = np.radians(30.0), np.radians(45.0)
    turns = rotations.about_axis(2, np.array([[a, b, 0.0]]))
    motion = Motion(skeleton, turns, np.empty((1, 0, 3)), 0.01)
    tip = effector_positions(forward(motion), Effector(2, np.array([1.0, 0.0, 0.0])))
    expected = 3 * np.array([np.cos(a), np.sin(a), 0]) + 3 * np.array([np.cos(a + b), np.sin(a + b), 0])
    np.testing.assert_allclose(tip[0], expected, atol=1e-15)


def test_an_empty_motion_has_empty_poses():
    motion = random_motion(0)
    assert forward(motion).positions.shape == (0, 8, 3)


def test_the_motion_is_not_changed():
    motion = random_motion(3)
    kept = motion.rotations.copy(), motion.translations.copy()
    forward(motion)
    np.testing.assert_array_equal(motion.rotations, kept[0])
    np.testing.assert_array_equal(motion.translations, kept[1])


@pytest.mark.parametrize("travel", [0, 3])
@pytest.mark.parametrize("known", [False, True])
def test_a_shifted_motion_is_that_far_from_where_it_was_with_all_that_hangs_on_the_travel(travel, known):
    motion, shift = random_motion(5), np.random.default_rng(1).normal(size=(5, 3))
    before = forward(motion)
    after = forward(shifted(motion, shift, travel, poses=before if known else None))
    carried = [travel in motion.skeleton.chain(joint) for joint in range(8)]
    moved = np.where(np.array(carried)[:, None], shift[:, None], 0.0)
    np.testing.assert_allclose(after.positions, before.positions + moved, atol=1e-13)
    np.testing.assert_allclose(after.rotations, before.rotations, atol=1e-13)
