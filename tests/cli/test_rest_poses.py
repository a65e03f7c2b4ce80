"""edit-prioritized of a walk with a T-pose in front: what is said where points begin within it."""

import pytest
from prioritized_edits import WALK, hand

SMOOTHED = "within reach at that frame by itself, but not along a smooth path"
BEGINS = "; its points begin within the rest pose, frame 0: begin at frame 1"


@pytest.fixture
def rested(tmp_path):
    """Return the walk with one frame in front of it in which nothing is turned: the arms point aside."""
    head, motion = WALK.read_text().split("MOTION\n")
    count, time, *rows = motion.splitlines()
    channels = len(rows[0].split())
    rest = " ".join([*rows[0].split()[:3], *["0"] * (channels - 3)])
    lines = [f"Frames: {len(rows) + 1}", time, rest, *rows]
    assert count == f"Frames: {len(rows)}"
    path = tmp_path / "rested.bvh"
    path.write_text(f"{head}MOTION\n" + "\n".join(lines) + "\n")
    return path


def test_a_goal_that_is_missed_as_it_begins_within_a_rest_pose_says_so(edit, rested):
    raised = {"shift": [0, 5, 0]}
    from_the_rest = edit([hand({"during": [0, 30], **raised}, tolerance=0.1, recruit={"levels": 3})], clip=rested)
    assert from_the_rest.record["message"].endswith(SMOOTHED + BEGINS)
    from_the_take = edit([hand({"during": [1, 30], **raised}, tolerance=0.1, recruit={"levels": 3})], clip=rested)
    assert from_the_take.record["status"] == "ok"


def test_what_is_missed_long_after_a_rest_pose_is_not_laid_to_it(edit, rested):
    later = [{"at": frame, "shift": [0, 0, 5]} for frame in (80, 100)]
    done = edit([hand({"during": [0, 10]}, *later, tolerance=0.1, recruit={"levels": 2})], clip=rested)
    assert done.constraint("hand")["frame"] > 60
    assert done.record["message"].endswith(SMOOTHED)


def test_a_rest_pose_that_is_moved_is_warned_of_once_and_one_that_is_left_is_not(edit, rested):
    box = {"name": "box", "type": "distance", "effector": "LeftHand", "to": "RightHand", "priority": 5}
    moved = edit([{**box, "points": [{"hold": [0, "100%"], "distance": 32}]}], clip=rested)
    (warning,) = [line for line in moved.warnings if "rest pose" in line]
    assert "the rest pose, frame 0, is moved by " in warning
    assert warning.endswith(": points of box begin within it; begin at frame 1 to leave it")
    for points in ([{"hold": [1, "100%"], "distance": 32}], [{"during": ["0%", "100%"], "at_least": 20}]):
        left = edit([{**box, "points": points}], clip=rested)
        assert not [line for line in left.warnings if "rest pose, frame 0, is moved" in line], points


def test_a_rest_pose_that_a_floor_lifts_with_all_else_is_not_warned_of(edit, rested):
    assert "is moved by" not in "".join(
        edit([{"type": "floor", "effector": "all", "height": 30}], clip=rested).warnings
    )
