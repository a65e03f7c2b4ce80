"""What metrics need of a motion is the same from blocks of any size as from the whole."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import blocks
from motionedit.core import rotations as rot
from motionedit.core.blocks import blocks_of, frame_blocks
from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.quality import jerk_rms
from motionedit.core.body.trace import trace_of
from motionedit.core.kinematics import forward

HAND = skeleton_of().names.index("LeftHand")
JOINTS, OFFSETS = np.array([HAND, 1]), np.array([[0.1, -0.3, 0.2], [0.0, 0.0, 0.0]])


def tracks_of(poses):
    return poses.positions[:, JOINTS] + rot.rotate(poses.rotations[:, JOINTS], OFFSETS)


@pytest.fixture
def moving():
    motion = standing(skeleton_of(), frames=23)
    for frame in range(0, 23, 3):
        motion = with_rotation(motion, "LeftArm", [frame], [0.1 * frame, 0.3, 0.0])
    return motion


@pytest.mark.parametrize("size", [1, 2, 5, 1000])
@pytest.mark.parametrize("first", [0, 3])
def test_a_trace_by_blocks_is_that_of_the_whole_motion(moving, monkeypatch, size, first):
    monkeypatch.setattr(blocks, "BLOCK_FRAMES", size)
    poses = forward(moving)
    masses = find_masses(moving.skeleton, find_anatomy(moving.skeleton))
    parts = (moving.at(block) for block in frame_blocks(len(moving)))
    for each in (blocks_of(poses), map(forward, parts)):
        found = trace_of(each, tracks_of, frame_time=moving.frame_time, first=first, masses=masses)
        np.testing.assert_allclose(found.tracks, tracks_of(poses), atol=1e-12)
        np.testing.assert_allclose(found.center, center_of_mass(poses, masses), atol=1e-12)
        assert found.jerk_rms == pytest.approx(jerk_rms(poses.positions, frame_time=moving.frame_time, first=first))
        assert found.jerk_rms > 0.0


def test_without_masses_there_is_no_path_of_their_center(moving):
    assert trace_of(blocks_of(forward(moving)), tracks_of, frame_time=0.01, first=0).center is None


def test_the_center_of_mass_does_not_depend_on_the_frames_that_are_taken_together(moving, monkeypatch):
    poses, masses = forward(moving), find_masses(moving.skeleton, find_anatomy(moving.skeleton))
    whole = center_of_mass(poses, masses)
    monkeypatch.setattr(blocks, "BLOCK_FRAMES", 4)
    np.testing.assert_allclose(center_of_mass(poses, masses), whole, atol=1e-12)
    weighed = masses.shares @ (poses.positions + rot.rotate(poses.rotations, masses.points))
    np.testing.assert_allclose(whole, weighed, atol=1e-12)
