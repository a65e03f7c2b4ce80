"""Knees that are nearly straight: how a lowered pelvis bends them, and how they ease beside a foot that stands."""

import numpy as np
import pytest

from motionedit.core.feet.knees import Knee, eased_ways

FRAME_TIME = 0.01
LENGTH = 0.4  # of each of the two bones


def knee_at(angles):
    """Return a knee at angles (F,), in degrees, between two bones of one length."""
    count = len(angles)
    squares = np.full(count, 2.0 * LENGTH**2)
    return Knee(np.tile([1.0, 0.0, 0.0], (count, 1)), np.radians(angles), squares, squares)


def nearer(knee, by):
    """Return the ways from hip to ankle, nearer to each other by a length."""
    return knee.way(knee.angle) - by


@pytest.mark.parametrize("by", [0.0005, 0.002, 0.01, 0.04])
def test_a_knee_that_passes_through_straight_does_so_smoothly_on_a_lowered_pelvis(by):
    angles = np.linspace(30.0, -12.0, 15)  # 3 degrees a frame
    knee = knee_at(angles)
    lowered = np.degrees(knee.lowered(nearer(knee, by)))
    # A knee of which only the size counted would turn round at once, by 6 degrees a frame.
    assert np.abs(np.diff(lowered, n=2)).max() < 3.0
    bent = np.degrees(knee.bent(nearer(knee, by)))
    assert (lowered >= angles).all()
    assert (lowered <= bent + 1e-9).all()


def test_a_knee_bends_as_far_as_a_pelvis_comes_down_and_straightens_for_none_that_goes_away():
    knee = knee_at(np.array([40.0, 20.0, 5.0, -5.0]))
    np.testing.assert_allclose(knee.lowered(nearer(knee, 0.0)), knee.angle, rtol=0.0, atol=1e-9)
    far = nearer(knee, 0.06)
    np.testing.assert_allclose(knee.lowered(far), knee.bent(far), rtol=0.03)
    assert np.array_equal(knee.lowered(nearer(knee, -0.03)), knee.angle)


@pytest.mark.parametrize("straight", [0.0, 2.0, 6.0])
def test_a_foot_that_its_leg_is_too_short_for_leaves_the_frames_before_it_smooth(straight):
    own = np.full(60, 35.0)
    knee = knee_at(own)
    known = np.zeros(60, dtype=bool)
    known[30:40] = True
    wanted = np.full(60, straight)
    wanted[30:33] = [20.0, 10.0, max(straight, 3.0)]
    hip, before, ankle = np.zeros((60, 3)), np.zeros((60, 3)), np.zeros((60, 3))
    before[:, 1] = -knee.way(knee.angle)
    ankle[:, 1] = np.where(known, -knee_at(wanted).way(np.radians(wanted)), before[:, 1])
    ankle[33:40, 1] -= 0.05 if straight == 0.0 else 0.0
    back = np.zeros(60, dtype=bool)
    ways, bent_back = eased_ways(knee, hip, before, ankle, known=known, back=back, frame_time=FRAME_TIME)
    angles = np.degrees(knee.bent(ways))
    assert not bent_back.any()
    assert np.array_equal(ways[known], np.linalg.norm(ankle[known], axis=1))
    assert angles[~known].min() >= 0.0
    assert angles[~known].max() < 60.0


def test_a_foot_that_leaves_its_plant_by_a_bent_leg_is_not_thrown_up_where_the_leg_was_straight():
    # Straight to the end of its plant, the leg bends by 20 degrees in a frame: 17 mm nearer to the hip.
    own = np.concatenate((np.full(30, 4.0), np.minimum(24.0 + 12.0 * np.arange(30), 70.0)))
    knee, known = knee_at(own), np.arange(60) < 30
    hip, before, ankle = np.zeros((60, 3)), np.zeros((60, 3)), np.zeros((60, 3))
    before[:, 1] = -knee.way(knee.angle)
    ankle[:, 1] = before[:, 1] + 0.04 * np.where(known, 1.0, np.exp(-0.1 * np.maximum(np.arange(60) - 29.0, 0.0)))
    back = np.zeros(60, dtype=bool)
    ways, _ = eased_ways(knee, hip, before, ankle, known=known, back=back, frame_time=1.0 / 60.0)
    steps = np.diff(ways)[29:], np.diff(knee.way(knee.angle))[29:]
    assert np.degrees(knee.bent(ways)[29]) == pytest.approx(36.0, abs=2.0)
    assert abs(steps[0][0]) < 2.0 * abs(steps[1][0])
