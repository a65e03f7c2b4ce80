"""What edit-prioritized says of an edit whose goals are met: `ok`, or `rough`, and why."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward

DATA = Path(__file__).resolve().parents[2] / "data"
WALK = DATA / "walk.bvh"
FEET = {
    "name": "feet",
    "type": "position",
    "effector": ["LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase"],
    "priority": 10,
}
HEAD = {"type": "orientation", "effector": "Head", "recruit": {"joints": ["Head"]}, "priority": 1}
NO_EASE = {"ease_in": 0, "ease_out": 0}
PLAIN = {"method": "passes", "passes": 0}
HARD = {"method": "paper", "passes": 0}


@pytest.fixture
def edit(run, tmp_path):
    """Return a runner of constraints on the walk: its result and the clip's record."""

    def invoke(constraints, *arguments, clip=WALK, **keys):
        spec = {"schema": "motionedit/edit-prioritized/v1", **keys, "constraints": constraints}
        (tmp_path / "s.yaml").write_text(json.dumps(spec))
        result = run("edit-prioritized", clip, "-s", "s.yaml", "-o", "e.bvh", "--report", "r.json", *arguments)
        return result, json.loads((tmp_path / "r.json").read_text())["clips"][0]

    return invoke


def scipy(path, joint):
    """Return a joint's local rotations as SciPy has them, from the channels of a file."""
    motion = read_clip(path).motion
    return Rotation.from_quat(motion.rotations[:, motion.skeleton.names.index(joint)][:, [1, 2, 3, 0]])


def nod(degrees):
    """Return a turn of the head in the world, from where it is in the walk at frame 60, about x."""
    motion = read_clip(WALK).motion
    here = forward(motion).rotations[60, motion.skeleton.names.index("Head")]
    turn = Rotation.from_rotvec([np.radians(degrees), 0.0, 0.0]) * Rotation.from_quat(here[[1, 2, 3, 0]])
    x, y, z, w = turn.as_quat()
    return {"quaternion": [w, x, y, z]}


def test_a_head_that_turns_at_once_is_rough_and_strict_counts_it(edit, tmp_path):
    at_once = {**HEAD, **NO_EASE, "points": [{"hold": [60, 61], "orientation": nod(50.0)}]}
    result, record = edit([at_once], "--strict", smoothing=PLAIN, limits="off")
    assert (record["status"], result.exit_code) == ("rough", 3)
    assert record["constraints"][0]["status"] == "ok"
    step, frame = re.match(
        r"Head: its change steps by (\S+) degrees in a sixtieth of a second at frame (\d+) \(10 would",
        record["message"],
    ).groups()
    change = scipy(WALK, "Head").inv() * scipy(tmp_path / "e.bvh", "Head")
    steps = np.degrees((change[:-1].inv() * change[1:]).magnitude()) * 24.0 / 60.0
    assert float(step) == pytest.approx(steps.max(), rel=1e-2)
    assert steps[int(frame) - 1] == pytest.approx(steps.max())
    after = record["metrics"]["after"]
    assert (after["step_joint"], after["step_frame"]) == ("Head", int(frame))
    assert after["step_max"] == pytest.approx(steps.max(), rel=1e-5)
    assert f"motionedit: warning: {record['message'].split('; ')[0]}" in result.stderr.splitlines()
    assert edit([at_once], smoothing=PLAIN)[0].exit_code == 0


def test_a_head_that_turns_slowly_within_what_necks_do_is_ok(edit):
    slowly = {**HEAD, "points": [{"hold": [60, 61], "orientation": nod(25.0)}]}
    result, record = edit([slowly], "--strict")
    assert (record["status"], record["message"], result.exit_code) == ("ok", None, 0)
    assert 0.0 < record["metrics"]["after"]["step_max"] < 10.0


def test_a_head_that_turns_too_far_is_rough_however_slowly(edit):
    far = {**HEAD, "ease_in": "2s", "ease_out": "2s", "points": [{"at": 72, "orientation": nod(120.0)}]}
    _, record = edit([far], limits="off")
    assert record["status"] == "rough"
    assert re.match(
        r"Head: turned by \d\S* degrees beyond its range in the input against \w+ at frame \d+", record["message"]
    )


