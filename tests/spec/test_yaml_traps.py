"""YAML read by our own rules: no surprises of YAML 1.1, and no text that takes long."""

import math
import time

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from motionedit.spec import yaml_tree
from motionedit.spec.faults import FaultyValueError
from motionedit.spec.syntax import DEEPEST
from motionedit.spec.yaml_tree import read_tree, scalar, value_from_text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *(("1e-3", 0.001), ("1.5E+3", 1500.0), (".5", 0.5), ("5.", 5.0), ("-2", -2), ("+2", 2), ("010", 10)),
        *((word, word) for word in ("0x10", "1_000", "10:20", "0b1", "0o17", "1e", "e3", "--1", "1.2.3", "-")),
        *(
            (word, word)
            for word in ("yes", "no", "on", "off", "y", "n", "True", "FALSE", "Null", ".nan", ".inf", "nan")
        ),
        *(("true", True), ("false", False), ("null", None), ("~", None), ("", None)),
        *(("2001-01-01", "2001-01-01"), ("=", "="), ("71.2%", "71.2%")),
        ("9" * 400, math.inf),
    ],
)
def test_a_plain_scalar_is_what_a_person_would_read(text, value):
    found = scalar(text)
    assert found == value
    assert type(found) is type(value)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_read_back_as_it_was_printed(number):
    assert scalar(repr(number)) == number


@given(st.integers(-(10**30), 10**30))
def test_a_whole_number_is_read_back_as_it_was_printed(number):
    assert scalar(str(number)) == number


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused_with_a_line(text):
    tree, faults = read_tree(text)
    assert tree is None or not [fault for fault in faults if fault.line is None]
    assert all("\n" not in fault.message for fault in faults)


# Without texts such as 0E0, which are numbers by our rules and not by those of the other writer.
WORD = st.text(st.characters(codec="utf-8"), max_size=5).filter(lambda text: not isinstance(scalar(text), float))
LEAF = st.one_of(st.none(), st.booleans(), st.integers(-99, 99), WORD)
TREE = st.recursive(
    LEAF,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.from_regex(r"[a-z]{1,4}", fullmatch=True), inner)
    ),
    max_leaves=12,
)


@given(TREE)
def test_what_another_writer_writes_is_read_the_same(value):
    text = yaml.safe_dump(value)
    # Quotes protect what YAML 1.1 would misread, so both readers agree on such texts.
    assert value_from_text(text) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("'10'", "10"),
        ('"true"', "true"),
        ("!!str 10", "10"),
        ("!!int 010", 10),
        ("!!float 3", 3.0),
        ("! 10", "10"),
        ("{001: a, true: b, 1e3: c}", {"001": "a", "true": "b", "1e3": "c"}),
        ("|\n  two\n  lines", "two\nlines"),
        ("{a: &x [1, 2], b: *x}", {"a": [1, 2], "b": [1, 2]}),
        ("{a: &x 3, b: *x, &k c: 1, *k : 2}", None),
        ("{base: &b {x: 1, y: 2}, c: {<<: *b, y: 3}}", {"base": {"x": 1, "y": 2}, "c": {"x": 1, "y": 3}}),
        (
            "{base: &b {x: 1}, d: &d {y: 2}, c: {<<: [*b, *d]}}",
            {"base": {"x": 1}, "d": {"y": 2}, "c": {"x": 1, "y": 2}},
        ),
        ("{'<<': 3}", {"<<": 3}),
        ("a:\r\n  - 1\r\n  - 2\r\n", {"a": [1, 2]}),
    ],
)
def test_quotes_tags_anchors_and_merges_work(text, value):
    if value is None:
        with pytest.raises(FaultyValueError, match="given twice"):
            value_from_text(text)
    else:
        assert value_from_text(text) == value


