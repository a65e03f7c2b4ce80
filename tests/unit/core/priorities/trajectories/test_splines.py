"""Kochanek-Bartels splines: closed forms, uneven knots, and what tension, continuity and bias do to the speed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps
from scipy.interpolate import CubicHermiteSpline

from motionedit.core.priorities.trajectories.splines import basis_of, kochanek_bartels

KNOTS = np.array([0.0, 1.0, 4.0, 4.5, 9.0])
VALUES = np.random.default_rng(7).normal(size=(5, 3))
START, END = np.array([1.0, -2.0, 0.5]), np.array([0.0, 3.0, 1.0])


def curve(at, knots=KNOTS, values=VALUES, *, start=START, end=END, tension=0.0, continuity=0.0, bias=0.0):
    shape = {"tension": tension, "continuity": continuity, "bias": bias}
    shape = {name: np.broadcast_to(np.asarray(value, float), knots.shape) for name, value in shape.items()}
    at = np.atleast_1d(np.asarray(at, float))
    return kochanek_bartels(knots, values, **shape, start_tangent=start, end_tangent=end, basis=basis_of(knots, at))


def speeds(knot, step=1e-6, **shape):
    """Return the slopes just before and just after a knot, by one-sided second-order differences."""
    before = curve(knot - step * np.arange(3), **shape)
    after = curve(knot + step * np.arange(3), **shape)
    weights = np.array([3.0, -4.0, 1.0]) / (2.0 * step)
    return weights @ before, -weights @ after


def test_the_curve_passes_through_its_knots_exactly():
    np.testing.assert_array_equal(curve(KNOTS, tension=0.3, continuity=-0.4, bias=0.7), VALUES)


def test_without_parameters_it_is_hermites_cubic_with_the_slopes_between_the_neighbours():
    inner = (VALUES[2:] - VALUES[:-2]) / (KNOTS[2:] - KNOTS[:-2])[:, None]
    expected = CubicHermiteSpline(KNOTS, VALUES, np.vstack((START, inner, END)))
    at = np.linspace(0.0, 9.0, 301)
    np.testing.assert_allclose(curve(at), expected(at), atol=1e-13)


def test_a_straight_line_at_uneven_knots_stays_one_at_constant_speed():
    slope = np.array([2.0, -1.0, 0.25])
    at = np.linspace(0.0, 9.0, 97)
    line = curve(at, values=KNOTS[:, None] * slope, start=slope, end=slope)
    np.testing.assert_allclose(line, at[:, None] * slope, atol=1e-13)


def test_halfway_between_even_knots_it_is_catmull_roms_closed_form():
    even = np.arange(5.0)
    expected = (-VALUES[0] + 9.0 * VALUES[1] + 9.0 * VALUES[2] - VALUES[3]) / 16.0
    np.testing.assert_allclose(curve(1.5, even)[0], expected, atol=1e-14)


def test_the_given_tangents_are_the_slopes_at_the_ends():
    _, start = speeds(KNOTS[0])
    end, _ = speeds(KNOTS[-1])
    np.testing.assert_allclose(start, START, atol=1e-5)
    np.testing.assert_allclose(end, END, atol=1e-5)


@pytest.mark.parametrize("shape", [{}, {"tension": 0.6}, {"bias": -0.8}, {"tension": -0.5, "bias": 0.3}])
@pytest.mark.parametrize("knot", KNOTS[1:-1])
def test_the_speed_is_continuous_at_uneven_knots_while_continuity_is_zero(knot, shape):
    before, after = speeds(knot, **shape)
    np.testing.assert_allclose(before, after, atol=1e-4)


def test_the_second_derivative_jumps_so_it_is_not_c2():
    step = 1e-4
    before, after = (np.diff(curve(KNOTS[2] + side * step * np.arange(3)), n=2, axis=0) / step**2 for side in (-1, 1))
    assert np.abs(before - after).max() > 1.0


@pytest.mark.parametrize(("t", "c", "b"), [(0.0, 0.5, 0.0), (0.4, -0.3, 0.6), (0.0, 0.0, 1.0), (-0.5, 1.0, -0.2)])
def test_tangents_are_those_of_kochanek_and_bartels_corrected_for_uneven_knots(t, c, b):
    h0, h1 = KNOTS[2] - KNOTS[1], KNOTS[3] - KNOTS[2]
    before, after = VALUES[2] - VALUES[1], VALUES[3] - VALUES[2]
    into = 0.5 * (1 - t) * ((1 - c) * (1 + b) * before + (1 + c) * (1 - b) * after)
    out = 0.5 * (1 - t) * ((1 + c) * (1 + b) * before + (1 - c) * (1 - b) * after)
    found_into, found_out = speeds(KNOTS[2], tension=t, continuity=c, bias=b)
    np.testing.assert_allclose(found_into, into * 2 * h0 / (h0 + h1) / h0, atol=1e-4)
    np.testing.assert_allclose(found_out, out * 2 * h1 / (h0 + h1) / h1, atol=1e-4)


def test_tension_one_stops_at_the_knot():
    for speed in speeds(KNOTS[2], tension=[0.0, 0.0, 1.0, 0.0, 0.0]):
        np.testing.assert_allclose(speed, 0.0, atol=1e-4)


def test_two_equal_knots_of_tension_one_do_not_drift_by_a_bit():
    values = VALUES.copy()
    values[2] = values[1]
    held = curve(np.linspace(KNOTS[1], KNOTS[2], 1001), values=values, tension=[0.0, 1.0, 1.0, 0.0, 0.0])
    np.testing.assert_array_equal(held, np.broadcast_to(values[1], held.shape))
    loose = curve(np.linspace(KNOTS[1], KNOTS[2], 1001), values=values)
    assert np.abs(loose - values[1]).max() > 0.1


def test_continuity_breaks_the_speed():
    before, after = speeds(KNOTS[2], continuity=-1.0)
    assert np.linalg.norm(before - after) > 0.5


def test_outside_its_knots_the_curve_is_clamped():
    np.testing.assert_array_equal(curve([-3.0, 12.0]), VALUES[[0, -1]])


def test_two_knots_make_one_cubic():
    at = np.linspace(2.0, 5.0, 31)
    expected = CubicHermiteSpline([2.0, 5.0], VALUES[:2], [START, END])(at)
    np.testing.assert_allclose(curve(at, np.array([2.0, 5.0]), VALUES[:2]), expected, atol=1e-14)


@st.composite
def curves(draw):
    count = draw(st.integers(2, 7))
    gaps = draw(st.lists(st.floats(0.1, 50.0), min_size=count - 1, max_size=count - 1))
    numbers = st.floats(-1e3, 1e3)
    values = draw(nps.arrays(np.float64, (count, 2), elements=numbers))
    ends = draw(nps.arrays(np.float64, (2, 2), elements=st.floats(-10.0, 10.0)))
    tension, continuity, bias = draw(nps.arrays(np.float64, (3, count), elements=st.floats(-1.0, 1.0)))
    shape = {"tension": tension, "continuity": continuity, "bias": bias, "start": ends[0], "end": ends[1]}
    return np.concatenate(([0.0], np.cumsum(gaps))), values, shape


@given(curves())
def test_any_curve_passes_through_its_knots_is_finite_and_does_not_jump(drawn):
    knots, values, shape = drawn
    np.testing.assert_array_equal(curve(knots, knots, values, **shape), values)
    assert np.isfinite(curve(np.linspace(knots[0], knots[-1], 200), knots, values, **shape)).all()
    # A tangent is at most 16 x the longest step over the shortest gap, so a billionth of a gap moves it little.
    tiny = 1e-9
    near = curve(np.concatenate((knots - tiny, knots + tiny)), knots, values, **shape)
    assert np.abs(near - np.tile(values, (2, 1))).max() < 1e-2
