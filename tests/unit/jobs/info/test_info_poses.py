"""What `info --at` prints: as many digits as a tolerance needs, whatever the unit, and no minus before zero."""

import numpy as np
import pytest

from motionedit.jobs.info.poses import _decimals, _rounded


@pytest.mark.parametrize(
    ("leg_length", "decimals"),
    [(0.85, 5), (85.0, 3), (850.0, 2), (33.5, 3), (1e7, 0), (1e-7, 9), (0.0, 6)],
)
def test_positions_are_told_to_a_hundred_thousandth_of_the_leg(leg_length, decimals):
    assert _decimals(leg_length) == decimals


def test_what_rounds_to_zero_has_no_sign():
    assert str(_rounded(np.array([-1e-9, -0.0, -0.0016]), 3)) == "[0.0, 0.0, -0.002]"
