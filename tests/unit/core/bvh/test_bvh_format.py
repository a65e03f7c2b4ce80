"""Numbers become text of a fixed number of decimals, as the `%` operator would write them."""

import numpy as np
import pytest

from motionedit.core.bvh.format import format_fixed, place
from motionedit.core.bvh.write import joined


def texts(values, **options):
    words = format_fixed(np.array(values, dtype=float), **options)
    return [row[len(row) - length :].tobytes().decode() for row, length in zip(words.chars, words.lengths, strict=True)]


@pytest.mark.parametrize("decimals", range(1, 16))
def test_a_fraction_that_rounds_up_to_one_is_carried(decimals):
    almost = 1.0 - 0.4 * 10.0**-decimals
    zeros = "0" * decimals
    assert texts([almost, -almost, 9.0 + almost], decimals=decimals) == [f"1.{zeros}", f"-1.{zeros}", f"10.{zeros}"]


@pytest.mark.parametrize("decimals", [1, 4, 6, 7, 8, 12])
def test_values_of_every_size_stand_together(decimals):
    values = [sign * 10.0**k * 1.25 for k in range(-3, 9) for sign in (1, -1)] + [0.0]
    expected = [f"{value:.{decimals}f}" for value in values]
    for mine, theirs, value in zip(texts(values, decimals=decimals), expected, values, strict=True):
        assert float(mine) == float(theirs) or abs(float(mine) - value) <= 0.5000001 * 10.0**-decimals
        assert len(mine) == len(theirs) - (theirs.startswith("-") and float(theirs) == 0.0)


def test_what_rounds_to_zero_has_no_sign():
    assert texts([-0.0, -4e-7, -6e-7], decimals=6) == ["0.000000", "0.000000", "-0.000001"]


def test_an_ending_belongs_to_its_word():
    ends = np.frombuffer(b" \n", np.uint8)
    assert texts([1.5, -20.25], decimals=2, ends=ends) == ["1.50 ", "-20.25\n"]
    assert texts([1e20, -0.0], decimals=1, ends=ends) == ["100000000000000000000.0 ", "0.0\n"]


def test_words_are_placed_one_after_the_other():
    words = format_fixed(np.array([1.0, -200.0, 3.0]), decimals=1, ends=np.full(3, ord(" "), np.uint8))
    margin = words.chars.shape[1]
    stops = np.cumsum(words.lengths)
    out = np.zeros(margin + stops[-1], np.uint8)
    place(words.chars, stops, out=out, margin=margin)
    assert out[margin:].tobytes() == b"1.0 -200.0 3.0 "


@pytest.mark.parametrize("about", [0, 5, 9, 100, 1 << 23])
def test_pieces_are_joined_whatever_was_foretold_of_their_length(about):
    assert joined([b"one", memoryview(b"two"), b"", b"six"], about=about) == b"onetwosix"
