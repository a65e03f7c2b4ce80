import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core.body.contacts import Plant
from motionedit.core.body.ground import axis_vector
from motionedit.core.body.quality import JerkMeter, find_defects, foot_drift, foot_slide_max, jerk_rms
from motionedit.core.motion import Motion

UP = axis_vector("y")


@given(st.floats(0.1, 5.0), st.floats(0.005, 0.05))
def test_the_jerk_of_a_cubic_is_its_third_derivative(a, frame_time):
    t = np.arange(30) * frame_time
    positions = np.zeros((30, 2, 3))
    positions[:, 0, 0] = a * t**3
    positions[:, 1, 2] = 4.0 * t**2 - t
    # One of two joints has the jerk 6 a, the other none.
    assert jerk_rms(positions, frame_time=frame_time) == pytest.approx(6.0 * a / np.sqrt(2.0), rel=1e-6)


def test_jerk_leaves_a_rest_pose_out_and_is_zero_for_fewer_than_four_frames():
    positions = np.zeros((10, 1, 3))
    positions[0] = 7.0
    assert jerk_rms(positions, frame_time=0.01) > 0.0
    assert jerk_rms(positions, frame_time=0.01, first=1) == 0.0
    assert jerk_rms(positions[:4], frame_time=0.01, first=1) == 0.0


@pytest.mark.parametrize("size", [1, 3, 4, 30])
@pytest.mark.parametrize("first", [0, 2])
def test_the_jerk_meter_knows_where_the_largest_jerk_is_whatever_the_blocks(size, first):
    positions = np.zeros((30, 4, 3))
    # A corner: its third differences are 1, -1 in the four frames around it.
    positions[18:, 2, 1] = np.arange(12)
    positions[18:, 1, 1] = 0.5 * np.arange(12)
    meter = JerkMeter(first)
    for start in range(0, 30, size):
        meter.add(positions[start : start + size])
    joint, frame = meter.worst
    assert joint == 2
    assert 17 <= frame <= 19


def planted(point, start, stop):
    return Plant("left", "heel", joint=7, point=point, start=start, stop=stop, height=0.0)


def test_sliding_is_the_fastest_horizontal_speed_of_a_planted_point():
    tracks = np.zeros((20, 2, 3))
    tracks[:, 0, 0] = 0.01 * np.arange(20)  # 1 unit/s along the ground
    tracks[:, 0, 1] = 0.5 * np.arange(20)  # height does not count
    tracks[11:, 0, 2] = 5.0  # after the plant
    plants = [planted(0, 2, 10), planted(1, 0, 19)]
    assert foot_slide_max(tracks, plants, up=UP, frame_time=0.01) == pytest.approx(1.0)
    assert foot_slide_max(tracks, [], up=UP, frame_time=0.01) == 0.0
    assert foot_slide_max(tracks, [planted(0, 10, 12)], up=UP, frame_time=0.01) > 100.0
    assert foot_slide_max(tracks, [planted(0, 10, 10)], up=UP, frame_time=0.01) == 0.0


def test_the_fastest_of_several_plants_of_a_point_counts():
    tracks = np.zeros((20, 1, 3))
    tracks[10:, 0, 2] = 0.02 * np.arange(10)
    plants = [planted(0, 0, 5), planted(0, 12, 19)]
    assert foot_slide_max(tracks, plants, up=UP, frame_time=0.01) == pytest.approx(2.0)
    assert foot_slide_max(tracks, plants[:1], up=UP, frame_time=0.01) == 0.0


def test_drift_is_the_largest_distance_between_planted_points_of_two_motions():
    before = np.random.default_rng(0).normal(size=(20, 2, 3))
    after = before.copy()
    after[5, 0] += [3.0, 4.0, 0.0]
    after[15, 0] += 100.0
    assert foot_drift(before, after, [planted(0, 0, 14), planted(1, 0, 19)]) == pytest.approx(5.0)
    assert foot_drift(before, after, [planted(0, 6, 14)]) == 0.0
    assert foot_drift(before, after, [planted(0, 5, 15)]) == pytest.approx(100.0 * np.sqrt(3.0))
    assert foot_drift(before, after, []) == 0.0


def test_a_step_above_one_radian_is_a_defect_and_the_steps_of_a_joint_are_told_together():
    motion = with_rotation(standing(skeleton_of()), "LeftHand", [4, 9], [0.0, 1.2, 0.0])
    motion = with_rotation(motion, "LeftHand", [9], [0.0, 3.1, 0.0])
    motion = with_rotation(motion, "Head", slice(7, None), [0.9, 0.0, 0.0])
    (defect,) = find_defects(motion)
    assert motion.skeleton.names[defect.joint] == "LeftHand"
    assert defect.frames == (4, 5, 9, 10)
    assert defect.worst == 9
    assert defect.angle == pytest.approx(3.1)
    assert defect.flips == 2


def test_defects_of_a_rest_pose_are_none():
    motion = with_rotation(standing(skeleton_of()), "LeftArm", slice(1, None), [0.0, 0.0, 1.4])
    assert [defect.frames for defect in find_defects(motion)] == [(1,)]
    assert find_defects(motion, first=1) == []


def test_another_euler_branch_or_sign_is_no_defect():
    motion = standing(skeleton_of())
    rotations = motion.rotations * np.where(np.arange(20) % 2, -1.0, 1.0)[:, None, None]
    assert find_defects(Motion(motion.skeleton, rotations, motion.translations, 0.01)) == []
    full = with_rotation(motion, "LeftHand", slice(5, None), [2.0 * np.pi, 0.0, 0.0])
    assert find_defects(full) == []


def test_one_frame_has_no_defects():
    assert find_defects(standing(skeleton_of(), frames=1)) == []
