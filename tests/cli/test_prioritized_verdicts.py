"""edit-prioritized: what is said of goals, of loose feet and hands, in reports and before the work."""

import re

import numpy as np
import pytest
import yaml
from prioritized_edits import ARM_ONLY, FEET_AS_CAPTURED, RAISED, WALK, hand
from scipy.spatial.transform import Rotation

from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from studies.lab import effector_path

SWING = WALK.parent / "golf" / "swing04.bvh"
HANDS = ("LeftHand", "RightHand")


def test_an_unreachable_hand_warns_and_fails_strict_alone(edit):
    far = hand({"hold": [66, 72], "shift": [0, 300, 0]}, recruit={"up_to": "LeftArm"})
    done = edit([far], "--strict")
    assert done.result.exit_code == 3
    assert done.record["status"] == done.constraint("hand")["status"] == "unreachable"
    assert done.warnings[0].endswith("(tolerance 0.1018): out of reach of the joints it recruits")
    assert done.record["message"] == done.warnings[0].removeprefix("motionedit: warning: ")
    assert done.path.exists()
    assert edit([far]).result.exit_code == 0
    off = edit([{**far, "tolerance": "off"}], "--strict")
    assert off.constraint("hand")["status"] == "ok"
    assert not [line for line in off.warnings if "from its goal" in line]
    # How the arm shoots out is another matter.
    assert off.record["status"] in {"ok", "rough"}


def test_what_only_rides_warns_where_it_is_far_off_and_does_not_fail_strict(edit):
    riding = {"name": "ride", "type": "position", "effector": "LeftHand", "priority": 1}
    done = edit([RAISED, riding], "--strict")
    assert done.result.exit_code == 0
    assert done.record["status"] == "ok"
    ride = done.constraint("ride")
    assert (ride["status"], ride["strict"], ride["gave_way_to"]) == ("out_of_tolerance", False, ["hand"])
    assert "warning: ride: " in done.result.stderr
    near = edit([hand({"during": [66, 72], "shift": [0, 0.5, 0]}), riding])
    assert near.constraint("ride")["status"] == "out_of_tolerance"
    assert not near.warnings
    assert edit([RAISED, {**riding, "tolerance": 0.5}], "--strict").result.exit_code == 3


def test_points_that_strict_does_not_count_warn_where_they_are_missed_at_all(edit):
    # Half a centimetre: what asks for nothing of its own is not warned of for so little.
    ask = {"name": "ask", "type": "position", "effector": "LeftHand", "priority": 1}
    asked = [{**ask, "points": [{"during": [66, 72]}]}, hand({"during": [66, 72], "shift": [0, 0.5, 0]})]
    done = edit(asked, "--strict")
    assert (done.result.exit_code, done.record["status"]) == (0, "ok")
    assert done.constraint("ask")["status"] == "out_of_tolerance"
    (warning,) = done.warnings
    assert "warning: ask: 0.5 from its goal at frame " in warning


def test_the_report_tells_every_frame(edit):
    record = edit([FEET_AS_CAPTURED, RAISED]).record
    hand = record["constraints"][-1]
    assert len(hand["frames"]["error"]) == hand["last_frame"] - hand["first_frame"] + 1
    assert max(hand["frames"]["error"]) == pytest.approx(hand["error_max"])
    assert len(record["frames"]["iterations"]) == len(record["frames"]["stopped"]) == 145
    assert set(record["frames"]["stopped"]) <= {"converged", "iterations", "untouched"}
    for layer in record["layers"]:
        assert len(layer["frames"]["rank"]) == 145
        assert max(layer["frames"]["rank"]) == layer["rank"]["max"]


def test_the_report_has_the_fixed_keys(edit):
    done = edit([FEET_AS_CAPTURED, RAISED, {"type": "com", "priority": 2}], unit="cm")
    clip = done.record
    assert list(clip)[:4] == ["clip", "output", "status", "message"]
    assert {"unit", "metrics", "constraints", "layers", "iterations", "passes"} <= set(clip)
    assert clip["unit"] == "cm"
    assert [each["name"] for each in clip["constraints"]] == ["feet", "feet-2", "feet-3", "feet-4", "hand", "com"]
    keys = {"name", "priority", "error_max", "error_rms", "error_angle_max", "frame", "status", "gave_way_to"}
    for each in clip["constraints"]:
        assert keys <= set(each)
        assert each["error_angle_max"] is None
    assert [(layer["priority"], layer["rank"]) for layer in clip["layers"]] == [
        (10, {"min": 10, "max": 10}),
        (4, {"min": 3, "max": 3}),
        (2, {"min": 3, "max": 3}),
    ]
    wrist = done.constraint("hand")
    assert wrist["recruited"][-1] == "Hips.position"
    # 0.8 s at 24 Hz is 19.2 frames.
    assert (wrist["first_frame"], wrist["last_frame"]) == (47, 91)


