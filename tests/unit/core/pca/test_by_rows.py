"""Products by blocks of rows are the products, with the same bits from any number of threads."""

import numpy as np
import pytest

from motionedit.core.pca.by_rows import lower_gram, make_unit, multiply_lower, product
from motionedit.core.pca.fit import ComponentCount, _lower_inverse, fit_centred

RNG = np.random.default_rng(5)
A, B = RNG.normal(size=(700, 300)), RNG.normal(size=(300, 90))


def multiplied(lower, rows, *, threads):
    product = rows.copy()
    multiply_lower(lower, product, threads=threads)
    return product


@pytest.mark.parametrize("rows", [1, 255, 256, 257, 700])
def test_products_are_those_of_the_whole_matrices(rows):
    some = A[:rows]
    assert product(some, B, threads=1) == pytest.approx(some @ B, abs=1e-12)
    gram = some @ some.T
    assert np.tril(lower_gram(some, threads=1)) == pytest.approx(np.tril(gram), abs=1e-12)
    lower = np.tril(gram)
    assert multiplied(lower, some, threads=1) == pytest.approx(lower @ some, abs=1e-9)


@pytest.mark.parametrize("threads", [2, 3, 8])
def test_any_number_of_threads_gives_the_same_bits(threads):
    lower = np.tril(A @ A.T)
    assert np.array_equal(product(A, B, threads=threads), product(A, B, threads=1))
    assert np.array_equal(lower_gram(A, threads=threads), lower_gram(A, threads=1))
    wide = np.tile(A, (1, 7))  # more columns than are multiplied at a time
    assert np.array_equal(multiplied(lower, wide, threads=threads), multiplied(lower, wide, threads=1))


@pytest.mark.parametrize("threads", [1, 2])
def test_rows_are_made_as_long_as_one(threads):
    rows = A.copy()
    make_unit(rows, threads=threads)
    assert rows == pytest.approx(A / np.linalg.norm(A, axis=1, keepdims=True), abs=1e-15)


@pytest.mark.parametrize("rows", [1, 64, 65, 300])
def test_a_lower_matrix_is_inverted_by_halves(rows):
    lower = np.tril(RNG.normal(size=(rows, rows))) * 0.01 + np.eye(rows)
    inverse = _lower_inverse(lower)
    assert inverse @ lower == pytest.approx(np.eye(rows), abs=1e-13)
    assert not np.triu(inverse, 1).any()


def test_a_fit_in_threads_is_the_fit():
    X = A - A.mean(axis=0)
    one, two = (fit_centred(X, A.mean(axis=0), count=ComponentCount(20), threads=threads) for threads in (1, 2))
    assert np.array_equal(one.components, two.components)
    assert np.array_equal(one.coefficients, two.coefficients)
    assert one.components @ one.components.T == pytest.approx(np.eye(20), abs=1e-12)


def test_what_goes_wrong_in_a_thread_is_raised():
    with pytest.raises(ValueError, match="mismatch"):
        product(A, B[:10], threads=2)
