"""Low-passed displacement maps, and the paper's FIR filter ([PRIO] section 5)."""

from dataclasses import replace

import numpy as np
import pytest
from human import BONES, ROOT_CHANNELS, above, skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward, shifted
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.displacement import filtered_root, fir_low_pass, smoothed_displacement


def test_the_fir_filter_keeps_a_constant_and_takes_away_what_is_fast():
    constant = np.full((60, 3), 2.5)
    np.testing.assert_allclose(fir_low_pass(constant, cutoff=0.1), constant)
    t = np.arange(200)
    slow, fast = np.sin(2 * np.pi * 0.01 * t)[:, None], np.sin(2 * np.pi * 0.3 * t)[:, None]
    inside = slice(30, -30)
    np.testing.assert_allclose(fir_low_pass(slow, cutoff=0.1)[inside], slow[inside], atol=0.05)
    assert np.abs(fir_low_pass(fast, cutoff=0.1)[inside]).max() < 0.02


def test_a_cutoff_above_half_the_rate_changes_nothing():
    rows = np.random.default_rng(0).normal(size=(20, 3))
    np.testing.assert_array_equal(fir_low_pass(rows, cutoff=0.5), rows)


def test_only_the_roots_displacement_is_filtered():
    before = standing(skeleton_of(), 60)
    jump = before.translations.copy()
    jump[30:] += 0.1
    after = Motion(before.skeleton, before.rotations, jump, before.frame_time)
    result = filtered_root(before, after, cutoff=10.0, first=2)
    steps = np.abs(np.diff(result.translations[:, 0, 0]))
    assert 0.0 < steps.max() < 0.05
    np.testing.assert_array_equal(result.translations[:2], after.translations[:2])


FILTERS = {
    "gaussian": lambda *motions: smoothed_displacement(*motions, sigma=3.0, first=2),
    "fir": lambda *motions: filtered_root(*motions, cutoff=10.0, first=2),
}


@pytest.mark.parametrize("name", FILTERS)
def test_a_shift_is_smoothed_in_the_world_below_a_joint_that_turns(name):
    skeleton, spin = skeleton_of(above(BONES, "Root")), rot.about_axis(1, np.linspace(0.0, 9.0, 60))
    skeleton = replace(skeleton, channels=(ROOT_CHANNELS, ROOT_CHANNELS, *skeleton.channels[2:]))
    still = standing(skeleton, 60)
    rotations = still.rotations.copy()
    rotations[:, 0] = spin
    shift = np.where(np.arange(60)[:, None] >= 30, (0.3, 0.1, 0.2), 0.0)
    paths = []
    for before in (still, replace(still, rotations=rotations)):
        smooth = FILTERS[name](before, shifted(before, shift, 1))
        paths.append((forward(smooth).positions - forward(before).positions)[:, 1])
    np.testing.assert_allclose(paths[1], paths[0], atol=1e-12)
    assert 0.0 < np.linalg.norm(np.diff(paths[0], axis=0), axis=1).max() < 0.2


def test_the_displacement_is_smoothed_and_what_has_none_stays_bit_for_bit():
    before = standing(skeleton_of(), 60)
    after = with_rotation(before, "Head", 30, (0.3, 0.0, 0.0))
    smooth = smoothed_displacement(before, after, sigma=2.0, first=0)
    head = before.skeleton.names.index("Head")
    angles = np.linalg.norm(rot.log(smooth.rotations[:, head]), axis=1)
    assert 0.0 < angles[30] < 0.1
    assert angles[26] > 0.0
    others = [j for j in range(len(before.skeleton)) if j != head]
    np.testing.assert_array_equal(smooth.rotations[:, others], before.rotations[:, others])
    far = [*range(23), *range(37, 60)]
    np.testing.assert_array_equal(smooth.rotations[far], before.rotations[far])
