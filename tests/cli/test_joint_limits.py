"""`limits:` of edit-prioritized: how far the joints of a clip turn."""

import json
from pathlib import Path

import numpy as np
import pytest

from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip

WALK = Path(__file__).resolve().parents[2] / "data" / "walk.bvh"
HAND = {
    "type": "position",
    "effector": "LeftHand",
    "recruit": {"up_to": "LeftArm"},
    "points": [{"at": 60, "shift": [5, 60, 30]}],
}


@pytest.fixture
def turned(run, tmp_path):
    """Return a function from limits to how far the left arm is turned at frame 60, degrees, and the result."""

    def invoke(limits):
        spec = {"schema": "motionedit/edit-prioritized/v1", "limits": limits, "constraints": [HAND]}
        (tmp_path / "s.yaml").write_text(json.dumps(spec))
        result = run("edit-prioritized", WALK, "-s", "s.yaml", "-o", "e.bvh")
        if result.exit_code:
            return None, result
        before, after = (read_clip(path).motion for path in (WALK, tmp_path / "e.bvh"))
        joint = before.skeleton.names.index("LeftArm")
        return np.degrees(rot.angle_between(before.rotations[60, joint], after.rotations[60, joint])), result

    return invoke


def test_a_joint_that_is_named_turns_no_further_than_its_limit(turned):
    free, tight = (turned(each)[0] for each in ("off", {"LeftArm": {"swing": 20, "twist": 20}}))
    assert tight < 0.8 * free


def test_a_joint_that_the_clip_does_not_have_is_an_error_with_its_line(turned):
    _, result = turned({"LeftArn": {"swing": 20}})
    assert result.exit_code == 2
    assert "s.yaml:1: limits.LeftArn: no joint 'LeftArn'" in result.stderr
    assert "'LeftArm'" in result.stderr


def test_a_limit_of_a_knee_that_is_a_hinge_is_said_to_say_nothing(turned):
    _, result = turned({"LeftForeArm": {"swing": 20}})
    assert "limits of LeftForeArm say nothing: it bends about an axis" in result.stderr
