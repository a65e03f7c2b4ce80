"""What a spec says of a body, at the command line: which joint is what, and what it does not have."""

import json
from pathlib import Path

import numpy as np
import pytest
from people import MEANINGLESS, limb, mirrored, person, record, spec, with_rotation

from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward

BODY = {
    "head": MEANINGLESS["Head"],
    # The other way round than it is: what a user says holds.
    "left_leg": limb("RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"),
    "right_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot"),
    "left_arm": limb("RightArm", "RightForeArm", "RightHand"),
    "right_arm": limb("LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"),
}


def test_a_spec_says_which_joint_is_what(run, write_motion, tmp_path):
    clip = write_motion("odd.bvh", person(rename=MEANINGLESS.get))
    reach = {"type": "position", "effector": MEANINGLESS["LeftHand"], "frame": "heading"}
    reach |= {"points": [{"at": 20, "shift": [0, 10, 10]}]}
    moved = []
    for body in ({}, BODY):
        done, entry = record(run, "edit-prioritized", clip, "-s", spec(tmp_path, reach, body=body), "-o", "out.bvh")
        assert (done.exit_code, entry["status"]) == (0, "ok")
        hand = MEANINGLESS["LeftHand"]
        tracks = [forward(read_clip(Path(path)).motion).positions for path in (clip, "out.bvh")]
        moved.append((tracks[1] - tracks[0])[20, list(MEANINGLESS.values()).index(hand)])
    # Left and right are exchanged, so the character faces the other way.
    np.testing.assert_allclose(moved[0], [0.0, 10.0, 10.0], atol=0.01)
    np.testing.assert_allclose(moved[1], [0.0, 10.0, -10.0], atol=0.01)


@pytest.mark.parametrize("exchanged", [True, False])
def test_body_says_which_limbs_are_left_and_a_warning_that_toes_point_back(run, write_motion, tmp_path, exchanged):
    clip = write_motion("mirrored.bvh", mirrored(person()))
    left, right = ("Right", "Left") if exchanged else ("Left", "Right")
    body = {
        f"{side}_leg": [f"{name}{part}" for part in ("UpLeg", "Leg", "Foot")]
        for side, name in (("left", left), ("right", right))
    }
    done = run("edit-prioritized", clip, "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 0
    assert ("body: calls left what is on the right" in done.stderr) != exchanged
    assert "what is taken for left" not in done.stderr


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({"head": "Skul"}, "body.head: no joint 'Skul' in odd.bvh"),
        (
            {**BODY, "left_leg": limb("RightLeg", "RightUpLeg", "RightFoot")},
            f"body.left_leg: '{MEANINGLESS['RightUpLeg']}' does not hang on '{MEANINGLESS['RightLeg']}' in odd.bvh",
        ),
        ({"left_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot")}, "body.left_leg: stands without right_leg"),
        ({"left_leg": "none", "right_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot")}, "body.left_leg: must be none"),
        ({"left_leg": ["a", "b"], "right_leg": "none"}, "body.left_leg: must be a leg's joints"),
        ({"tail": "T"}, "body.tail: unknown key"),
    ],
)
def test_what_a_spec_says_of_a_body_is_checked(run, write_motion, tmp_path, body, message):
    write_motion("odd.bvh", person(rename=MEANINGLESS.get))
    done = run("edit-prioritized", "odd.bvh", "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 2
    assert message in done.stderr
    assert not Path("out.bvh").exists()


def test_a_body_may_be_said_to_have_no_arms(run, write_motion, tmp_path):
    clip = write_motion("person.bvh", person())
    com = {"type": "com", "axes": ["x", "z"]}
    asked = spec(tmp_path, com, body={"left_arm": "none", "right_arm": "none"})
    done = run("edit-prioritized", clip, "-s", asked, "-o", "out.bvh")
    assert "is not a human's" in done.stderr
    assert "is not a human's" not in run("edit-prioritized", clip, "-s", spec(tmp_path, com), "-o", "o.bvh").stderr


def test_what_normalize_is_told_of_a_body_goes_with_the_model(run, write_motion, tmp_path):
    for i in range(3):
        motion = person(rename=MEANINGLESS.get, frames=30 + 2 * i)
        write_motion(f"c{i}.bvh", with_rotation(motion, MEANINGLESS["Spine"], slice(None), (0.1 * i, 0.05, 0.0)))
    told = tmp_path / "normalize.yaml"
    told.write_text(json.dumps({"schema": "motionedit/normalize/v1", "body": BODY}))
    clips = [f"c{i}.bvh" for i in range(3)]
    assert run("normalize", *clips, "-s", told, "-o", "n").exit_code == 0
    assert json.loads(Path("n/normalization.json").read_text())["rules"]["body"] == BODY
    assert run("fit-pca", "n", "-o", "m.npz").exit_code == 0
    goal = {"at": 10, "effector": MEANINGLESS["LeftHand"], "frame": "heading", "shift": [0, 0, 1.0]}
    edit = tmp_path / "edit.yaml"
    edit.write_text(json.dumps({"schema": "motionedit/edit-pc/v1", "goals": [goal], "plausibility": "off"}))
    assert run("edit-pc", "c1.bvh", "-m", "m.npz", "-s", edit, "-o", "out.bvh").exit_code == 0
    hand = list(MEANINGLESS.values()).index(MEANINGLESS["LeftHand"])
    tracks = [forward(read_clip(Path(path)).motion).positions for path in ("c1.bvh", "out.bvh")]
    # Ahead is where they say.
    assert (tracks[1] - tracks[0])[10, hand, 2] < -0.5


@pytest.mark.parametrize("limb_of", [("Hips", "Spine", "Spine1"), ("Spine1", "Neck", "Head")])
def test_limbs_that_hang_on_each_other_are_refused(run, write_motion, tmp_path, limb_of):
    write_motion("person.bvh", person())
    body = {"left_leg": ["Hips", "Spine", "Spine1"], "right_leg": list(limb_of)}
    done = run("edit-prioritized", "person.bvh", "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 2
    assert "body.left_leg: must part from right_leg: neither limb hangs on the other" in done.stderr


@pytest.mark.parametrize("damaged", [[1, 2], {"head": 5}, {"left_leg": ["a", "b", "c"]}, None])
def test_damaged_rules_for_a_body_are_said_to_be_damaged(run, write_motion, damaged):
    for i in range(3):
        write_motion(f"c{i}.bvh", with_rotation(person(), "Spine", slice(None), (0.1 * i, 0.05, 0.0)))
    Path("normalize.yaml").write_text("schema: motionedit/normalize/v1\n")
    run("normalize", "c0.bvh", "c1.bvh", "c2.bvh", "-s", "normalize.yaml", "-o", "n")
    listed = json.loads(Path("n/normalization.json").read_text())
    listed["rules"]["body"] = damaged
    Path("n/normalization.json").write_text(json.dumps(listed))
    done = run("fit-pca", "n", "-o", "m.npz")
    assert done.exit_code != 0
    assert "normalization.json: its rules for the body are damaged" in done.stderr
