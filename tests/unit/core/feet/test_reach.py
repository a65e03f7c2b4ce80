"""How far a heel may be from its hip: as far as its leg reaches, and its knee bends without a kick."""

import numpy as np

from motionedit.core.body.anatomy import Leg
from motionedit.core.feet.knees import Knee
from motionedit.core.feet.reach import handed_on, reach_bent, reach_calm
from motionedit.core.feet.stance import Foot, Stance
from motionedit.core.kinematics import WorldPoses

UP, FRAME_TIME, LANDS = np.array([0.0, 1.0, 0.0]), 0.01, 20
# Two bones of one metre, the ankle at the origin: the knee bends by 3 degrees a frame as the hip comes down.
ANGLE = np.radians(30.0 + 3.0 * np.maximum(np.arange(40) - LANDS, 0))
WAY = 2.0 * np.cos(0.5 * ANGLE)


def standing(place):
    """Return what `reach_calm` needs of a leg whose heel stands at a place from frame 20 on."""
    hip = WAY[:, None] * UP
    knee = 0.5 * hip + np.sqrt(1.0 - 0.25 * WAY**2)[:, None] * np.array([0.0, 0.0, 1.0])
    poses = WorldPoses(np.stack((hip, knee, np.zeros((40, 3))), axis=1), np.zeros((40, 3, 4)))
    foot = Foot("left", Leg(0, 1, 2, None), None)
    bends = Knee(np.tile([1.0, 0.0, 0.0], (40, 1)), ANGLE, np.full(40, 2.0), np.full(40, 2.0))
    heel = np.arange(40) >= LANDS
    places = np.tile(place, (40, 1))
    stance = Stance(heel, np.zeros_like(heel), places, places, np.zeros((40, 4)), np.where(heel, 0, -1))
    return poses, foot, bends, stance


def reaches(place, calms=1.0):
    poses, foot, knee, stance = standing(place)
    calm = reach_calm(poses, foot, knee, stance, FRAME_TIME, calms=calms)
    return calm, reach_bent(poses, foot, knee, stance.heel_place), knee, poses


def test_a_heel_that_stays_where_it_is_asks_for_nothing():
    calm, _, _, _ = reaches(np.zeros(3))
    assert (calm[LANDS:] >= WAY[LANDS:] - 1e-12).all()


def test_a_knee_that_would_kick_beside_a_heel_is_bent_more():
    place = -0.055 * UP
    calm, bent, knee, poses = reaches(place)
    far = np.linalg.norm(poses.positions[:, 0] - place, axis=1)
    steps = [float(np.diff(knee.bent(np.minimum(reach, far))[LANDS:]).max()) for reach in (bent, calm)]
    assert np.degrees(steps[0]) > 5.5  # nearly straight, the knee bends at almost twice its speed
    assert np.degrees(steps[1]) < 5.0
    off = np.linalg.norm(place)
    assert calm[LANDS] >= WAY[LANDS] - off - 1e-12  # no nearer than the foot was moved


def test_a_pelvis_calms_a_knee_by_so_much_and_no_more():
    place = -0.055 * UP
    calm, _, _, poses = reaches(place, calms=0.001)
    far = np.linalg.norm(poses.positions[:, 0] - place, axis=1)
    assert (calm >= far - 0.002 - 1e-12)[LANDS:].all()


def test_a_knee_that_would_snap_straight_and_open_again_is_bent_more():
    # The hip rises by 6 cm and sinks again within 0.2 s, over a heel that was put 20 cm lower.
    rises = 0.06 * np.sin(np.pi * np.clip((np.arange(40) - 10.0) / 20.0, 0.0, 1.0)) ** 2
    way, place = 1.8 + rises, -0.2 * UP
    hip = way[:, None] * UP
    knee = 0.5 * hip + np.sqrt(1.0 - 0.25 * way**2)[:, None] * np.array([0.0, 0.0, 1.0])
    poses = WorldPoses(np.stack((hip, knee, np.zeros((40, 3))), axis=1), np.zeros((40, 3, 4)))
    bends = Knee(np.tile([1.0, 0.0, 0.0], (40, 1)), 2.0 * np.arccos(0.5 * way), np.full(40, 2.0), np.full(40, 2.0))
    heel = np.ones(40, dtype=np.bool_)
    places, foot = np.tile(place, (40, 1)), Foot("left", Leg(0, 1, 2, None), None)
    stance = Stance(heel, ~heel, places, places, np.zeros((40, 4)), np.zeros(40, dtype=np.intp))
    far = np.linalg.norm(hip - place, axis=1)
    turns = []
    for reach in (
        reach_bent(poses, foot, bends, places),
        reach_calm(poses, foot, bends, stance, FRAME_TIME, calms=1.0),
    ):
        lowered = far - max(float((far - reach).max()), 0.0)
        turns.append(np.degrees(np.abs(np.diff(bends.bent(lowered), n=2)).max()) / FRAME_TIME**2)
    assert turns[0] > 11000.0
    assert turns[1] < 9500.0


def test_a_foot_comes_from_heel_to_toe_by_both():
    heel, toe = np.array([1, 1, 1, 1, 0, 0]) > 0, np.array([0, 0, 1, 1, 1, 1]) > 0
    places = np.zeros((6, 3))
    stance = Stance(heel, toe, places, places, np.zeros((6, 4)), np.zeros(6, dtype=np.intp))
    up_again = Stance(heel & ~toe, toe, places, places, np.zeros((6, 4)), np.zeros(6, dtype=np.intp))
    assert handed_on(stance, up_again).heel.tolist() == [True, True, True, False, False, False]
    assert np.array_equal(handed_on(stance, stance).heel, heel)
