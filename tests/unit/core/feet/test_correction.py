"""Corrections that ease between plants: what is known stands, the rest is the least of what the docstring says."""

import numpy as np
import pytest

from motionedit.core.feet.correction import eased

FRAME_TIME = 1.0 / 60.0


def least(values, known):
    """Return the minimiser by dense least squares, from the docstring: tau 0.02 s, 0.01 of the correction itself."""
    count = len(known)
    rows = [(0.02 / FRAME_TIME) ** 3 * np.diff(np.eye(count), n=3, axis=0)]
    rows.append(np.diag(np.sqrt(np.full(count, 0.01))))
    A = np.concatenate(rows)
    found = np.where(known[:, None], values, 0.0)
    found[~known] = np.linalg.lstsq(A[:, ~known], -A[:, known] @ values[known], rcond=None)[0]
    return found


@pytest.mark.parametrize("spans", [[(0, 8), (30, 44)], [(10, 12), (14, 20), (40, 60)], [(5, 6), (9, 9)]])
def test_unknown_frames_are_the_least_third_difference_and_known_ones_stand(spans):
    rng = np.random.default_rng(3)
    known = np.zeros(61, dtype=bool)
    for a, b in spans:
        known[a : b + 1] = True
    values = rng.normal(size=(61, 3))
    found = eased(values, known, FRAME_TIME)
    assert np.array_equal(found[known], values[known])
    assert found == pytest.approx(least(values, known), abs=1e-7)


def test_a_long_gap_is_nothing_in_its_middle_and_no_plants_are_no_correction():
    known = np.zeros(1000, dtype=bool)
    known[:5] = known[-5:] = True
    assert np.abs(eased(np.ones((1000, 1)), known, FRAME_TIME)[200:800]).max() < 1e-6
    assert not eased(np.ones((50, 2)), np.zeros(50, dtype=bool), FRAME_TIME).any()
