"""The compiled text of BVH rows: numbers as `float` reads them, and the same bytes as numpy's writers."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motionedit.core.bvh.format import format_fixed
from motionedit.core.bvh.scan import decimals, number
from motionedit.core.bvh.write import LONGEST_WHOLE
from motionedit.core.compiled import compiled, solver_name

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")

words = st.one_of(
    st.floats(-1e6, 1e6).map(repr),
    st.floats(-400.0, 400.0).map(lambda x: f"{x:.6f}"),
    st.floats(allow_nan=False, allow_infinity=False).map(lambda x: f"{x:e}"),
    st.integers(-(10**17), 10**17).map(str),
    st.text("0123456789.+-eEnaifx_", min_size=1, max_size=7),
)
blanks = st.sampled_from([" ", "  ", "\t", " \v ", "\f"])
endings = st.sampled_from(["\n", "\r\n", "\r", " \n\n", "\n \n"])


def read(text, columns):
    """Return the rows, their values and places that the compiled reader finds, or None."""
    room = len(text) // columns + 1
    values, (starts, stops) = np.empty((room, columns)), np.empty((2, room), np.int64)
    found = compiled().rows_from_text(text, columns, values, starts, stops)
    return None if found is None else (*found, values[: found[0]], starts[: found[0]], stops[: found[0]])


@given(st.lists(st.lists(words, min_size=2, max_size=2), max_size=12), blanks, endings)
@settings(max_examples=300)
def test_rows_are_read_as_float_reads_their_words_or_left_alone(rows, blank, ending):
    text = "".join(blank.join(row) + ending for row in rows).encode()
    found, tokens = read(text, 2), [word.encode() for row in rows for word in row]
    if any(number(word) is None for word in tokens):
        assert found is None
        return
    count, most, values, starts, stops = found
    assert (count, most) == (len(rows), max(map(decimals, tokens), default=0))
    exact = np.array([float(word) for word in tokens]).reshape(-1, 2)
    np.testing.assert_array_equal(values, exact)
    np.testing.assert_array_equal(np.signbit(values), np.signbit(exact))
    assert [text[a:b] for a, b in zip(starts, stops, strict=True)] == [blank.join(row).encode() for row in rows]


# As most files have them, and what is nearly so: such rows are read some dozens of bytes at a time.
plain = st.tuples(st.floats(-9999.0, 9999.0), st.integers(1, 8)).map(lambda pair: f"{pair[0]:.{pair[1]}f}")
nearly_plain = st.sampled_from(
    ["-0.000000", "0", "-.5", "7.", "+1.5", "1.5e3", "12345.125", "0.123456789", "1" * 20, " 2"]
)
odd = st.sampled_from(["-", ".", "1.2.3", "--1.0", "1-2.0", "1.0x", "\x80.5"])


@given(st.lists(st.one_of(plain, plain, plain, nearly_plain), min_size=40, max_size=40), st.one_of(plain, odd))
@settings(max_examples=300)
def test_long_rows_are_read_as_float_reads_them_wherever_a_word_is_another(tokens, last):
    row = [*tokens[:20], last, *tokens[20:]]
    text = (" ".join(row) + "\n").encode("latin-1") * 3
    found = read(text, len(row))
    if number(last.encode("latin-1")) is None:
        assert found is None
        return
    count, most, values, starts, stops = found
    assert (count, most) == (3, max(decimals(word.strip().encode()) for word in row))
    exact = np.array([[float(word) for word in row]] * 3)
    np.testing.assert_array_equal(values, exact)
    np.testing.assert_array_equal(np.signbit(values), np.signbit(exact))
    assert [text[a:b].decode() for a, b in zip(starts, stops, strict=True)] == [" ".join(row).strip()] * 3


@pytest.mark.parametrize(
    "text", [b"1 2 3\n", b"1\n2\n", b"1 2\n3\n", b"1 2\n3 4 5\n", b"1 2\0\n", b"1 2\x1a", b"1 2,\n"]
)
def test_rows_of_another_length_and_other_characters_are_left_alone(text):
    assert read(text, 2) is None


def test_no_more_rows_are_read_than_there_is_room_for():
    values, (starts, stops) = np.empty((1, 1)), np.empty((2, 1), np.int64)
    assert compiled().rows_from_text(b"1\n", 1, values, starts, stops) == (1, 0)
    assert compiled().rows_from_text(b"1\n2\n", 1, values, starts, stops) is None
    with pytest.raises(ValueError, match="values has"):
        compiled().rows_from_text(b"1\n", 2, values, starts, stops)


def by_numpy(values, places):
    text = format_fixed(values, decimals=places)
    width = text.chars.shape[1]
    return [row[width - length :].tobytes() for row, length in zip(text.chars, text.lengths, strict=True)]


carried = st.sampled_from([999.9999996, 998.9999996, -99.9999996, 9.9999996, -0.9999996, -4e-7, 4e-7, -0.0, 999.0])
kinds = st.floats(-1e14, 1e14), st.floats(-1001.0, 1001.0), st.floats(-2.0, 2.0), st.integers(-9, 9).map(float), carried
numbers = st.lists(st.one_of(*kinds), min_size=1)


@given(numbers, st.integers(1, 17))
@settings(max_examples=300)
def test_numbers_are_written_as_numpy_writes_them(values, places):
    out = np.empty(len(values) * (places + LONGEST_WHOLE) + 2 * len(values), np.uint8)
    values = np.array(values)
    length = compiled().rows_to_text(values, 1, places, b"\r\n", out)
    assert out[:length].tobytes() == b"".join(word + b"\r\n" for word in by_numpy(values, places))


@given(numbers, st.lists(st.booleans(), min_size=1), st.integers(1, 17), blanks)
def test_words_are_replaced_where_they_are_touched(values, touched, places, blank):
    count = min(len(values), len(touched))
    values, cells = np.array(values[:count]), np.array(touched[:count])
    old = [b"1.25" for _ in range(count)]
    text = blank.encode().join(old) + b"\n"
    out = np.empty(len(text) + count * (places + LONGEST_WHOLE), np.uint8)
    length = compiled().splice(text, cells, values, places, out)
    new = [mine if touched else word for mine, word, touched in zip(by_numpy(values, places), old, cells, strict=True)]
    assert out[:length].tobytes() == blank.encode().join(new) + b"\n"
    assert compiled().splice(text + b" 1", cells, values, places, np.empty(len(out) + 2, np.uint8)) == -1


@given(st.lists(st.sampled_from([" ", "\n", "\t", "\r", "  "]), min_size=1, max_size=600), st.integers(-1, 1))
def test_gaps_are_plain_where_they_are_single_blanks_and_line_feeds(gaps, more):
    text = "".join(f"{n}{gap}" for n, gap in enumerate(gaps))
    found = [blank for gap in gaps for blank in gap]
    plain = len(found) == len(gaps) + more and set(found) <= {" ", "\n"}
    assert compiled().plain_gaps(text.encode(), len(gaps) + more) is plain


@pytest.mark.parametrize("large", [1e15, -1e300, np.inf, np.nan])
def test_a_number_that_is_too_large_is_left_to_others(large):
    out = np.empty(6 + LONGEST_WHOLE + 1, np.uint8)
    assert compiled().rows_to_text(np.array([large]), 1, 6, b"\n", out) == -1


def test_wrong_sizes_are_errors_and_no_crash():
    with pytest.raises(ValueError, match=re.escape("no such rows")):
        compiled().rows_to_text(np.zeros(3), 2, 6, b"\n", np.empty(99, np.uint8))
    with pytest.raises(ValueError, match="decimals"):
        compiled().splice(b"1", np.ones(1, bool), np.zeros(1), 0, np.empty(99, np.uint8))
    with pytest.raises(ValueError, match="text has"):
        compiled().splice(b"1", np.ones(1, bool), np.zeros(1), 6, np.empty(9, np.uint8))
