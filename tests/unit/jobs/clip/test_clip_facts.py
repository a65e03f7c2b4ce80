"""What a job reads off a clip, and the world transforms that it keeps for as long as they are wanted."""

import pytest
from mannequin import bvh_text

from motionedit.core.bvh import parse_clip
from motionedit.jobs.clip import facts


@pytest.fixture
def counted(monkeypatch):
    calls, forward = [], facts.kinematics.forward

    def noted(motion):
        calls.append(motion)
        return forward(motion)

    monkeypatch.setattr(facts.kinematics, "forward", noted)
    return calls


def test_the_world_transforms_of_a_clip_are_computed_once(counted):
    found = facts.facts_of(parse_clip(bvh_text().encode(), label="mannequin.bvh"))
    assert found.poses is found.poses
    found.heading_frame()
    assert len(counted) == 1


def test_world_transforms_that_were_given_back_come_anew(counted):
    found = facts.facts_of(parse_clip(bvh_text().encode(), label="mannequin.bvh"))
    before = found.poses
    found.forget_poses()
    found.forget_poses()
    assert found.poses is not before
    assert (found.poses.positions == before.positions).all()
    assert len(counted) == 2