def test_a_hand_that_shakes_is_rough_by_its_jerk(edit):
    shaking = [{"at": frame, "shift": [0, 0, 2.5 * (-1) ** frame]} for frame in range(40, 100)]
    hand = {
        "type": "position",
        "effector": "LeftHand",
        "recruit": {"up_to": "LeftArm"},
        "points": shaking,
        "tolerance": "off",
    }
    _, record = edit([hand], smoothing=PLAIN)
    assert record["status"] == "rough"
    times = record["metrics"]["after"]["jerk_rms"] / record["metrics"]["before"]["jerk_rms"]
    told = re.search(r"the body's jerk is (\S+) times the input's \(2 would be seen\)", record["message"])
    assert float(told.group(1)) == pytest.approx(times, rel=1e-2)
    assert times > 2.0


def test_jerk_in_a_clip_that_stands_still_is_told_as_a_multiple_of_the_least_that_counts(edit, tmp_path):
    lines = WALK.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    still = tmp_path / "still.bvh"
    still.write_text("\n".join([*lines[:first], *[lines[first + 30]] * (len(lines) - first), ""]))
    hand = {"type": "position", "effector": "LeftHand", "ease_in": 4, "ease_out": 4}
    hand["points"] = [{"hold": [40, 50], "shift": [0, 40, 20]}]
    record = edit([hand], clip=still, limits="off")[1]
    told = re.search(r"the body's jerk is (\S+) times the least that counts, 30 m/s\^3 at a leg", record["message"])
    clip = read_clip(WALK)
    leg = anatomy_of(clip.motion).leg_length
    assert float(told.group(1)) == pytest.approx(record["metrics"]["after"]["jerk_rms"] * 0.85 / leg / 30.0, rel=1e-2)


def test_a_goal_that_is_missed_is_the_worse_verdict_and_its_warning_the_first(edit):
    away = {**HEAD, **NO_EASE, "name": "turn", "points": [{"hold": [60, 61], "orientation": nod(50.0)}]}
    hand = {"type": "position", "effector": "LeftHand", "points": [{"at": 60, "shift": [0, 300, 0]}]}
    result, record = edit([away, {**hand, "recruit": {"up_to": "LeftArm"}}], smoothing=PLAIN)
    assert record["status"] == "unreachable"
    assert "LeftHand: " in record["message"]
    assert "would be seen" not in record["message"]
    warnings = result.stderr.splitlines()
    assert "from its goal" in warnings[0]
    assert any("its change steps by" in line for line in warnings)


def test_the_slide_of_the_feet_before_is_what_info_says(edit, run, tmp_path):
    for clip in (WALK, DATA / "kick.bvh"):
        _, record = edit([FEET], clip=clip)
        assert run("info", clip, "--report", "i.json").exit_code == 0
        info = json.loads((tmp_path / "i.json").read_text())["clips"][0]["metrics"]
        assert record["metrics"]["before"] == info
        assert info["step_joint"] in read_clip(clip).motion.skeleton.names


def test_without_constraints_nothing_steps(edit):
    _, record = edit([])
    assert record["status"] == "ok"
    after = record["metrics"]["after"]
    assert (after["step_max"], after["step_frame"], after["step_joint"]) == (0.0, None, None)


def hand(shift, **more):
    points = [{"hold": [66, 72], "shift": shift}]
    return {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 4, "points": points, **more}


