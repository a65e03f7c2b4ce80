"""How much of something there is: all where it is wanted, and eased in and out around."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core.priorities.continuity.shares import shares_of

WANTED = st.lists(st.booleans(), min_size=1, max_size=60).map(lambda each: np.array(each, dtype=np.bool_))


def ease(t):
    """Return the polynomial of degree 5 from 0 to 1 whose first and second derivatives are 0 at both ends."""
    t = np.clip(t, 0.0, 1.0)
    return 6.0 * t**5 - 15.0 * t**4 + 10.0 * t**3


@given(WANTED, st.integers(1, 20))
def test_a_share_is_that_of_the_nearest_wanted_frame(wanted, ramp):
    share = shares_of(wanted, ramp)
    away = np.abs(np.arange(len(wanted))[:, None] - np.flatnonzero(wanted))
    nearest = away.min(axis=1, initial=len(wanted) + ramp)
    np.testing.assert_allclose(share, ease(1.0 - nearest / ramp), atol=1e-12)
    np.testing.assert_array_equal(share[wanted], 1.0)


@given(WANTED, st.integers(1, 20), st.sets(st.integers(0, 60), max_size=4))
def test_no_change_is_passed_and_no_share_grows_by_one(wanted, ramp, changes):
    whole, share = shares_of(wanted, ramp), shares_of(wanted, ramp, sorted(changes))
    assert (share >= 0.0).all()
    assert (share <= whole + 1e-12).all()
    starts = np.flatnonzero(np.diff(wanted.astype(int), prepend=0) == 1)
    for start in starts:
        before = [c for c in changes if start - ramp < c <= start]
        if before and not wanted[: max(before)].any():
            assert not share[: max(before) + 1].any()


def test_a_ramp_that_would_pass_a_change_begins_there_and_reaches_into_the_wanted_frames():
    wanted = np.zeros(60, dtype=np.bool_)
    wanted[20:41] = True
    share = shares_of(wanted, 10, [18, 44])
    f = np.arange(60)
    np.testing.assert_allclose(share, ease(np.minimum(f - 18.0, 44.0 - f) / 10.0), atol=1e-12)
    assert (share[28], share[34]) == (1.0, 1.0)


@pytest.mark.parametrize("ramp", [20, 200])
def test_shares_have_two_continuous_derivatives(ramp):
    wanted = np.zeros(6 * ramp, dtype=np.bool_)
    wanted[2 * ramp : 4 * ramp] = True
    third = np.diff(shares_of(wanted, ramp), n=3) * ramp**3
    # The third derivative of the polynomial is 60 at most; where the second jumped it would grow with the ramp.
    assert np.abs(third).max() < 61.0
