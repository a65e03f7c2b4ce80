"""Pages that come from the program are what the program says now."""

import click
import generate
import pytest
from spec_page import form, spec_page

from motionedit.cli import main as program
from motionedit.spec import SPEC_COMMANDS, schema_of


@pytest.fixture
def without_sessions(monkeypatch):
    monkeypatch.setattr(generate, "pages_with_sessions", list)


@pytest.mark.compiled  # some of the digits that pages show are rounding, and numpy's are others
def test_every_page_is_up_to_date(capsys):
    assert generate.main(["--check"]) == 0, capsys.readouterr().out


@pytest.mark.usefixtures("without_sessions")
def test_a_change_in_a_help_is_noticed(monkeypatch, capsys):
    command = program.get_command(click.Context(program), "info")
    monkeypatch.setattr(command, "help", "Something else.")
    assert generate.main(["--check"]) == 1
    assert capsys.readouterr().out == "docs/cli.md is out of date; run 'make docs' and look at the difference\n"


@pytest.mark.usefixtures("without_sessions")
def test_check_writes_nothing_and_without_it_the_page_is_written(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(generate, "DOCS", tmp_path)
    monkeypatch.setattr(generate, "ROOT", tmp_path)
    assert generate.main(["--check"]) == 1
    assert list(tmp_path.iterdir()) == []
    assert generate.main([]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cli.md", "report.schema.json", "spec.md"]
    assert generate.main(["--check"]) == 0
    assert "cli.md written" in capsys.readouterr().out


def test_another_argument_shows_what_the_script_does(capsys):
    assert generate.main(["--help"]) == 2
    assert "--check" in capsys.readouterr().out


@pytest.mark.parametrize("columns", ["40", "200"])
def test_help_has_one_width_whatever_the_terminal(monkeypatch, columns):
    expected = generate.cli_page()
    monkeypatch.setenv("COLUMNS", columns)
    assert generate.cli_page() == expected
    assert max(map(len, expected.partition("```")[2].splitlines())) <= 120


def test_every_command_and_option_has_a_place():
    page = generate.cli_page()
    for name in program.list_commands(click.Context(program)):
        assert f"## motionedit {name}\n" in page
        for parameter in program.get_command(click.Context(program), name).params:
            if isinstance(parameter, click.Option) and not parameter.hidden:
                assert parameter.opts[-1] in page


@pytest.mark.parametrize("command", SPEC_COMMANDS)
def test_every_key_of_every_spec_has_a_place(command):
    page = spec_page().partition(f"## {command}\n")[2].partition("\n## ")[0]
    schema = schema_of(command)
    models = [schema, *schema["$defs"].values()]
    missing = {key for model in models for key in model["properties"] if f"`{key}`" not in page}
    assert missing - {"type"} == set()


@pytest.mark.parametrize(
    ("schema", "words"),
    [
        ({"type": "number", "exclusiveMinimum": 0}, "a number above 0"),
        ({"type": ["integer", "null"], "minimum": 1}, "a whole number from 1, or `null`"),
        ({"enum": ["keep", "drop"], "default": "keep"}, "`keep` or `drop`"),
        ({"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}, "`[x, y, z]`"),
        ({"anyOf": [{"const": "mean"}, {"type": "integer", "minimum": 2}]}, "`mean` or a whole number from 2"),
    ],
)
def test_forms_are_told_in_words(schema, words):
    assert form(schema) == words
