"""Lengths over time: what a distance shall be at every frame, from its points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core.priorities.trajectories.lengths import LengthPoint, length_targets

FRAMES = 40
OWN = 0.5 + 0.2 * np.sin(np.linspace(0.0, 5.0, FRAMES))


def targets(*points, own=OWN, ease=8.0, since=0):
    return length_targets(own, points, ease_in=ease, ease_out=ease, since=since)


def hold(start, stop, length=None, bound="distance", mode="hold"):
    return LengthPoint(mode, start, stop, length=length, bound=bound)


def test_without_points_the_lengths_are_the_inputs_own():
    np.testing.assert_array_equal(targets(), OWN)


def test_a_hold_stands_at_its_length_and_eases_from_and_to_the_inputs():
    found = targets(hold(15, 25, 0.32))
    assert len(found) == 8 + 11 + 8
    np.testing.assert_array_equal(found[8:19], 0.32)
    assert (found[0], found[-1]) == (OWN[7], OWN[33])
    # It leaves and arrives at rest against the input's own: in the first and last of eight steps hardly at all.
    share = (found[:9] - OWN[7:16]) / (0.32 - OWN[7:16])
    t = np.linspace(0.0, 1.0, 9)
    np.testing.assert_allclose(share, t * t * (3.0 - 2.0 * t), atol=1e-12)


def test_a_hold_without_a_length_keeps_that_of_its_start_and_a_ride_the_inputs_own():
    found = targets(hold(10, 14), hold(20, 30, mode="during"), ease=0.0)
    np.testing.assert_array_equal(found[:5], OWN[10])
    np.testing.assert_array_equal(found[10:], OWN[20:31])


@given(
    st.sampled_from([("at_least", 1.0), ("at_most", -1.0)]),
    st.floats(0.1, 0.9),
    st.floats(0.1, 0.9),
    st.floats(0.0, 12.0),
    st.integers(0, 6),
)
def test_a_bound_asks_for_nothing_where_the_input_keeps_it(bound, one, other, ease, since):
    name, sign = bound
    points = (hold(10, 15, one, name), hold(22, 28, other, name))
    found = targets(*points, ease=ease, since=since)
    first = max(int(np.floor(10 - ease + 0.5)), since)
    own = OWN[first : first + len(found)]
    # Of all that is asked nothing is beyond both limits and the input, and where it keeps both it is left alone.
    assert np.all(sign * found <= np.maximum(sign * one, sign * other) + 1e-12)
    kept = np.minimum(sign * (own - one), sign * (own - other)) >= 0.0
    assert np.all(sign * (own - found)[kept] >= -1e-12)
    inside = slice(10 - first, 16 - first)
    np.testing.assert_array_equal(found[inside], one)


def test_a_bound_that_the_input_breaks_begins_and_ends_at_the_inputs_own():
    found = targets(hold(15, 25, 0.9, "at_least"))
    assert (found[0], found[-1]) == (OWN[7], OWN[33])


def test_a_point_at_the_clips_end_has_no_ramp_there():
    found = targets(hold(0, 5, 0.3), hold(30, FRAMES - 1, 0.4))
    assert len(found) == FRAMES
    assert (found[0], found[-1]) == (0.3, 0.4)


def test_points_that_share_a_frame_are_refused():
    with pytest.raises(ValueError, match="share a frame"):
        targets(hold(10, 20, 0.3), hold(20, 30, 0.3))
