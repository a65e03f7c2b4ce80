"""Examples with something changed at random: loaded or refused in plain words, and never another way."""

import copy
import functools
import tempfile
from pathlib import Path

import jsonschema
import pytest
import yaml
from contract import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st

from motionedit.errors import MotionEditError, SpecError
from motionedit.spec import schema_of
from motionedit.spec.load import load_spec
from motionedit.spec.yaml_tree import value_from_text

VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-5, 200),
    st.floats(-10, 10),
    st.sampled_from(
        ["off", "all", "x", "hit", "hit - 3", "3.76s", "71.2%", "cm", "world", "mean", "1_000", "", "damped"]
    ),
    st.lists(st.one_of(st.integers(0, 9), st.sampled_from(["x", "A"])), max_size=4),
    st.sampled_from(
        [{}, {"joint": "A"}, {"end_site": "A"}, {"up_to": "A"}, {"frames": 3}, {"quaternion": [1, 0, 0, 0]}]
    ),
    st.sampled_from([{"at": 3}, {"hold": [1, 2]}, {"position": 1, "angle": 2}, {"method": "paper"}]),
)


def places(data):
    """Yield every container of plain data with each of its keys."""
    for key, value in list(data.items() if isinstance(data, dict) else enumerate(data)):
        yield data, key
        if isinstance(value, (dict, list)):
            yield from places(value)


@st.composite
def changed(draw):
    command, text = draw(st.sampled_from(list(EXAMPLES.values())))
    data = copy.deepcopy(value_from_text(text))
    for _ in range(draw(st.integers(1, 3))):
        found = list(places(data))
        container, key = found[draw(st.integers(0, len(found) - 1))]
        change = draw(st.sampled_from(["replace", "remove", "add", "rename"]))
        if change == "replace":
            container[key] = copy.deepcopy(draw(VALUES))
        elif change == "remove":
            del container[key]
        elif isinstance(container, dict):
            names = [name for inside, name in found if isinstance(inside, dict)]
            name = names[draw(st.integers(0, len(names) - 1))]
            container[name] = container.pop(key) if change == "rename" else copy.deepcopy(draw(VALUES))
        if not data:
            break
    return command, data


@functools.cache
def validator(command):
    return jsonschema.Draft202012Validator(schema_of(command))


@given(changed())
@settings(max_examples=300, deadline=None)
def test_a_changed_example_is_valid_for_editors_too_or_refused_in_plain_words(case):
    command, data = case
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "spec.yaml")
        path.write_text(yaml.safe_dump(data, sort_keys=False))
        try:
            loaded = load_spec(path, command)
        except MotionEditError as errors:
            lines = [str(error) for error in errors.errors]
            refused = errors.errors
        else:
            validator(command).validate(loaded.data)
            return
    assert all(isinstance(error, SpecError) for error in refused)
    assert all(line.isprintable() for line in lines)
    assert len(set(lines)) == len(lines), "one fault, one line"


@pytest.mark.parametrize(("command", "text"), EXAMPLES.values(), ids=EXAMPLES)
def test_each_key_of_an_example_without_a_value_is_refused(command, text, tmp_path):
    data = value_from_text(text)
    for container, key in list(places(data)):
        if key == "max_iterations" and command == "edit-pc":
            continue
        value = container[key]
        container[key] = None
        path = tmp_path / "spec.yaml"
        path.write_text(yaml.safe_dump(data, sort_keys=False))
        with pytest.raises(MotionEditError):
            load_spec(path, command)
        container[key] = value
