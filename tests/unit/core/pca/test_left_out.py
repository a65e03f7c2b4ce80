"""What leaving each motion out of its database tells, against doing it."""

import numpy as np
import pytest

from motionedit.core.pca.fit import ALL, ComponentCount, fit_centred
from motionedit.core.pca.left_out import left_out_of_components


def brute(X, count=None):
    """Return (residuals, deviations) of each row of X, looked for by the components of the others."""
    pairs = []
    for i in range(len(X)):
        others = np.delete(X, i, axis=0)
        off = X[i] - others.mean(axis=0)
        rows = np.linalg.svd(others - others.mean(axis=0), full_matrices=False)[2][: count or len(others) - 1]
        left = off - rows.T @ (rows @ off)
        pairs.append((left @ left, off @ off))
    return np.array(pairs).T


def fitted(X, count=ALL):
    mean = X.mean(axis=0)
    return fit_centred(X - mean, mean, count=count)


@pytest.mark.parametrize("count", [ALL, ComponentCount(count=2), ComponentCount(share=0.8)])
@pytest.mark.parametrize("motions", [2, 3, 7])
def test_the_closed_form_is_what_leaving_out_comes_to_however_many_components_are_kept(motions, count):
    if count.count == 2 and motions == 2:
        pytest.skip("two motions have one component")
    X = np.random.default_rng(motions).normal(size=(motions, 40)) * np.linspace(3.0, 0.1, 40)
    found = fitted(X, count).left_out
    residuals, deviations = brute(X)
    np.testing.assert_allclose(found.residuals, residuals, rtol=1e-9)
    np.testing.assert_allclose(found.deviations, deviations, rtol=1e-9)
    assert found.share == pytest.approx(residuals.sum() / deviations.sum())
    assert found.furthest == np.argmax(residuals)


def test_two_motions_say_nothing_of_each_other():
    assert fitted(np.random.default_rng(1).normal(size=(2, 9))).left_out.share == pytest.approx(1.0)


def test_a_combination_of_others_is_explained():
    X = np.random.default_rng(2).normal(size=(4, 30))
    X = np.vstack((X, X.mean(axis=0), X[0]))
    shares = fitted(X).left_out.shares
    np.testing.assert_allclose(shares[[0, 4, 5]], 0.0, atol=1e-6)


def test_from_the_first_components_of_many_motions_it_is_nearly_the_same():
    rng = np.random.default_rng(3)
    X = rng.normal(size=(120, 60)) * np.concatenate((np.full(8, 8.0), np.full(52, 0.5)))
    X -= X.mean(axis=0)
    _, s, rows = np.linalg.svd(X, full_matrices=False)
    found = left_out_of_components(X @ rows[:8].T, s[:8] ** 2 / (len(X) - 1), np.sum(X**2, axis=1))
    residuals, deviations = brute(X, 8)
    assert found.share == pytest.approx(residuals.sum() / deviations.sum(), rel=0.05)
