"""Every fault of a spec and the line that answers it, byte for byte."""

import re
from pathlib import Path

import pytest

BLOCK = re.compile(r"^## (.+)\n\[(.+)\]\n((?:.*\n)*?)->\n((?:.+\n)+)", re.MULTILINE)
FAULTS = {
    name: (command, text, answer.splitlines())
    for name, command, text, answer in BLOCK.findall(Path(__file__).with_name("faults.txt").read_text(encoding="utf-8"))
}


@pytest.mark.parametrize(("command", "text", "expected"), FAULTS.values(), ids=FAULTS)
def test_a_fault_is_answered_with_its_line(command, text, expected, messages):
    assert messages(text, command) == expected


def test_the_table_of_faults_is_read_whole():
    text = Path(__file__).with_name("faults.txt").read_text(encoding="utf-8")
    assert len(FAULTS) == text.count("\n## ") == text.count("\n->\n")


GOAL_KEYS = (
    "name, effector, at, position, shift, orientation, turn, frame, relative_to, axes, weight, priority, tolerance"
)

BEGIN = "a spec begins with schema: motionedit/edit-pc/v1"
FIRST = "the first line is schema: motionedit/edit-pc/v1"

# Whole files: command, text, answer.
FILES = {
    "empty": (b"", [f"spec.yaml: is empty; {BEGIN}"]),
    "remarks alone": (b"# nothing\n", [f"spec.yaml: is empty; {BEGIN}"]),
    "a clip": (b"\nHIERARCHY\nROOT Hips\n{\n", [f"spec.yaml: is a BVH clip; {BEGIN}"]),
    "one word": (b"\n\nhello", [f"spec.yaml:3: is not a mapping of keys; {BEGIN}"]),
    "a list": (b"- 1", [f"spec.yaml:1: is not a mapping of keys; {BEGIN}"]),
    "no schema": (b"goals: []", [f"spec.yaml:1: schema: is missing; {FIRST}"]),
    "no schema, and more": (
        b"# x\ngoals: []\nunti: cm",
        [
            f"spec.yaml:2: schema: is missing; {FIRST}",
            "spec.yaml:3: unti: unknown key; did you mean 'unit'?",
        ],
    ),
    "another command's": (
        b"schema: motionedit/fit-pca/v1\ncomponents: x",
        ["spec.yaml:1: schema: this is a spec of fit-pca; edit-pc wants motionedit/edit-pc/v1"],
    ),
    "another version": (
        b"schema: motionedit/edit-pc/v2\ngoals: []",
        ["spec.yaml:1: schema: must be motionedit/edit-pc/v1, not 'motionedit/edit-pc/v2'"],
    ),
    "another schema": (b"goals: []\nschema: 3", ["spec.yaml:2: schema: must be motionedit/edit-pc/v1, not 3"]),
    "no schema's value": (b"goals: []\nschema:", ["spec.yaml:2: schema: needs a value: motionedit/edit-pc/v1"]),
    "not UTF-8": (
        b"schema: motionedit/edit-pc/v1\ngoals: []\n# \xe9",
        ["spec.yaml:3: not UTF-8 text; save it as UTF-8"],
    ),
    "UTF-16": ("schema: x".encode("utf-16"), ["spec.yaml:1: UTF-16 text; save it as UTF-8"]),
    "binary": (b"\x7fELF\x00\x01", ["spec.yaml: a binary file, not text"]),
    "control character": (b"goals: []\n# \x07", ["spec.yaml:2: the control character U+0007 in the text; remove it"]),
    "tab": (
        b"schema: motionedit/edit-pc/v1\ngoals:\n\t- {}",
        ["spec.yaml:3: not valid YAML: a tab; indent with blanks"],
    ),
    "too large": (b"#" * 5_000_000, ["spec.yaml: larger than 4 MB; is it the right file?"]),
    "syntax after a duplicate": (
        b"a: 1\na: 2\nb: [",
        [
            "spec.yaml:2: a: given twice, on lines 1 and 2; keep one",
            "spec.yaml:3: not valid YAML: a value that is not there",
        ],
    ),
}


@pytest.mark.parametrize(("text", "expected"), FILES.values(), ids=FILES)
def test_a_file_that_is_no_spec_is_answered_with_the_reason(text, expected, messages):
    assert messages(text, head=False) == expected


def test_a_byte_order_mark_and_other_line_ends_are_no_fault(load):
    text = b"\xef\xbb\xbfschema: motionedit/edit-pc/v1\r\ngoals: []\r\n"
    assert load(text, head=False).model.goals == ()


def test_all_faults_of_a_file_come_together_sorted_by_line(messages):
    text = """
        timing: slow
        goals:
          - {at: -3, effector: A, shift: [0, 0, 1], weight: 0}
          - name: a
            at: 94
            effector: {joint: A, offset: [1, 2]}
            shift: [0, 0, 1]
            shift: [0, 0, 2]
            colour: red
        components: 0
    """
    assert messages(text) == [
        "spec.yaml:3: timing: must be original or normalized, not 'slow'",
        "spec.yaml:5: goals.0.at: must not be negative: frames count from 0; not -3",
        "spec.yaml:5: goals.0.weight: must be larger than 0, not 0",
        "spec.yaml:8: goals.1.effector.offset: must be three numbers [x, y, z], not [1, 2]",
        "spec.yaml:10: goals.1.shift: given twice, on lines 9 and 10; keep one",
        f"spec.yaml:11: goals.1.colour: unknown key; the keys here are {GOAL_KEYS}",
        "spec.yaml:12: components: must be at least 1, not 0",
    ]


def test_no_message_speaks_of_the_program(messages):
    for command, text, _ in FAULTS.values():
        for line in messages(text, command):
            lowered = line.lower()
            for word in ("validat", "input", "str ", "dict", "none", "tuple", "literal", "union"):
                # The contract's own words: the input clip, and texts under test.
                if word == "input" and "rides the input" in lowered:
                    continue
                if word == "none" and "'none'" in lowered:
                    continue
                assert word not in lowered, line
