"""The three curves against scipy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from motionedit.core.compiled import compiled
from motionedit.core.timeline.interpolation import low_pass, monotone_cubic, natural_spline, spline_weights


@pytest.mark.parametrize("count", [2, 3, 7])
def test_the_monotone_cubic_is_scipys_pchip(count):
    rng = np.random.default_rng(count)
    x, y = np.cumsum(rng.uniform(0.1, 5.0, count)), rng.normal(size=count)
    at = np.linspace(x[0], x[-1], 101)
    np.testing.assert_allclose(monotone_cubic(x, y, at), PchipInterpolator(x, y)(at), atol=1e-12)


def test_the_monotone_cubic_never_turns_back_and_is_clamped_outside():
    x, y = np.array([0.0, 90.0, 100.0, 300.0]), np.array([0.0, 10.0, 60.0, 61.0])
    curve = monotone_cubic(x, y, np.linspace(-50.0, 350.0, 2000))
    assert np.all(np.diff(curve) >= 0.0)
    assert curve[0] == 0.0
    assert curve[-1] == 61.0


def test_the_low_pass_smooths_the_ends_as_it_does_the_rest():
    rows = np.random.default_rng(5).normal(size=(400, 40))
    smooth = low_pass(rows, sigma=4.0)
    inside = np.sqrt(np.mean(smooth[100:300] ** 2))
    assert np.sqrt(np.mean(smooth[[0, -1]] ** 2)) < 2.5 * inside
    assert inside < 0.3


@pytest.mark.parametrize("frames", [1, 2, 3, 4, 50])
def test_the_natural_spline_is_scipys(frames):
    rows = np.random.default_rng(frames).normal(size=(frames, 4, 2))
    at = np.linspace(-1.0, frames, 77)
    if frames == 1:
        expected = np.repeat(rows, len(at), axis=0)
    else:
        clamped = np.clip(at, 0, frames - 1)
        expected = CubicSpline(np.arange(frames), rows, bc_type="natural")(clamped)
    np.testing.assert_allclose(natural_spline(rows, at), expected, atol=1e-12)


def test_the_natural_spline_passes_through_its_rows():
    rows = np.random.default_rng(3).normal(size=(20, 3))
    np.testing.assert_allclose(natural_spline(rows, np.arange(20.0)), rows, atol=1e-14)


@pytest.mark.compiled
@pytest.mark.parametrize("shape", [(3,), (4, 2), (50, 3, 2)])
def test_the_compiled_spline_is_that_of_numpy_to_the_bit(shape, monkeypatch):
    rng = np.random.default_rng(5)
    rows, at = rng.normal(size=shape), rng.uniform(-1.0, shape[0], 20)
    found = natural_spline(rows, at)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(found, natural_spline(rows, at))


@pytest.mark.compiled
def test_rows_that_do_not_fit_are_an_error_and_no_crash():
    with pytest.raises(ValueError, match="rows"):
        compiled().second_derivatives(np.zeros(5), 2, 3)
    with pytest.raises(ValueError, match="no such rows"):
        compiled().second_derivatives(np.zeros(6), -2, -3)


@pytest.mark.parametrize("sigma", [0.0, 4.0])
@pytest.mark.parametrize(
    ("frames", "at"), [(1, 0.0), (2, 0.3), (40, 39.0), (300, 0.4), (300, 150.6), (300, 298.9), (300, 400.0)]
)
def test_the_weights_at_a_place_make_what_the_smoothed_spline_has_there(frames, at, sigma):
    rows = np.random.default_rng(frames).normal(size=(frames, 3))
    first, weights = spline_weights(frames, at, sigma=sigma)
    expected = natural_spline(low_pass(rows, sigma=sigma), np.array([at]))[0]
    np.testing.assert_allclose(weights @ rows[first : first + len(weights)], expected, atol=1e-13)
    assert len(weights) < 100


def test_the_low_pass_is_scipys_gaussian_inside_and_leaves_a_line_alone():
    rows = np.random.default_rng(4).normal(size=(60, 3))
    inside = slice(6, -6)
    expected = gaussian_filter1d(rows, 2.0, axis=0, radius=6)
    np.testing.assert_allclose(low_pass(rows, sigma=2.0)[inside], expected[inside], atol=1e-12)
    line = np.linspace(3.0, 9.0, 30)[:, None]
    np.testing.assert_allclose(low_pass(line, sigma=2.5), line, atol=1e-12)


@pytest.mark.parametrize("frames", [1, 2, 4])
def test_the_low_pass_takes_clips_shorter_than_its_kernel(frames):
    rows = np.ones((frames, 2))
    np.testing.assert_allclose(low_pass(rows, sigma=3.0), rows, atol=1e-12)


@pytest.mark.parametrize("sigma", [0.0, 1e-300, 1e-9, 0.02, 0.1])
def test_a_low_pass_narrower_than_a_frame_changes_nothing(sigma):
    rows = np.random.default_rng(3).normal(size=(9, 2))
    np.testing.assert_array_equal(low_pass(rows, sigma=sigma), rows)
