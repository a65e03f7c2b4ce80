"""What is asked of arrays is what numpy says of them, or what stands there plainly."""

import numpy as np
import pytest

from motionedit.core.arrays import median, percentile, runs


@pytest.mark.parametrize("shape", [(1,), (2,), (7, 3), (8, 3)])
def test_the_median_is_numpys(shape):
    values = np.random.default_rng(1).normal(size=shape)
    np.testing.assert_array_equal(median(values), np.median(values, axis=0))


@pytest.mark.parametrize("rows", [2, 3, 50, 51, 145])
@pytest.mark.parametrize("share", [2.0, 95.0])
def test_the_percentile_is_numpys(rows, share):
    values = np.random.default_rng(rows).normal(size=(rows, 4))
    np.testing.assert_allclose(percentile(values, share), np.percentile(values, share, axis=0), rtol=1e-13)


def test_runs_are_found_with_both_ends_in():
    assert runs(np.array([], dtype=bool)) == []
    assert runs(np.array([True, True, False, True])) == [(0, 1), (3, 3)]
    assert runs(np.array([False, True, True, False])) == [(1, 2)]
