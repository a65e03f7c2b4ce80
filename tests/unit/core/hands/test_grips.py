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


def test_a_rest_pose_is_no_grip():
    assert grips("golf/swing04.bvh", first=10) == ((10, 120),)
    assert grips("golf/swing04.bvh", first=120) == ()


@pytest.mark.parametrize(("frames", "found"), [(8, ()), (9, ((0, 8),)), (1, ())])
def test_hands_are_together_for_three_tenths_of_a_second_at_least(frames, found):
    assert grips("golf/swing04.bvh", frames=slice(0, frames)) == found
    apart = np.full((121, 1), 60.0)
    apart[100 : 100 + frames] = 0.0
    later = tuple((first + 100, last + 100) for first, last in found)
    assert grips("golf/swing04.bvh", moved=apart * [1.0, 0.0, 0.0]) == later


def test_hands_that_part_have_two_grips():
    apart = np.zeros((121, 1))
    apart[50:61] = 60.0
    assert grips("golf/swing04.bvh", moved=apart * [1.0, 0.0, 0.0]) == ((0, 49), (61, 120))


@pytest.mark.parametrize(("metres", "held"), [(0.24, True), (0.26, False)])
@pytest.mark.parametrize("size", [0.01, 1.0, 39.4])
def test_wrists_are_within_a_quarter_of_a_metre_at_a_leg_of_85_cm(metres, held, size):
    motion, anatomy, poses = body("golf/swing04.bvh")
    left, right = (arm.wrist for arm in anatomy.arms)
    positions = poses.positions.copy()
    positions[:, left] = positions[:, right] + np.array([0.0, metres / 0.85 * anatomy.leg_length, 0.0])
    still = np.zeros_like(poses.rotations)
    still[..., 0] = 1.0
    scaled = replace(anatomy, leg_length=anatomy.leg_length * size)
    found = find_grips(WorldPoses(positions * size, still), scaled, frame_time=motion.frame_time, first=0)
    assert bool(found) == held


@pytest.mark.parametrize(("speed", "held"), [(0.3, True), (0.6, False)])
def test_hands_that_pass_by_hold_nothing(speed, held):
    # To and fro by a few centimetres, at so many metres a second at a leg of 0.85 m.
    _, anatomy, _ = body("golf/swing04.bvh")
    sway = np.abs((np.arange(121) * 0.04 * speed / 0.85 * anatomy.leg_length) % 12.0 - 6.0)
    assert bool(grips("golf/swing04.bvh", moved=sway[:, None] * [0.0, 1.0, 0.0])) == held


def test_fists_on_guard_are_near_and_hold_nothing():
    # For a second before the kick they are within a quarter of a metre, and slow; each goes by itself.
    _, anatomy, poses = body("kick.bvh")
    left, right = (arm.wrist for arm in anatomy.arms)
    near = rot.length(poses.positions[:, left] - poses.positions[:, right]) < 0.25 / 0.85 * anatomy.leg_length
    assert near[:20].all()
    assert near[55:80].all()
    assert grips("kick.bvh") == ()


@pytest.mark.parametrize(("metres", "held"), [(0.013, True), (0.016, False)])
def test_hands_at_rest_may_go_a_centimetre_by_themselves(metres, held):
    # Both hands rest before the chest, which walks on; one sways slowly: a sine's spread is 0.71 of its height.
    motion, anatomy, poses = body("walk.bvh")
    positions, rotations = poses.positions.copy(), poses.rotations.copy()
    chest = positions[:, anatomy.chest], rotations[:, anatomy.chest]
    sway = np.sin(np.arange(len(positions)) / len(positions) * 6.0 * np.pi)[:, None] * [0.0, 0.0, metres]
    for arm, own, aside in zip(anatomy.arms, (sway, 0.0 * sway), (0.08, -0.08), strict=True):
        place = own + np.array([aside, 0.0, 0.3])
        positions[:, arm.wrist] = chest[0] + rot.rotate(chest[1], place / 0.85 * anatomy.leg_length)
        rotations[:, arm.wrist] = chest[1]
    found = find_grips(WorldPoses(positions, rotations), anatomy, frame_time=motion.frame_time, first=0)
    assert bool(found) == held


@pytest.mark.parametrize("lacking", [{"arms": None}, {"chest": None}, {"leg_length": 0.0}])
def test_a_body_without_arms_or_without_size_holds_nothing(lacking):
    motion, anatomy, poses = body("golf/swing04.bvh")
    assert find_grips(poses, replace(anatomy, **lacking), frame_time=motion.frame_time, first=0) == ()


def test_a_body_of_any_size_and_turn_holds_the_same():
    motion, anatomy, poses = body("golf/swing04.bvh")
    turn = rot.normalize(np.array([0.3, 0.1, -0.5, 0.8]))
    turned = WorldPoses(rot.rotate(turn, poses.positions), rot.multiply(turn, poses.rotations))
    assert find_grips(turned, anatomy, frame_time=motion.frame_time, first=0) == ((0, 120),)
