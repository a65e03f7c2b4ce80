"""edit-prioritized: what a clip lacks that a spec asks for is said in one line, with its place."""

import json

import pytest
from prioritized_edits import ARM_ONLY, FEET_AS_CAPTURED, RAISED, WALK, hand


@pytest.mark.parametrize(
    ("constraint", "keys", "place", "message"),
    [
        ({"effector": "LeftHnd"}, {}, "constraints.0.effector", "no joint 'LeftHnd' in"),
        ({"effector": {"end_site": "LeftHand"}}, {}, "constraints.0.effector", "has no end site"),
        ({"relative_to": "Spin1"}, {}, "constraints.0.relative_to", "did you mean 'Spine1'?"),
        (
            {"relative_to": "LeftHandIndex1"},
            {},
            "constraints.0.relative_to",
            "'LeftHandIndex1' hangs on the effector in",
        ),
        ({"type": "pose", "relative_to": "LThumb"}, {}, "constraints.0.relative_to", "never moves in that frame"),
        ({"recruit": {"up_to": "RightArm"}}, {}, "constraints.0.recruit.up_to", "'RightArm' is not on the way of 'h'"),
        ({"recruit": {"joints": ["LeftArm", "Arm"]}}, {}, "constraints.0.recruit.joints.1", "no joint 'Arm'"),
        ({}, {"defaults": {"recruit": {"up_to": "Head"}}}, "defaults.recruit.up_to", "'Head' is not on the way"),
        ({"points": [{"at": 145}]}, {}, "constraints.0.points.0.at", "145 is outside the clip"),
        ({"points": [{"hold": [3, 9]}, {"at": 8}]}, {}, "constraints.0.points.1", "'at 8'"),
        ({"type": "com", "support": ["Foot"]}, {}, "constraints.0.support.0", "no joint 'Foot'"),
        ({"type": "posture", "joints": ["Head", "Hat"]}, {}, "constraints.0.joints.1", "no joint 'Hat'"),
        ({"type": "aim", "axis": [0, 0, 1], "target": "Hat"}, {}, "constraints.0.target", "no joint 'Hat'"),
        ({}, {"masses": {"Hat": 1}}, "masses.Hat", "no joint 'Hat'"),
        ({}, {"masses": {"Head": 0}}, "masses", "not 0 for all joints"),
        ({}, {"events": {"hit": {"frames": {"walk": 200}}}}, "events.hit", "200 is outside"),
    ],
)
def test_what_the_clip_lacks_is_said_in_one_line_with_its_place(edit, constraint, keys, place, message):
    whole = {"name": "h", "type": "position", "effector": "LeftHand", **constraint}
    if whole["type"] in {"com", "posture"}:
        del whole["effector"]
    done = edit([whole], **keys)
    assert done.result.exit_code in {1, 2}
    (error,) = done.errors
    assert f": {place}: " in error
    assert message in error
    assert not done.path.exists()


def test_a_joint_that_hangs_on_the_effector_is_a_measure_where_one_between_is_recruited(edit):
    points = [{"hold": [66, 72], "shift": [0, 0, 0.5]}]
    asked = hand(*points, relative_to="LeftHandIndex1", recruit={"joints": ["LeftFingerBase"]})
    done = edit([asked])
    assert done.result.exit_code == 0
    assert done.constraint("hand")["recruited"] == ["LeftFingerBase"]


def test_all_that_a_clip_lacks_is_said_together(edit):
    bad = hand({"at": 900}, effector="Hnd", recruit={"up_to": "Hat"})
    done = edit([bad, {"type": "posture", "joints": ["Hat"]}], masses={"Hat": 1}, hinges=["Knee"])
    assert len(done.errors) == 6


def test_of_joints_that_are_not_there_all_are_named_and_what_there_is_is_listed_once(edit):
    bad = hand({"at": 3}, effector="Xyz", recruit={"joints": ["Qqq", "LeftArm", "LeftWrist"]})
    done = edit([bad, {"type": "posture", "joints": ["Vvv", "Head", "Qqq"]}], masses={"Zzz": 1})
    assert [error.split(": ", 3)[3].partition(" in ")[0] for error in done.errors] == [
        "masses.Zzz: no joint 'Zzz'",
        "constraints.0.effector: no joint 'Xyz'",
        "constraints.0.recruit.joints.0: no joint 'Qqq'",
        "constraints.0.recruit.joints.2: no joint 'LeftWrist'",
        "constraints.1.joints.0: no joint 'Vvv'",
        "constraints.1.joints.2: no joint 'Qqq'",
    ]
    assert [("; its joints are " in error) for error in done.errors] == [True, *[False] * 5]
    assert done.errors[3].endswith("; did you mean 'LeftHand'?")


def test_all_joints_of_a_given_body_that_are_not_there_are_told_together(edit):
    body = {"head": "Xyz", "left_leg": ["LeftUpLeg", "LeftKnee", "Qqq"], "right_leg": ["A", "RightLeg", "B"]}
    errors = edit([RAISED], body=body).errors
    assert [error.split(": ")[3] for error in errors] == [
        *("body.left_leg.1", "body.left_leg.2", "body.right_leg.0", "body.right_leg.2", "body.head")
    ]


def test_four_effectors_of_one_list_say_a_common_fault_once(edit):
    done = edit([{**FEET_AS_CAPTURED, "points": [{"at": 900}]}])
    assert len(done.errors) == 1
    assert "more clips" not in done.errors[0]


def test_a_clip_that_lacks_a_joint_fails_alone(run, clip, tmp_path):
    clip("in/chain.bvh", frames=100)
    (tmp_path / "in" / "walk.bvh").write_bytes(WALK.read_bytes())
    spec = {"schema": "motionedit/edit-prioritized/v1", "constraints": [{**RAISED, "recruit": ARM_ONLY}]}
    (tmp_path / "s.yaml").write_text(json.dumps(spec))
    result = run("edit-prioritized", "in", "-s", "s.yaml", "-o", "out")
    assert (result.exit_code, result.stdout) == (1, "out/walk.bvh\n")
    assert "no joint 'LeftHand' in in/chain.bvh" in result.stderr
