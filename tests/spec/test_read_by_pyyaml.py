"""Specs as PyYAML reads them, whose `off` is False, are taken by the schema that editors check by, and by the tool."""

from pathlib import Path

import jsonschema
import pytest
import yaml

from motionedit.errors import MotionEditError
from motionedit.spec import schema_of
from motionedit.spec.load import load_spec
from motionedit.spec.yaml_tree import value_from_text

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
GOAL = "{at: 3, effector: Hand, shift: [0, 1, 2]"
HELD = "{type: position, effector: Hand, points: [{at: 3, shift: [0, 1, 2]}]"
FORMS = [
    ("edit-pc", "goals: []\nplausibility: %s"),
    ("edit-pc", "goals: []\nfeet: %s"),
    ("edit-pc", "goals: []\nunit: cm\nsolver: {method: damped}\nplausibility: %s"),
    ("edit-pc", f"goals: [{GOAL}, tolerance: %s}}]"),
    ("edit-prioritized", "constraints: []\nhinges: %s"),
    ("edit-prioritized", "constraints: []\nlimits: %s"),
    ("edit-prioritized", f"constraints: [{HELD}, tolerance: %s}}]"),
]


def is_valid(data, command):
    return jsonschema.Draft202012Validator(schema_of(command)).is_valid(data)


@pytest.mark.parametrize("path", sorted(CONFIGS.glob("*.yaml")), ids=lambda path: path.name)
def test_a_shipped_spec_is_taken_by_both(path, monkeypatch):
    monkeypatch.chdir(CONFIGS)
    data = yaml.safe_load(path.read_bytes())
    command = data["schema"].split("/")[1]
    assert is_valid(data, command)
    assert load_spec(data, command).model == load_spec(Path(path.name), command).model


@pytest.mark.parametrize(("command", "form"), FORMS)
def test_off_is_off_however_it_was_read(command, form):
    text = f"schema: motionedit/{command}/v1\n{form % 'off'}"
    ours, theirs = value_from_text(text), yaml.safe_load(text)
    assert (ours == theirs, "False" in str(theirs)) == (False, True)
    assert is_valid(ours, command)
    assert is_valid(theirs, command)
    assert load_spec(theirs, command).model == load_spec(ours, command).model


@pytest.mark.parametrize(("command", "form"), FORMS)
def test_on_is_nothing(command, form):
    data = yaml.safe_load(f"schema: motionedit/{command}/v1\n{form % 'on'}")
    assert not is_valid(data, command)
    with pytest.raises(MotionEditError):
        load_spec(data, command)


def test_false_is_off_where_off_stands_and_nowhere_else():
    data = yaml.safe_load("schema: motionedit/edit-prioritized/v1\nconstraints: []\nstiffness: off")
    assert not is_valid(data, "edit-prioritized")
    with pytest.raises(MotionEditError):
        load_spec(data, "edit-prioritized")