def test_a_copy_of_an_anchor_is_a_copy():
    data = value_from_text("{a: &x [1, 2], b: *x}")
    data["a"].append(3)
    assert data["b"] == [1, 2]


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 30)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, "more than 200000 values"),
        ("a: " + "[" * 100_000, "nested more than 50 deep"),
        ("a: " + "{a: " * 100_000, "nested more than 50 deep"),
        ("".join(" " * n + "a:\n" for n in range(2000)), "nested more than 50 deep"),
        ("- " * 5000, "nested more than 50 deep"),
        ("a: &a [*a]", "*a stands inside itself"),
        ("a: &a {b: {c: *a}}", "*a stands inside itself"),
        ("a: &a " + "[" * 45 + "]" * 45 + "\nb: " + "[" * 20 + "*a" + "]" * 20, "nested more than 50 deep"),
        ("x: [" + "1, " * 300_000 + "]", "more than 200000 values"),
    ],
    ids=["bomb", "lists", "mappings", "block", "dashes", "itself", "itself below", "alias too deep", "long list"],
)
def test_a_hostile_text_is_refused_quickly(text, message):
    began = time.process_time()
    tree, faults = read_tree(text)
    assert time.process_time() - began < 5.0
    assert tree is None
    assert faults[-1].message == message
    assert faults[-1].line is not None


def test_the_deepest_tree_that_is_read_can_be_used():
    text = "[" * DEEPEST + "]" * DEEPEST
    assert value_from_text(text) is not None


SYNTAX = [
    ("a:\n\tb: 1", 2, "not valid YAML: a tab; indent with blanks"),
    ("a: [1, 2\nb: 3", 2, "not valid YAML: a list that is not closed; put ] at its end (opened on line 1)"),
    (
        "a: {b: 1\nc: 2",
        2,
        "not valid YAML: a mapping in braces that is not closed; put } at its end (opened on line 1)",
    ),
    ("a: b: c", 1, "not valid YAML: a second ': ' on the line, or a wrong indentation; quote a text that holds ': '"),
    (
        "a: 1\n  b: 2",
        2,
        "not valid YAML: a second ': ' on the line, or a wrong indentation; quote a text that holds ': '",
    ),
    ("a: [{b: 1 c: 2}]", 1, "not valid YAML: a comma that is missing before a key in braces"),
    ("a: 'x\nb: 2\n", 2, "not valid YAML: a quote that is not closed (opened on line 1)"),
    ("a: @x", 1, "not valid YAML: a character that cannot begin a value; put quotes around the text"),
    ("a: ]", 1, "not valid YAML: a value that is not there"),
    ('a: "\\q"', 1, "not valid YAML: an unknown escape in double quotes; use single quotes"),
    ("- 1\na: 2", 2, "not valid YAML: a line that does not fit the lines above; indent it as the lines it belongs to"),
    ("a: *x", 1, "no anchor &x above"),
    ("a: !foo 1", 1, "the tag '!foo' is not supported"),
    ("a: !!python/object:os.system 1", 1, "the tag '!!python/object:os.system' is not supported"),
    ("a: !!set {b, c}", 1, "the tag '!!set' is not supported"),
    ("a: !!int x", 1, "'x' is not what its tag says"),
    ("? [1]\n: 2", 1, "a key must be a word, not a list or mapping"),
    ("?\n: 2", 1, "a key is missing before the ':'"),
    ("a: 1\n---\nb: 2", 2, "a second document begins here; a spec is one document"),
    ("a: {<<: 3}", 1, "<< needs a mapping, such as *anchor"),
]


@pytest.mark.parametrize(("text", "line", "message"), SYNTAX)
@pytest.mark.parametrize("loader", ["libyaml", "plain"])
def test_what_is_no_yaml_is_said_in_plain_words_by_both_parsers(text, line, message, loader, monkeypatch):
    if loader == "plain":
        monkeypatch.setattr(yaml_tree, "_events", lambda text: yaml.parse(text, Loader=yaml.Loader))
    tree, faults = read_tree(text)
    assert tree is None
    assert [(fault.line, fault.message) for fault in faults] == [(line, message)]


def test_lines_are_those_of_the_keys():
    tree, _ = read_tree("a: 1\n# a remark\nb:\n  - c: [1,\n        2]\n    d: 4\n")
    assert tree.key_lines == {"a": 1, "b": 3}
    item = tree.child("b").child(0)
    assert (item.line, item.key_lines) == (4, {"c": 4, "d": 6})
    assert item.child("c").child(1).line == 5
    assert item.child("c").child(2) is None
    assert item.child("d").child("e") is None