@pytest.mark.compiled
def test_a_dry_run_lists_the_layers_in_solving_order_and_writes_nothing(edit):
    feet = {**FEET_AS_CAPTURED, "effector": ["LeftFoot", "RightFoot"], "recruit": {"levels": 1}}
    wrist = {**RAISED, "recruit": {"joints": ["Hips", "LeftForeArm", "Hips.position"]}}
    com = {"type": "com", "recruit": ARM_ONLY, "support": ["LeftFoot", "RightFoot"], "weight": 2}
    done = edit([wrist, feet, com], "--dry-run", defaults={"ease_in": 5, "ease_out": 5})
    assert done.result.exit_code == 0
    moved = ("Hips", "LeftArm", "LeftForeArm", "Hips.position")
    raised = "hold [66, 72] shift [5, 20, 10]"
    assert done.result.stdout.splitlines() == [
        f"would write {WALK} -> e.bvh",
        "  layer 1, priority 10",
        "    feet: position of LeftFoot, frames 0 to 144; recruits Hips, LeftLeg, Hips.position",
        "    feet-2: position of RightFoot, frames 0 to 144; recruits Hips, RightLeg, Hips.position",
        "  layer 2, priority 4",
        f"    hand: position of LeftHand, frames 61 to 77; {raised}; recruits {', '.join(moved)}",
        "  layer 3, priority 1",
        "    com: center of mass over LeftFoot, RightFoot, frames 0 to 144; weight 2; recruits LeftArm, LeftForeArm",
        "  hinges: LeftLeg, RightLeg, LeftForeArm, RightForeArm",
        "  recruiting_rule expand adds LeftArm to hand because com moves them",
        "  recruiting_rule expand adds Hips, Hips.position to feet, feet-2 because hand moves them",
        "would write the report r.json",
    ]
    assert not done.path.exists()


def test_too_few_iterations_are_said_to_have_run_out(edit):
    low = {"smoothing": {"passes": 0}, "solver": {"max_iterations": 1}}
    done = edit([{**RAISED, "recruit": ARM_ONLY}], **low)
    assert done.record["frames_not_converged"] > 0
    assert "the iterations ran out" in done.record["message"]


def loose(done):
    return [line.removeprefix("motionedit: warning: ") for line in done.warnings if "no constraint holds it" in line]


def test_a_hand_that_drags_the_body_along_says_of_each_foot_that_no_one_holds_it(edit):
    done = edit([RAISED])
    lines = loose(done)
    assert len(lines) == 2
    for foot, side, line in zip(("left", "right"), ("Left", "Right"), lines, strict=True):
        way, frame = re.fullmatch(
            rf"the {foot} foot moves by (\S+) at frame (\d+) while it is planted, and no constraint holds it", line
        ).groups()
        joints = [side + part for part in ("Foot", "ToeBase")]
        ways = [effector_path(done.path, joint) - effector_path(WALK, joint) for joint in joints]
        there = [float(np.linalg.norm(each[int(frame)])) for each in ways]
        assert any(float(way) == pytest.approx(each, rel=1e-2) for each in there)
    assert not edit([{**FEET_AS_CAPTURED, "priority": 1}, RAISED]).warnings
    assert not edit([{**RAISED, "recruit": ARM_ONLY}]).warnings


def test_one_foot_that_is_held_says_nothing_of_the_other(edit):
    for held, other in (("Left", "right"), ("Right", "left")):
        feet = {**FEET_AS_CAPTURED, "effector": [held + "Foot", held + "ToeBase"]}
        (line,) = loose(edit([feet, RAISED]))
        assert line.startswith(f"the {other} foot moves by ")
    toes = {**FEET_AS_CAPTURED, "effector": ["LeftToeBase", "RightToeBase"]}
    assert not loose(edit([toes, RAISED]))


def test_a_foot_that_is_held_in_other_frames_alone_is_told_of(edit):
    feet = {**FEET_AS_CAPTURED, "points": [{"during": [0, 5]}], "ease_out": 0}
    assert len(loose(edit([feet, RAISED]))) == 2


def parted(done):
    return [line for line in done.warnings if "no constraint keeps them together" in line]


def left_as_the_right_has_it(path):
    poses, names = forward(read_clip(path).motion), list(read_clip(path).motion.skeleton.names)
    left, right = (names.index(name) for name in HANDS)
    apart = poses.positions[:, left] - poses.positions[:, right]
    return Rotation.from_quat(poses.rotations[:, right], scalar_first=True).inv().apply(apart)


def test_a_club_that_one_hand_takes_along_says_that_the_other_no_longer_holds_it(edit):
    aside = {"type": "position", "points": [{"at": 94, "shift": [10, 0, 0]}]}
    right = {**aside, "effector": "RightHand", "recruit": {"up_to": "RightShoulder"}}
    done = edit([right], clip=SWING)
    (line,) = parted(done)
    way, frame = re.search(r"hands that hold one thing come apart by (\S+) at frame (\d+), and", line).groups()
    ways = np.linalg.norm(left_as_the_right_has_it(done.path) - left_as_the_right_has_it(SWING), axis=1)
    assert int(frame) == np.argmax(ways)
    assert float(way) == pytest.approx(ways.max(), rel=1e-2)
    # As the warning says, and as it says nothing of: both placed, or hands that hold nothing.
    grip = yaml.safe_load(re.search(r"\{.*\}", line).group())
    assert not parted(edit([right, grip], clip=SWING))
    left = {**aside, "effector": "LeftHand", "recruit": {"up_to": "LeftShoulder"}}
    assert not parted(edit([right, {**left, "points": [{"at": 94, "shift": [-10, 0, 0]}]}], clip=SWING))
    assert not parted(edit([hand({"at": 70, "shift": [0, 20, 0]}, recruit=ARM_ONLY)]))


def test_the_papers_filter_is_named_where_it_leaves_an_error(edit):
    # One pass is the filter alone, without the solve that makes good what it moved.
    done = edit([FEET_AS_CAPTURED, {**RAISED, "tolerance": 0.1}], smoothing={"method": "paper", "passes": 1})
    missed = [line for line in done.warnings if "the low-pass on the root moved it (smoothing: paper)" in line]
    assert missed
    held = edit(
        [hand({"at": 70, "shift": [40, 20, 90]}, recruit={"joints": ["Hips.position"]})], smoothing={"method": "paper"}
    )
    assert "the low-pass on the root moved it" in held.record["message"]
    far = hand({"hold": [66, 72], "shift": [0, 300, 0]}, recruit=ARM_ONLY)
    assert edit([far], smoothing={"method": "paper"}).record["status"] == "unreachable"
