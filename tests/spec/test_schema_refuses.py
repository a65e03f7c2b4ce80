"""The schema that editors check by refuses what the tool refuses, as far as JSON Schema can say it."""

import jsonschema
import pytest

from motionedit.errors import MotionEditError
from motionedit.spec import schema_of
from motionedit.spec.load import load_spec

VALIDATOR = jsonschema.Draft202012Validator(schema_of("edit-prioritized"))
AIM = {"type": "aim", "effector": "Head", "axis": [0, 0, 1]}
POSITION = {"type": "position", "effector": "LeftHand"}


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
    ],
)
def test_the_schema_and_the_tool_agree(constraint, sound):
    spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": [constraint]}
    assert VALIDATOR.is_valid(spec) is sound
    if sound:
        load_spec(spec, "edit-prioritized")
    else:
        with pytest.raises(MotionEditError):
            load_spec(spec, "edit-prioritized")
