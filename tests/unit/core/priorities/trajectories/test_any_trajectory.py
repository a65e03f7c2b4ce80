"""Whatever is asked of a trajectory, and on a real walk: finite, through every point, without a step."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from trajectories_through_points import T, hold, largest_turn_jump, turned, whole

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.core.priorities.trajectories.positions import (
    ControlPoint,
    active_interval,
    eased,
    position_targets,
)
from motionedit.core.units import STANDARD_LEG


@st.composite
def sessions(draw):
    """Return a smooth path of some frames, and points on it."""
    frames = draw(st.integers(1, 80))
    path = np.cumsum(draw(nps.arrays(np.float64, (frames, 3), elements=st.floats(-1.0, 1.0))), axis=0)
    times = sorted(draw(st.sets(st.integers(0, frames - 1), min_size=1, max_size=8)))
    vectors = nps.arrays(np.float64, 3, elements=st.floats(-10.0, 10.0))
    points = []
    while times:
        start = times.pop(0)
        mode = draw(st.sampled_from(["hold", "during", "at"]))
        stop = times.pop(0) if times and mode != "at" else start
        means = [(None, None), (None, draw(vectors))] + [(draw(vectors), None)] * (mode != "during")
        position, shift = draw(st.sampled_from(means))
        points.append(ControlPoint(mode, start, stop, position, shift, None, *draw(st.tuples(*[st.floats(-1, 1)] * 3))))
    return path, points, draw(st.floats(0.0, 40.0)), draw(st.floats(0.0, 40.0))


@given(sessions(), st.sampled_from(["time", "index"]))
def test_any_targets_are_finite_meet_every_point_and_are_bounded(session, curve):
    path, points, ease_in, ease_out = session
    first, found = position_targets(path, points, ease_in=ease_in, ease_out=ease_out, curve=curve)
    last = active_interval(points, ease_in=ease_in, ease_out=ease_out, frames=len(path))[1]
    assert found.shape == (last - first + 1, 3)
    assert np.isfinite(found).all()
    # A ramp that the clip does not cut meets the input.
    if first < points[0].start and eased(points, ease_in=ease_in, ease_out=ease_out)[0] >= 0:
        np.testing.assert_array_equal(found[0], path[first])
    if last > points[-1].stop and eased(points, ease_in=ease_in, ease_out=ease_out)[1] < len(path):
        np.testing.assert_array_equal(found[-1], path[last])
    for point in points:
        ride = path[point.start : point.stop + 1] if point.mode == "during" else path[point.start]
        wanted = ride + (0.0 if point.shift is None else point.shift) if point.position is None else point.position
        block = found[point.start - first : point.stop - first + 1]
        np.testing.assert_array_equal(block, np.broadcast_to(wanted, block.shape))


@given(sessions(), st.sampled_from(["time", "index"]))
def test_any_targets_are_continuous_finer_frames_take_steps_as_much_smaller(session, curve):
    path, points, ease_in, ease_out = session

    def largest_step(fine):
        """Return the longest step of the same session at `fine` frames for one."""
        frames = np.arange(fine * (len(path) - 1) + 1) / fine
        dense = np.stack([np.interp(frames, np.arange(len(path)), axis) for axis in path.T], axis=1)
        finer = [replace(point, start=fine * point.start, stop=fine * point.stop) for point in points]
        # Whole frames, so that no ramp is shorter than one.
        eases = {"ease_in": fine * round(ease_in), "ease_out": fine * round(ease_out)}
        _, found = position_targets(dense, finer, **eases, curve=curve)
        return np.abs(np.diff(found, axis=0)).max(initial=0.0)

    assert largest_step(160) <= 0.2 * largest_step(20) + 1e-12


def test_a_joint_less_than_half_a_turn_from_its_goal_is_led_back_on_the_side_on_which_it_is():
    # The input turns on while the goal stands: by 1.2 rad at its end, and half way through the ramp by more than pi.
    angle = np.where(T < 4.0, 1.2, 1.2 + 6.0 * (T - 4.0))
    turns = rot.exp(np.outer(angle, [0.0, 0.0, 1.0]))
    found = turned([hold(2000, 4000, orientation=rot.exp(np.zeros(3)))], turns=turns)
    behind = rot.log(rot.multiply(rot.conjugate(turns), found))[4000:5001, 2]
    assert behind.max() < 1e-9
    assert -np.pi < behind.min() < -1.2
    assert largest_turn_jump(found[4001:5000]) < 0.1


# A real walk.


@pytest.fixture(scope="module")
def walk():
    """Return the paths of the right ankle and wrist, normalised metres, and the frames of one second."""
    folder = os.environ.get("MOTIONEDIT_CLIPS")
    file = Path(folder or "", "motions", "cmu_12_01_walk.bvh")
    if folder is None or not file.exists():
        pytest.skip("MOTIONEDIT_CLIPS names no folder of real clips with this walk")
    motion = read_clip(file).motion
    anatomy = find_anatomy(motion.skeleton)
    poses = forward(motion)
    joints = (anatomy.legs[1].ankle, anatomy.arms[1].wrist)
    scale = STANDARD_LEG / anatomy.leg_length
    return [effector_positions(poses, Effector(j, np.zeros(3))) * scale for j in joints], 1.0 / motion.frame_time


@pytest.mark.parametrize("more", ["shift", "position"])
def test_on_a_real_walk_the_velocity_breaks_little_at_ramps_beyond_the_walks_own_and_at_holds(walk, more):
    paths, rate = walk
    ease = round(0.8 * rate)

    def breaks(path, frames):
        return np.linalg.norm(path[frames + 1] - 2.0 * path[frames] + path[frames - 1], axis=1) * rate

    for path in paths:
        speed = 0.0
        for start in range(110, len(path) - 150, 10):
            shift = np.array([0.0, 0.1, 0.1])
            how = {"shift": shift} if more == "shift" else {"position": path[start] + shift}
            found = whole([hold(start, start + 24, **how)], path=path, ease=ease)
            ramps, holds = np.array([start - ease, start + 24 + ease]), np.array([start, start + 24])
            assert (breaks(found, ramps) < breaks(path, ramps) + 0.2).all()
            assert (breaks(found, holds) < 0.25).all()
            speed = max(speed, np.linalg.norm(path[ramps + 1] - path[ramps], axis=1).max() * rate)
        # Without the input's velocity a ramp of the path would break it by all of that.
        assert speed > 1.5
