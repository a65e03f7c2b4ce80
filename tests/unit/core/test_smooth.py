"""Shares that go smoothly from nothing to all."""

import numpy as np

from motionedit.core.smooth import smooth_share


def test_a_share_goes_from_its_start_to_its_stop_and_stays_there():
    np.testing.assert_allclose(smooth_share(np.array([1.0, 2.0, 3.0, 4.0, 9.0]), 2.0, 4.0), [0.0, 0.0, 0.5, 1.0, 1.0])
    np.testing.assert_allclose(smooth_share(np.array([1.0, 2.5, 9.0]), 4.0, 2.0), [1.0, 0.84375, 0.0])
