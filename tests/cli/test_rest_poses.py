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
