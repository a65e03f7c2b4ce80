"""Products by blocks of rows are the products, with the same bits from any number of threads."""

import numpy as np
import pytest

from motionedit.core.pca.by_rows import lower_gram, lower_product, make_unit, product
from motionedit.core.pca.fit import ComponentCount, fit_centred

RNG = np.random.default_rng(5)
A, B = RNG.normal(size=(700, 300)), RNG.normal(size=(300, 90))


@pytest.mark.parametrize("rows", [1, 255, 256, 257, 700])
def test_products_are_those_of_the_whole_matrices(rows):
    some = A[:rows]
    assert product(some, B, threads=1) == pytest.approx(some @ B, abs=1e-12)
    gram = some @ some.T
    assert np.tril(lower_gram(some, threads=1)) == pytest.approx(np.tril(gram), abs=1e-12)
    lower = np.tril(gram)
    assert lower_product(lower, some, threads=1) == pytest.approx(lower @ some, abs=1e-9)


@pytest.mark.parametrize("threads", [2, 3, 8])
def test_any_number_of_threads_gives_the_same_bits(threads):
    lower = np.tril(A @ A.T)
    assert np.array_equal(product(A, B, threads=threads), product(A, B, threads=1))
    assert np.array_equal(lower_gram(A, threads=threads), lower_gram(A, threads=1))
    assert np.array_equal(lower_product(lower, A, threads=threads), lower_product(lower, A, threads=1))


@pytest.mark.parametrize("threads", [1, 2])
def test_rows_are_made_as_long_as_one(threads):
    rows = A.copy()
    make_unit(rows, threads=threads)
    assert np.array_equal(rows, A / np.linalg.norm(A, axis=1, keepdims=True))


def test_a_fit_in_threads_is_the_fit():
    X = A - A.mean(axis=0)
    one, two = (fit_centred(X, A.mean(axis=0), count=ComponentCount(20), threads=threads) for threads in (1, 2))
    assert np.array_equal(one.components, two.components)
    assert np.array_equal(one.coefficients, two.coefficients)
    assert one.components @ one.components.T == pytest.approx(np.eye(20), abs=1e-12)


def test_what_goes_wrong_in_a_thread_is_raised():
    with pytest.raises(ValueError, match="mismatch"):
        product(A, B[:10], threads=2)