def error_of(record, name, frame):
    one = next(each for each in record["constraints"] if each["name"] == name)
    return one["frames"]["error"][frame - one["first_frame"]]


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("asked", "smoothing"),
    [
        (hand([0, 90, 60], tolerance=0.1), HARD),
        (hand([150, 30, 0], tolerance=0.1), PLAIN),
        (hand([0, 30, 0], recruit={"joints": ["LeftForeArm"]}, tolerance=0.1), PLAIN),
    ],
)
def test_those_are_named_without_which_a_goal_would_be_nearer_and_no_others(edit, asked, smoothing):
    # The oracle: the same edit without each of them; near the border, without what keeps it smooth.
    com = {"name": "balance", "type": "com", "relative_to": "world", "priority": 6}
    pelvis = {
        "name": "pelvis",
        "type": "orientation",
        "effector": "Hips",
        "priority": 8,
        "points": [{"hold": [60, 80]}],
    }
    head = {"name": "head", "type": "posture", "joints": ["Head"], "priority": 9}
    foot = {**FEET, "name": "foot", "effector": "RightFoot"}
    others = [foot, com, pelvis, head]
    record = edit([*others, asked], smoothing=smoothing)[1]
    one = next(each for each in record["constraints"] if each["name"] == "hand")
    left = error_of(record, "hand", one["frame"])
    helped = []
    for other in others:
        without = edit([each for each in others if each is not other] + [asked], smoothing=smoothing)[1]
        if error_of(without, "hand", one["frame"]) < 0.9 * left:
            helped.append(other["name"])
    alone = error_of(edit([asked], smoothing=smoothing)[1], "hand", one["frame"])
    if helped:
        assert one["gave_way_to"] == helped
    else:
        assert bool(one["gave_way_to"]) == (alone < 0.9 * left)
    assert one["status"] == ("out_of_tolerance" if one["gave_way_to"] else "unreachable")


def test_a_goal_that_no_other_stands_in_the_way_of_is_out_of_reach(edit):
    arm = {"recruit": {"joints": ["LeftArm", "LeftForeArm"]}, "tolerance": 0.1}
    bent = {"name": "elbow", "type": "posture", "joints": ["LeftForeArm"], "priority": 9}
    result, record = edit([bent, hand([0, 300, 0], **arm)], smoothing=PLAIN)
    one = record["constraints"][1]
    assert (one["status"], one["gave_way_to"]) == ("unreachable", [])
    assert "out of reach of the joints it recruits" in result.stderr


def test_two_that_only_together_stand_in_the_way_are_both_named(edit):
    arm = {"recruit": {"joints": ["LeftArm", "LeftForeArm"]}}
    stay = [hand([0, 0, 0], name=name, priority=9, **arm) for name in ("stay", "stay-too")]
    head = {"name": "head", "type": "posture", "joints": ["Head"], "priority": 9}
    _, record = edit([*stay, head, hand([0, 12, 0], tolerance=0.1, **arm)])
    one = record["constraints"][-1]
    assert (one["status"], one["gave_way_to"]) == ("out_of_tolerance", ["stay", "stay-too"])
    assert "priority 9 above left no freedom" in record["message"]


def test_an_up_that_is_given_against_plain_evidence_warns(edit):
    result, _ = edit([HEAD | {"points": [{"at": 60, "orientation": nod(5.0)}]}], up="z")
    assert "motionedit: warning: up is given as z, but the clip plainly has y up" in result.stderr.splitlines()


@pytest.mark.parametrize(
    ("constraint", "keys"),
    [
        pytest.param(hand([1e9, -1e9, 0]), {}, marks=pytest.mark.compiled),
        (hand([0, 5, 0], tolerance=1e-12, ease_in="1e9s", ease_out=10**9), {}),
        (hand([0, 5, 0], effector={"joint": "LeftHand", "offset": [0, 1e9, 0]}), {}),
        (hand([0, 5, 0]), {"smoothing": {"sigma": "1e9s"}, "attraction": 10, "masses": {"Head": 1e9}}),
        (hand([0, 5, 0]), {"smoothing": {"method": "paper", "cutoff": 0.01}, "unit": 1e-12}),
    ],
)
def test_the_largest_numbers_that_a_spec_may_have_overflow_nowhere(edit, constraint, keys):
    # Where numpy warns a test fails.
    result, record = edit([constraint, {"type": "com", "priority": 1}], **keys)
    assert result.exit_code == 0
    assert record["status"] != "failed"
