"""Distances and floors on the walk of data/: held, kept as limits, and what is said where they cannot be."""

import numpy as np
import pytest
from prioritized_edits import FEET, FEET_AS_CAPTURED, WALK

from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from studies.lab import effector_path


@pytest.fixture
def edit(edit):
    """Return a runner of constraints one by one, with options of the command."""
    return lambda *constraints, options=(), **keys: edit(list(constraints), *options, **keys)


def grip(*points, **more):
    ends = {"effector": "LeftHand", "to": "RightHand"}
    return {"name": "grip", "type": "distance", **ends, "priority": 5, "points": list(points), **more}


def apart(path):
    return np.linalg.norm(effector_path(path, "LeftHand") - effector_path(path, "RightHand"), axis=1)


def test_hands_are_held_at_a_distance_while_the_feet_ride(edit):
    done = edit(FEET_AS_CAPTURED, grip({"hold": [50, 90], "distance": 32}), options=("--strict",))
    assert (done.result.exit_code, done.record["status"]) == (0, "ok")
    # A tenth of a millimetre.
    np.testing.assert_allclose(apart(done.path)[50:91], 32.0, atol=0.01)
    for joint in FEET:
        np.testing.assert_allclose(effector_path(done.path, joint), effector_path(WALK, joint), atol=1e-3)
    record = done.constraint("grip")
    assert record["error_max"] < 0.01
    assert (record["first_frame"], record["last_frame"]) == (31, 109)
    assert record["effector"]["joint"] == "LeftHand"
    assert "RightForeArm" in record["recruited"]
    assert "Hips.position" not in record["recruited"]


def test_a_distance_as_in_the_input_goes_with_a_hand_that_is_moved(edit):
    hand = {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 8}
    done = edit(FEET_AS_CAPTURED, hand | {"points": [{"hold": [66, 72], "shift": [5, 20, 10]}]}, grip())
    np.testing.assert_allclose(apart(done.path), apart(WALK), atol=0.01)
    assert np.abs(effector_path(done.path, "RightHand") - effector_path(WALK, "RightHand")).max() > 5.0


@pytest.mark.parametrize(("bound", "limit"), [("at_least", 20), ("at_most", 200)])
def test_a_limit_that_the_walk_keeps_writes_the_same_bytes(edit, bound, limit):
    assert 20 < apart(WALK).min() <= apart(WALK).max() < 200
    done = edit(grip({"during": [0, "100%"], bound: limit}))
    assert done.path.read_bytes() == WALK.read_bytes()
    assert done.constraint("grip")["error_max"] == 0.0


def test_a_limit_moves_the_frames_alone_that_break_it_and_those_that_lead_there(edit):
    limit = apart(WALK).max() - 0.2
    done = edit(grip({"during": [0, "100%"], "at_most": limit}))
    found, before = apart(done.path), apart(WALK)
    np.testing.assert_allclose(found.max(), limit, atol=0.01)
    broken = np.flatnonzero(before > limit)
    # Three passes of a Gaussian of 62 ms, each as wide as three of it, at 24 Hz.
    far = np.abs(np.arange(len(before))[:, None] - broken).min(axis=1) > 3 * 3 * 1.5 + 1
    assert np.count_nonzero(far) > 20
    rows = [path.read_bytes().splitlines()[-len(before) :] for path in (WALK, done.path)]
    assert [row for row, kept in zip(rows[0], far, strict=True) if kept] == [
        row for row, kept in zip(rows[1], far, strict=True) if kept
    ]


def heights(path, joints=FEET):
    return np.stack([effector_path(path, joint)[:, 1] for joint in joints], axis=1)


