"""What a job reads off a clip, and the world transforms that it keeps for as long as they are wanted."""

import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mannequin import bvh_text

sys.path.append(str(Path(__file__).parents[2] / "core"))

from human import skeleton_of, standing, with_rotation

from motionedit.core.blocks import BLOCK_FRAMES
from motionedit.core.bvh import new_bytes, parse_clip
from motionedit.errors import ClipError
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
    found.world.forget()
    found.world.forget()
    assert found.poses is not before
    assert (found.poses.positions == before.positions).all()
    assert len(counted) == 2


def test_plants_and_phases_of_a_long_motion_whose_transforms_were_given_back_are_found_block_by_block(counted):
    clip = parse_clip(new_bytes(standing(skeleton_of(), 2 * BLOCK_FRAMES + 10)), label="person.bvh")
    held, given_back = facts.facts_of(clip, up="y"), facts.facts_of(clip, up="y")
    given_back.world.forget()
    del counted[:]
    assert given_back.phases == held.phases != ()
    assert given_back.plants == held.plants
    assert max(map(len, counted)) == BLOCK_FRAMES


@pytest.mark.parametrize("frames", [10, 2 * BLOCK_FRAMES + 10])
def test_transforms_come_in_blocks_and_those_of_a_long_motion_are_held_no_more_than_they_were(frames, counted):
    clip = parse_clip(new_bytes(standing(skeleton_of(), frames)), label="person.bvh")
    found = facts.facts_of(clip, up="y")
    whole = found.poses.positions.copy()
    found.world.forget_long()
    del counted[:]
    blocks = [block.positions for block in found.world.blocks()]
    np.testing.assert_array_equal(np.concatenate(blocks), whole)
    assert max(map(len, blocks)) <= BLOCK_FRAMES
    assert max(map(len, counted), default=0) == (BLOCK_FRAMES if frames > BLOCK_FRAMES else 0)


def test_a_body_with_a_thousand_branches_is_looked_at_within_seconds():
    branch = "JOINT b{}\n{{\nOFFSET 0 1 0\nCHANNELS 0\nEnd Site\n{{\nOFFSET 0 1 0\n}}\n}}\n"
    text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n"
    text += "".join(map(branch.format, range(1000))) + "}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n"
    start = time.perf_counter()
    facts.facts_of(parse_clip(text.encode(), label="row.bvh"), up="y")
    assert time.perf_counter() - start < 5.0  # of all pairs it would be half a minute


FRAMES = 400  # four seconds
LEG_UP, LEG_BACK = (-1.0, 0.0, 0.0), (0.5, 0.0, 0.0)


def facts_of_person(*turns, frames=FRAMES):
    """Return the facts of a person who stands still, but for turns of joints in some frames."""
    motion = standing(skeleton_of(), frames)
    for turn in turns:
        motion = with_rotation(motion, *turn)
    return facts.facts_of(parse_clip(new_bytes(motion), label="person.bvh"), up="y", keep_rest_pose=True)


@pytest.mark.parametrize("at", [None, 0, 0.5, 199, 350, FRAMES - 1])
def test_a_person_with_both_feet_on_the_ground_side_by_side_stands(at):
    assert facts_of_person().stands(at) is True


def test_a_person_on_one_leg_does_not_stand_while_that_lasts():
    found = facts_of_person(("RightUpLeg", slice(150, 250), LEG_UP))
    assert [at for at in (0, 100, 160, 200, 240, 300, 350, FRAMES - 1) if found.stands(at)] == [
        *(0, 100, 300, 350, FRAMES - 1)
    ]


def test_a_person_with_one_foot_before_the_other_does_not_stand():
    stride = [("RightUpLeg", slice(None), LEG_BACK), ("LeftUpLeg", slice(None), (-0.5, 0.0, 0.0))]
    found = facts_of_person(*stride)
    assert {plant.foot for plant in found.plants} == {"left", "right"}
    assert found.stands(200) is False


def test_feet_on_one_spot_have_no_line_to_stand_by():
    together = [("RightUpLeg", slice(None), (0.0, 0.0, 0.12)), ("LeftUpLeg", slice(None), (0.0, 0.0, -0.12))]
    assert facts_of_person(*together).stands(200) is False


def test_a_clip_is_aligned_by_the_line_of_its_feet_or_of_its_hips():
    found = facts_of_person(("RightUpLeg", slice(None), LEG_BACK))
    hips, feet = (found.alignment(by, heading=True, position=True, at=3) for by in ("hips", "feet"))
    np.testing.assert_allclose(np.abs(hips.rotation), [1.0, 0.0, 0.0, 0.0], atol=1e-6)
    assert abs(feet.rotation[2]) > 0.1


@pytest.mark.parametrize(("frames", "first", "sound"), [(2, 0, True), (1, 0, False), (3, 1, True), (2, 1, False)])
def test_a_motion_has_two_frames_after_the_rest_pose(frames, first, sound):
    found = replace(facts_of_person(frames=frames), first=first)
    if sound:
        found.refuse_one_frame()
    else:
        with pytest.raises(ClipError, match="has one frame"):
            found.refuse_one_frame()
