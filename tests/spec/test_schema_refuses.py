"""The schema that editors check by refuses what the tool refuses, as far as JSON Schema can say it."""

import jsonschema
import pytest

from motionedit.errors import MotionEditError
from motionedit.spec import schema_of
from motionedit.spec.load import load_spec

VALIDATORS = {
    command: jsonschema.Draft202012Validator(schema_of(command))
    for command in ("normalize", "edit-pc", "edit-prioritized")
}
AIM = {"type": "aim", "effector": "Head", "axis": [0, 0, 1]}
POSITION = {"type": "position", "effector": "LeftHand"}
POSE = {"type": "pose", "effector": "Head"}
TURNED = {"type": "orientation", "effector": "Head"}


@pytest.mark.parametrize(
    ("constraint", "sound"),
    [
        ({**POSITION, "points": [{"during": [1, 4], "shift": [0, 1, 0]}]}, True),
        ({**POSITION, "points": [{"during": [1, 4], "position": [0, 1, 0]}]}, False),
        ({**AIM, "target": "LeftHand"}, True),
        ({**AIM, "target": "LeftHand", "points": [{"hold": [1, 4]}]}, True),
        ({**AIM, "target": "LeftHand", "points": [{"hold": [1, 4], "position": [0, 1, 0]}]}, False),
        ({**AIM, "target": "LeftHand", "relative_to": "Spine"}, False),
        ({**AIM, "points": [{"hold": [1, 4], "position": [0, 1, 0]}]}, True),
        ({**AIM, "points": [{"hold": [1, 4]}]}, False),
        ({**AIM, "points": []}, False),
        (AIM, False),
        ({**AIM, "axis": [0, 0.0, 0], "target": "LeftHand"}, False),
        ({"type": "distance", "effector": "LeftHand", "to": "RightHand"}, True),
        ({"type": "distance", "effector": "LeftHand"}, False),
        (
            {**TURNED, "points": [{"at": 1, "orientation": {"euler": [0, 1, 0]}}]},
            False,
        ),
        ({**TURNED, "points": [{"at": 1, "position": [0, 0, 0]}]}, False),
        ({**TURNED, "tolerance": {"angle": 1}}, True),
        ({**TURNED, "tolerance": {"position": 1}}, False),
        ({**POSITION, "tolerance": {"angle": 1}}, False),
        ({**POSITION, "tolerance": {"position": 1}}, True),
        ({**POSITION, "frame": "heading", "relative_to": "Spine"}, False),
        ({**POSITION, "points": [{"at": 1, "at_least": 2}]}, False),
        ({"type": "com", "points": [{"at": 1, "shift": [0, 0, 1], "tension": 0.5}]}, True),
        ({"type": "com", "points": [{"at": 1, "position": [0, 0, 1]}]}, False),
        (
            {**POSE, "points": [{"at": 1, "orientation": {"quaternion": [0, 0, 0, 0]}}]},
            False,
        ),
        (
            {**POSE, "points": [{"at": 1, "orientation": {"quaternion": [0, 0, 0, 1]}}]},
            True,
        ),
    ],
)
def test_the_schema_and_the_tool_agree_on_a_constraint(constraint, sound):
    assert_agreed("edit-prioritized", {"constraints": [constraint]}, sound=sound)


def assert_agreed(command, keys, *, sound):
    spec = {"schema": f"motionedit/{command}/v1", **keys}
    assert VALIDATORS[command].is_valid(spec) is sound
    if sound:
        load_spec(spec, command)
    else:
        with pytest.raises(MotionEditError):
            load_spec(spec, command)


GOAL = {"at": 3, "effector": "Hand"}
SHIFT = {"shift": [0, 1, 0]}
TURN = {"orientation": {"euler": [0, 1, 0], "order": "ZXY"}}


@pytest.mark.parametrize(
    ("keys", "sound"),
    [
        (SHIFT, True),
        ({}, False),
        ({**SHIFT, "position": [0, 1, 0]}, False),
        ({**SHIFT, "axes": ["x"]}, True),
        ({**TURN, "axes": ["x"]}, False),
        ({**TURN, **SHIFT, "axes": ["x"], "tolerance": {"position": 1, "angle": 2}}, True),
        ({**SHIFT, "tolerance": {"position": 1, "angle": 2}}, False),
        ({**SHIFT, "tolerance": 2}, True),
        ({**SHIFT, "frame": "heading"}, True),
        ({**SHIFT, "frame": "heading", "relative_to": "Spine"}, False),
    ],
)
def test_the_schema_and_the_tool_agree_on_a_goal(keys, sound):
    assert_agreed("edit-pc", {"goals": [{**GOAL, **keys}]}, sound=sound)


def found_where(**rule):
    return {"events": {"hit": {"detect": {"effector": "A", **rule}}}}


@pytest.mark.parametrize(
    ("command", "keys", "sound"),
    [
        ("edit-pc", {"goals": [], "solver": {}}, True),
        ("edit-pc", {"goals": [], "solver": {"method": "map", "damping": 3}}, False),
        ("edit-pc", {"goals": [], "solver": {"tolerance": 3}}, False),
        ("edit-pc", {"goals": [], "unit": "cm", "solver": {"method": "damped", "damping": 3, "tolerance": 3}}, True),
        ("edit-prioritized", {"constraints": [], "smoothing": {"sigma": "0.1s"}}, True),
        ("edit-prioritized", {"constraints": [], "smoothing": {"cutoff": 3}}, False),
        ("edit-prioritized", {"constraints": [], "smoothing": {"method": "paper", "cutoff": 3}}, True),
        ("edit-prioritized", {"constraints": [], "smoothing": {"method": "paper", "sigma": "0.1s"}}, False),
        ("normalize", found_where(minimum_of="distance"), False),
        ("normalize", found_where(maximum_of="speed"), True),
        (
            "normalize",
            {"events": {"hit": {"detect": {"effector": "A", "maximum_of": "speed", "to": [0, 0, 0]}}}},
            False,
        ),
        (
            "normalize",
            {"events": {"hit": {"detect": {"effector": "A", "maximum_of": "distance", "to": [0, 0, 0]}}}},
            True,
        ),
    ],
)
def test_the_schema_and_the_tool_agree_on_what_belongs_to_a_method(command, keys, sound):
    assert_agreed(command, keys, sound=sound)


@pytest.mark.parametrize("key", ["hold", "during"])
@pytest.mark.parametrize("interval", [[9, 4], ["5s", "1s"], ["50%", "10%"]])
def test_an_interval_that_is_reversed_is_the_tools_to_refuse(key, interval):
    # Two numbers in one list are beyond JSON Schema.
    with pytest.raises(MotionEditError, match="ends before it begins"):
        load_spec(
            {"schema": "motionedit/edit-prioritized/v1", "constraints": [{**POSITION, "points": [{key: interval}]}]},
            "edit-prioritized",
        )
