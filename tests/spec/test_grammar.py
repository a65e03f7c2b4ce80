"""What a spec's parser takes, its JSON Schema takes, and nothing else: both come from one grammar."""

import re
import sys
from functools import partial

import jsonschema
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motionedit.spec import grammar, kinds
from motionedit.spec.faults import FaultyValueError
from motionedit.spec.model import Context
from motionedit.spec.yaml_tree import scalar

LETTERS = st.text(st.characters(categories=["L", "N"]), min_size=1, max_size=3)
WORDS = st.one_of(st.sampled_from(["hit", "hit2", "_", "é", "目", "mean", "e5", "s"]), LETTERS)
BLANKS = st.text(st.sampled_from(" \t\n\x1c\x85\xa0\u2003\u3000\ufeff"), max_size=2)
AMOUNTS = st.from_regex(grammar.AMOUNT, fullmatch=True, alphabet="0123456789.eE+-")
PIECES = st.one_of(WORDS, BLANKS, AMOUNTS, st.sampled_from(["-", "+", "s", "%", ".", "5", "1e999", "²", "€", "😀"]))
# Texts of the grammar's own pieces, in an order that may be right; and any text.
TEXTS = st.one_of(st.lists(PIECES, max_size=8).map("".join), st.text(max_size=8))
NUMBERS = st.one_of(st.integers(-3, 10**20), st.floats(allow_nan=False), st.booleans(), st.none())
# What a value's size is refused for, which a pattern cannot see.
SIZES = ("must be a whole frame", "must be a finite", "must be from 0% to 100%", "must be whole frames")


def both(kind, value):
    """Return whether the parser reads a value, and whether the schema takes it."""
    valid = jsonschema.Draft202012Validator(kind.json).is_valid(value)
    try:
        kind.parse(value, Context())
    except FaultyValueError as error:
        return str(error).startswith(SIZES), valid
    return True, valid


@given(st.one_of(TEXTS, NUMBERS))
@example("hit-")
@example("hit - 10")
@example("hit-10")
@example("hit--10")
@example("hit + 1.5s")
@example("hit + 5%")
@example("71.2%")
@example("-0s")
@example("+5")
@example(" \u3000événement-eins\u2003+ .5e1 s\n")
@pytest.mark.parametrize("kind", [kinds.TIME, kinds.INSTANT, kinds.DURATION], ids=["time", "instant", "duration"])
def test_the_parser_and_the_schema_take_the_same_times(kind, value):
    if isinstance(value, float) and not value.is_integer():
        # A number is refused where it is no whole one, by both.
        assert both(kind, value)[1] is False
    else:
        parsed, valid = both(kind, value)
        assert parsed == valid


@given(
    event=st.from_regex(grammar.EVENT, fullmatch=True, alphabet=st.characters(categories=["L", "N", "P"])),
    sign=st.sampled_from(["+", "-", " - ", "  +\t"]),
    amount=AMOUNTS.filter(lambda text: float(text) < 1e9),
)
def test_a_time_of_every_form_is_taken_by_both(event, sign, amount):
    for text in (event, f"{event}{sign}{amount} s", f" {amount}s", f"+{amount}s "):
        assert both(kinds.TIME, text) == (True, True)


@given(TEXTS)
@example("hit-")
@example("hit-10")
@example("hit\n")
@example("mean")
def test_the_parser_and_the_schema_take_the_same_names_of_events(text):
    parsed, valid = both(kinds.EVENT_NAME, text)
    assert parsed == valid


@given(st.one_of(st.text("XYZxyz", min_size=2, max_size=4), st.text(max_size=4)))
@example("ZXY\n")
@example("XXY")
def test_the_parser_and_the_schema_take_the_same_orders(order):
    parsed, valid = both(kinds.ORIENTATION, {"euler": [1, 2, 3], "order": order})
    assert parsed == valid


@given(AMOUNTS, st.sampled_from(["", "+", "-"]))
def test_a_plain_number_is_an_amount_with_or_without_a_sign(amount, sign):
    assert float(scalar(f"{sign}{amount}")) == float(f"{sign}{amount}")


def test_every_letter_and_blank_of_python_is_one():
    characters = list(map(chr, range(sys.maxunicode + 1)))
    blank, name = (partial(re.fullmatch, pattern) for pattern in (grammar.BLANKS, grammar.EVENT))
    assert [c for c in characters if c.isspace() != bool(blank(c))] == []
    assert [c for c in characters if c.isspace() and name(f"a{c}")] == []
    assert [c for c in characters if re.match(r"\w", c) and not name(f"a{c}")] == []
    assert [c for c in characters if re.match(r"[^\W\d]", c) and not name(c)] == []
    assert not any(map(name, "0123456789"))


@pytest.mark.parametrize("pattern", [grammar.TIME, grammar.DURATION, grammar.EVENT, grammar.ORDER])
def test_no_pattern_says_what_only_python_reads_so(pattern):
    assert not re.search(r"\\[wWdDsSbBAZ]|\(\?P|\(\?[aiLmsux]", pattern)
