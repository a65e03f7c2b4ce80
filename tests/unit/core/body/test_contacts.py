import numpy as np
import pytest
from human import ANKLE_HEIGHT, HIPS_HEIGHT, skeleton_of, standing

from motionedit.core.arrays import percentile
from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.body.contacts import find_plants
from motionedit.core.body.ground import axis_vector
from motionedit.core.kinematics import WorldPoses, forward
from motionedit.core.motion import Motion

UP = axis_vector("y")


def carried(height, forward_speed=None, *, frame_time=0.01, scale=1.0):
    """Return a body whose stiff legs are lifted by `height` (F,) and moved on at `forward_speed` (F,), m and m/s."""
    height = np.asarray(height, dtype=float)
    speed = np.zeros(len(height)) if forward_speed is None else np.asarray(forward_speed, dtype=float)
    skeleton = skeleton_of(scale=scale)
    motion = standing(skeleton, frames=len(height), frame_time=frame_time)
    translations = np.zeros((len(height), 1, 3))
    translations[:, 0, 1] = scale * (HIPS_HEIGHT + height)
    translations[:, 0, 2] = scale * np.concatenate(([0.0], np.cumsum(speed[1:]) * frame_time))
    return Motion(skeleton, motion.rotations, translations, frame_time)


def plants_of(motion, first=0):
    anatomy = find_anatomy(motion.skeleton)
    return find_plants(motion, forward(motion), anatomy, up=UP, first=first)


def spans(motion, joint="LeftFoot", first=0):
    index = motion.skeleton.names.index(joint)
    return [(plant.start, plant.stop) for plant in plants_of(motion, first) if plant.joint == index]


def test_feet_that_stand_are_planted_from_the_first_frame_to_the_last():
    plants = plants_of(carried(np.zeros(30)))
    names = standing(skeleton_of()).skeleton.names
    found = {(plant.foot, names[plant.joint], plant.start, plant.stop, plant.frames) for plant in plants}
    assert found == {
        (side.lower(), side + part, 0, 29, 30) for side in ("Left", "Right") for part in ("Foot", "ToeBase")
    }


def test_a_lifted_foot_is_not_planted():
    height = np.zeros(60)
    height[20:40] = 0.2
    # The jumps from 0 to 0.2 m are fast, at the frames beside them too: the speed is a central difference.
    assert spans(carried(height)) == [(0, 18), (41, 59)]


def test_a_foot_is_low_up_to_six_centimetres_above_where_it_stands():
    ramp = np.concatenate((np.zeros(40), np.linspace(0.0, 0.19, 101)[1:]))  # 0.19 m/s
    assert spans(carried(ramp)) == [(0, 70)]  # 0.0589 m; frame 71 is at 0.0608


@pytest.mark.parametrize(("speed", "planted"), [(0.34, True), (0.36, False)])
def test_a_foot_is_slow_up_to_a_third_of_a_metre_per_second(speed, planted):
    assert bool(plants_of(carried(np.zeros(40), np.full(40, speed)))) is planted


@pytest.mark.parametrize(("gap", "expected"), [(2, [(0, 39)]), (3, [(0, 18), (22, 39)])])
def test_gaps_of_up_to_two_frames_are_closed(gap, expected):
    motion = carried(np.zeros(40))
    poses = forward(motion)
    places = poses.positions.copy()
    # A speed above the limit at `gap` frames: steps of 1 cm between gap - 1 of them.
    places[20 : 20 + gap - 1 + 20, :, 0] += 0.01 * np.minimum(np.arange(1, 20 + gap), max(gap - 1, 1))[: 40 - 20, None]
    plants = find_plants(motion, WorldPoses(places, poses.rotations), find_anatomy(motion.skeleton), up=UP, first=0)
    foot = motion.skeleton.names.index("LeftFoot")
    assert [(plant.start, plant.stop) for plant in plants if plant.joint == foot] == expected


@pytest.mark.parametrize(("frames", "planted"), [(9, False), (10, True)])
def test_a_plant_lasts_a_tenth_of_a_second_at_least(frames, planted):
    height = np.full(60, 0.3)
    height[20 : 20 + frames + 2] = 0.0  # one frame at each end is fast
    assert bool(spans(carried(height))) is planted


def test_the_unit_of_the_file_does_not_matter():
    height = np.concatenate((np.zeros(40), np.linspace(0.0, 0.19, 101)[1:]))
    assert spans(carried(height)) == spans(carried(height, scale=1000.0))


def test_frames_of_a_rest_pose_are_never_planted_nor_asked_for_the_floor():
    height = np.concatenate(([-1.0, -1.0], np.zeros(30)))
    assert spans(carried(height), first=2) == [(2, 31)]


def test_ankle_and_toe_are_planted_by_themselves():
    motion = carried(np.zeros(60))
    poses = forward(motion)
    places = poses.positions.copy()
    ankle, toe = (motion.skeleton.names.index(name) for name in ("LeftFoot", "LeftToeBase"))
    places[30:, ankle, 1] = ANKLE_HEIGHT + 0.2
    plants = find_plants(motion, WorldPoses(places, poses.rotations), find_anatomy(motion.skeleton), up=UP, first=0)
    left = {plant.joint: plant.stop for plant in plants if plant.foot == "left"}
    assert left[ankle] < 30
    assert left[toe] == 59


def test_a_body_without_legs_or_a_take_of_one_frame_has_no_plants():
    motion = carried(np.zeros(3))
    assert plants_of(motion, first=2) == []
    arms = [("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]
    assert plants_of(standing(skeleton_of(arms))) == []


@pytest.mark.parametrize("rows", [2, 3, 50, 51, 145])
def test_the_low_percentile_is_numpys(rows):
    heights = np.random.default_rng(rows).normal(size=(rows, 4))
    np.testing.assert_allclose(percentile(heights, 2.0), np.percentile(heights, 2.0, axis=0), rtol=1e-13)
