"""Where a clip's hands hold one thing, on the clips of data/ and on hands that are moved about."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import read_clip
from motionedit.core.hands.grips import find_grips
from motionedit.core.kinematics import WorldPoses
from motionedit.dataclass import replace

DATA = Path(__file__).resolve().parents[4] / "data"


def body(name):
    motion = read_clip(DATA / name).motion
    return motion, anatomy_of(motion), kinematics.forward(motion)


def grips(name, *, first=0, frames=None, moved=None):
    motion, anatomy, poses = body(name)
    frames = frames or slice(None)
    positions = poses.positions.copy()
    if moved is not None:
        left = anatomy.arms[0].wrist
        positions[:, left] += moved
    poses = WorldPoses(positions[frames], poses.rotations[frames])
    return find_grips(poses, anatomy, frame_time=motion.frame_time, first=first)


def test_a_golfer_holds_the_club_all_along_and_a_walker_nothing():
    assert grips("golf/swing04.bvh") == ((0, 120),)
    assert grips("walk.bvh") == ()


def test_a_rest_pose_and_a_moment_are_no_grip():
    assert grips("golf/swing04.bvh", first=10) == ((10, 120),)
    assert grips("golf/swing04.bvh", frames=slice(0, 8)) == ()  # 0.28 s


def test_hands_that_part_have_two_grips():
    apart = np.zeros((121, 1))
    apart[50:61] = 60.0
    assert grips("golf/swing04.bvh", moved=apart * [1.0, 0.0, 0.0]) == ((0, 49), (61, 120))


@pytest.mark.parametrize(("speed", "held"), [(0.2, True), (1.0, False)])
def test_hands_that_pass_by_hold_nothing(speed, held):
    # To and fro by 4 cm, metres a second on average.
    seconds = np.arange(121) * 0.04
    sway = 4.0 * np.sin(seconds * (speed * 100.0 / 4.0))
    assert bool(grips("golf/swing04.bvh", moved=sway[:, None] * [0.0, 1.0, 0.0])) == held


@pytest.mark.parametrize("lacking", [{"arms": None}, {"leg_length": 0.0}])
def test_a_body_without_arms_or_without_size_holds_nothing(lacking):
    motion, anatomy, poses = body("golf/swing04.bvh")
    assert find_grips(poses, replace(anatomy, **lacking), frame_time=motion.frame_time, first=0) == ()


def test_a_body_of_any_size_and_turn_holds_the_same():
    motion, anatomy, poses = body("golf/swing04.bvh")
    turn = rot.normalize(np.array([0.3, 0.1, -0.5, 0.8]))
    turned = WorldPoses(rot.rotate(turn, poses.positions), rot.multiply(turn, poses.rotations))
    assert find_grips(turned, anatomy, frame_time=motion.frame_time, first=0) == ((0, 120),)
