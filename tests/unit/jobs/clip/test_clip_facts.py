"""What a job reads off a clip, and the world transforms that it keeps for as long as they are wanted."""

import time

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


def test_a_body_with_a_thousand_branches_is_looked_at_within_seconds():
    branch = "JOINT b{}\n{{\nOFFSET 0 1 0\nCHANNELS 0\nEnd Site\n{{\nOFFSET 0 1 0\n}}\n}}\n"
    text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n"
    text += "".join(map(branch.format, range(1000))) + "}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n"
    start = time.perf_counter()
    facts.facts_of(parse_clip(text.encode(), label="row.bvh"), up="y")
    assert time.perf_counter() - start < 5.0  # of all pairs it would be half a minute
