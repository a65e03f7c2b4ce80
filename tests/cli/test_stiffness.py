"""`stiffness:` of edit-prioritized: how readily the joints of a clip give."""

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
    "recruit": {"up_to": "Spine"},
    "points": [{"at": 60, "shift": [5, 15, 10]}],
}


@pytest.fixture
def turned(run, tmp_path):
    """Return a function from a stiffness to how far each joint is turned at frame 60, degrees, and the result."""

    def invoke(stiffness):
        keys = {} if stiffness is None else {"stiffness": stiffness}
        spec = {"schema": "motionedit/edit-prioritized/v1", **keys, "constraints": [HAND]}
        (tmp_path / "s.yaml").write_text(json.dumps(spec))
        result = run("edit-prioritized", WALK, "-s", "s.yaml", "-o", "e.bvh")
        if result.exit_code:
            return None, result
        before, after = (read_clip(path).motion for path in (WALK, tmp_path / "e.bvh"))
        angles = np.degrees(rot.angle_between(before.rotations[60], after.rotations[60]))
        return dict(zip(before.skeleton.names, angles, strict=True)), result

    return invoke


def test_a_humans_trunk_gives_less_than_its_limbs_and_that_is_the_default(turned):
    default, human, none = (turned(each)[0] for each in (None, "human", "none"))
    assert default == human
    assert human["Spine"] < 0.7 * none["Spine"]
    assert human["LeftForeArm"] > none["LeftForeArm"]


def test_all_alike_is_the_same_as_none(turned):
    assert turned({})[0] == turned("none")[0] == turned({"LeftArm": 1})[0]


def test_a_joint_that_is_named_gives_less_the_stiffer_it_is(turned):
    found = [turned({"LeftArm": stiffness})[0]["LeftArm"] for stiffness in (0.5, 1, 2, 5)]
    assert (np.diff(found) < 0.0).all()


def test_a_joint_that_the_clip_does_not_have_is_an_error_with_its_line(turned):
    _, result = turned({"LeftArn": 3})
    assert result.exit_code == 2
    assert "LeftArn" in result.stderr
    assert "LeftArm" in result.stderr
    assert "s.yaml:1" in result.stderr
    _, result = turned({"LeftArm": 0})
    assert result.exit_code == 2
    assert "stiffness" in result.stderr
