"""Outputs that pages show are compared with what commands print, and put right."""

import pytest
import sessions

PAGE = """\
Before.

```console
$ motionedit --version
{shown}
```

After.
"""


def page(shown):
    return PAGE.format(shown=shown)


def test_commands_are_those_of_console_blocks():
    text = "```sh\n$ no\n```\n```console\n$ one\na\nb\n$ two\n```\n"
    assert [(c.text, c.shown) for c in sessions.commands_of(text)] == [("one", ["a", "b"]), ("two", [])]


def test_a_page_that_is_right_stays_as_it_is(tmp_path):
    right = sessions.refreshed(page("wrong"), tmp_path)
    assert "wrong" not in right
    assert "motionedit 0." in right
    assert right.startswith("Before.")
    assert right.endswith("After.\n")
    assert sessions.refreshed(right, tmp_path) == right


def test_a_command_that_fails_must_show_its_exit_code(tmp_path):
    failing = page("").replace("--version", "info nope.bvh")
    with pytest.raises(RuntimeError, match=r"exit code 2: motionedit info nope\.bvh"):
        sessions.refreshed(failing, tmp_path)
    shown = sessions.refreshed(failing.replace("\n\n```\n\nAfter", "\n$ echo $?\n```\n\nAfter"), tmp_path)
    assert "nope.bvh: no such file or folder\n$ echo $?\n2\n```" in shown


def test_other_programs_are_refused(tmp_path):
    with pytest.raises(RuntimeError, match=r"not: rm -r \."):
        sessions.run("rm -r .", tmp_path)


def test_files_of_the_page_are_there_for_its_commands(tmp_path):
    text = "```yaml\n# file: a.yaml\nb: 1\n```\n```console\n$ cat a.yaml\n```\n"
    assert "$ cat a.yaml\n# file: a.yaml\nb: 1\n```" in sessions.refreshed(text, tmp_path)


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("a 1.000 x", "a 1.001 x", True),
        ("a 1.0 x", "a 1.1 x", False),
        ("error 5e-06", "error 7e-06", True),
        ("frame 92", "frame 93", False),
        ("a 1.0 x", "b 1.0 x", False),
        ("ok   4    0.03", "ok   4    1.27", True),
        ("ok   4    0.03", "ok   5    0.03", False),
    ],
)
def test_numbers_may_differ_by_rounding_and_seconds_by_anything(shown, printed, same):
    assert sessions.same([shown], [printed]) is same


@pytest.mark.parametrize(
    ("shown", "same"),
    [
        (["a", "...", "d"], True),
        (["...", "d"], True),
        (["a", "..."], True),
        (["a", "...", "c"], False),
        (["a", "b"], False),
        (["a", "b", "c", "d"], True),
        ([], False),
    ],
)
def test_three_dots_stand_for_lines_left_out(shown, same):
    assert sessions.same(shown, ["a", "b", "c", "d"]) is same


def test_as_many_lines_are_left_out_as_before(tmp_path):
    (tmp_path / "f").write_text("1\n2\n3\n4\n")
    text = "```console\n$ cat f\nx\n...\ny\n```\n"
    assert sessions.refreshed(text, tmp_path) == "```console\n$ cat f\n1\n...\n4\n```\n"