def test_a_floor_lifts_what_is_below_it_by_the_legs_alone_where_those_are_recruited(edit):
    height = 3.0
    floor = {"type": "floor", "height": height, "priority": 9, "tolerance": 0.01, "recruit": {"levels": 3}}
    done = edit(floor, options=("--strict", "--verify"))
    assert done.result.exit_code == 0
    assert heights(WALK).min() < height - 0.9
    np.testing.assert_allclose(heights(done.path).min(), height, atol=0.01)
    assert done.constraint("floor")["effector"] is None
    hips, before = (effector_path(path, "Hips") for path in (done.path, WALK))
    np.testing.assert_array_equal(hips, before)


@pytest.mark.compiled
def test_a_floor_under_all_knows_every_joint_and_end_site(edit):
    low = {"name": "low", "type": "position", "effector": {"end_site": "RightHandIndex1"}, "priority": 2}
    reach = low | {"points": [{"hold": [60, 70], "shift": [0, -300, 0]}]}
    floor = {"type": "floor", "effector": "all", "height": 1, "priority": 12}
    done = edit(floor, FEET_AS_CAPTURED, reach, smoothing={"method": "paper", "passes": 0})
    motion = read_clip(done.path).motion
    tip = effector_path(done.path, "RightHandIndex1", end_site=True)[:, 1]
    assert forward(motion).positions[..., 1].min() > 1.0 - 0.01
    assert tip.min() == pytest.approx(1.0, abs=0.05)
    assert done.constraint("low")["gave_way_to"][0] == "floor"


def test_a_floor_that_gives_way_says_to_what(edit):
    stamp = {"name": "stamp", "type": "position", "effector": "LeftToeBase", "priority": 12}
    below = stamp | {"points": [{"hold": [60, 70], "shift": [0, -20, 0]}]}
    done = edit(below, {"type": "floor", "effector": ["LeftToeBase"], "tolerance": 0.1}, options=("--strict",))
    assert done.result.exit_code == 3
    record = done.constraint("floor")
    assert (record["status"], record["gave_way_to"]) == ("out_of_tolerance", ["stamp"])
    depth = -effector_path(done.path, "LeftToeBase")[:, 1].min()
    assert record["error_max"] == pytest.approx(depth, abs=1e-4)


def test_a_plan_says_what_they_are_about(edit):
    floor = {"type": "floor", "effector": ["LeftFoot", {"end_site": "LeftToeBase"}]}
    plan = edit(grip(to={"joint": "Spine1", "offset": [0, 0, 10]}), floor, options=("--dry-run",)).result.stdout
    assert "grip: distance of LeftHand to Spine1, frames 0 to 144" in plan
    assert "floor: floor under LeftFoot, LeftToeBase, frames 0 to 144" in plan


@pytest.mark.parametrize(
    ("constraint", "message"),
    [
        (grip(to="RigthHand"), "constraints.0.to: no joint 'RigthHand' in"),
        (grip(to={"end_site": "Spine1"}), "constraints.0.to: 'Spine1' in"),
        (grip(recruit={"up_to": "LeftLeg"}), "constraints.0.recruit.up_to: 'LeftLeg' is not on the way of 'grip'"),
        ({"type": "floor", "effector": ["LeftFoot", "Tail"]}, "constraints.0.effector.1: no joint 'Tail' in"),
        ({"type": "floor", "effector": {"joint": "Tail"}}, "constraints.0.effector.joint: no joint 'Tail' in"),
    ],
)
def test_what_the_clip_lacks_is_said_with_its_line(edit, constraint, message):
    done = edit(constraint)
    assert done.result.exit_code == 2
    assert message in done.result.stderr
    assert "Traceback" not in done.result.stderr
    lines = [line for line in done.result.stderr.splitlines() if "error:" in line]
    assert len(lines) == 1
    assert lines[0].startswith("motionedit: error: s.yaml:")


def test_a_floor_under_the_feet_of_what_has_none_asks_for_a_list(edit, clip):
    done = edit({"type": "floor"}, clip=clip("snake.bvh").name)
    assert done.result.exit_code == 2
    assert "no feet found in snake.bvh; list the effectors that are meant" in done.result.stderr
