"""The same body doing the same is read alike, whatever program rigged it and whatever else hangs on it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from rig_names import CONVENTIONS, STYLES
from rig_rows import EXTRAS
from rigs import AXES, CARRIERS, Rig, found_in, plainly_found
from takes import TAKES, with_rest_pose

RATE = 60.0
UPRIGHT = ("stands", "walks", "marches", "jumps")
# Axes whose OFFSETs stand as the body does: without them no one could tell a lying body from one that stands.
STANDING = ("world", "T-pose")
SCALES = {"m": 1.0, "cm": 100.0, "mm": 1000.0, "inch": 1.0 / 0.0254}


@st.composite
def rigs(draw):
    return Rig(
        names=draw(st.sampled_from(list(CONVENTIONS))),
        scale=draw(st.sampled_from(list(SCALES.values()))),
        up=draw(st.sampled_from("yz")),
        carrier=draw(st.sampled_from(CARRIERS)),
        axes=draw(st.sampled_from(AXES)),
        facing=draw(st.floats(-180.0, 180.0)),
        order=draw(st.integers(0, 1000)),
        extras=tuple(draw(st.lists(st.sampled_from(list(EXTRAS)), unique=True, max_size=4))),
        style=draw(st.sampled_from(list(STYLES))),
        doubled=draw(st.booleans()),
        controls=draw(st.booleans()),
        hips=draw(st.sampled_from(["bare", "joints", "pelvis"])),
        rolls=draw(st.booleans()),
        neck=draw(st.sampled_from(["beside", "below", "Spine"])),
    )


def assert_same(found, plain, rig, *, within=1.0 / RATE):
    """Hold what is found in a rig's file to what is found in the plain body's; plants `within` seconds."""
    assert_same_body(found, plain, rig)
    assert found.leg == pytest.approx(plain.leg, rel=1e-5)
    assert found.missing == ()
    assert_same_plants(found.plants, plain.plants, within=within)


def assert_same_body(found, plain, rig, *, parts=None):
    """Hold joints, up, rest pose and heading to those of the plain body; of its joints, those that are `parts`."""
    expected = plain.joints | {"chest": "Spine2" if rig.neck == "below" else "Spine1"}
    expected |= {"pelvis": "Pelvis" if rig.hips == "pelvis" else "Hips"}
    assert found.joints == {part: joint for part, joint in expected.items() if parts is None or part in parts}
    assert found.up == rig.up
    assert found.first == plain.first
    assert found.heading == pytest.approx(plain.heading, abs=0.01)


def assert_same_plants(found, expected, *, within):
    found, expected = sorted(found), sorted(expected)
    assert [plant[:2] for plant in found] == [plant[:2] for plant in expected]
    apart = np.array([plant[2:] for plant in found]) - np.array([plant[2:] for plant in expected])
    assert np.abs(apart).max(initial=0.0) <= within + 1e-9


def assert_true_plants(plants, stands, *, within):
    """Hold the plants of heels, and of toes, to when the feet of a take stand."""
    expected = [(foot, part, *span) for foot, spans in stands.items() for part in ("heel", "toe") for span in spans]
    assert_same_plants(plants, expected, within=within)


@pytest.mark.parametrize("take", TAKES)
@settings(max_examples=10)
@given(rig=rigs())
def test_a_body_that_does_anything_is_found_under_any_rig(take, rig):
    if take not in UPRIGHT and rig.axes not in STANDING:
        rig = replace(rig, axes="world")
    assert_same(found_in(rig, TAKES[take](RATE)), plainly_found(take, RATE), rig)


@settings(max_examples=40)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT))
def test_names_without_meaning_do_not_hide_a_body(take, rig):
    # Where no foot is called foot a leftski1 is none that could be told, and an arm in pieces ends at a sword anywhere.
    style = "LeftSkirt1" if rig.style == "leftskirt1" else rig.style
    rolls = rig.rolls and not {"swords", "club"} & {*rig.extras}
    rig = replace(rig, names="nameless", style=style, rolls=rolls, doubled=False, controls=False)
    found = found_in(rig, TAKES[take](RATE))
    assert_same(found, plainly_found(take, RATE), rig)
    assert found.warnings == ()


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT), stretch=st.integers(1, 10_000))
@example(rig=Rig(axes="T-pose"), take="stands", stretch=697)  # long collars, a little farther apart than at one place
@example(rig=Rig(axes="T-pose"), take="stands", stretch=1382)
@example(rig=Rig(axes="T-pose", hips="joints", neck="below"), take="stands", stretch=490)
def test_a_body_of_any_proportions_is_found(take, rig, stretch):
    rig = replace(rig, stretch=stretch)
    assert_same_body(found_in(rig, TAKES[take](RATE)), plainly_found(take, RATE), rig)


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT), rate=st.floats(15.0, 240.0))
def test_a_body_at_any_frame_rate_is_found_and_stands_when_it_does(take, rig, rate):
    motion = TAKES[take](rate)
    found = found_in(rig, motion)
    assert_same(found, plainly_found(take, RATE), rig, within=0.05 + 1.0 / rate)
    assert_true_plants(found.plants, motion.stands, within=0.06 + 1.0 / rate)


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT), rate=st.floats(15.0, 240.0))
def test_two_millimetres_of_noise_break_no_plant_at_any_rate(take, rig, rate):
    motion = TAKES[take](rate)
    found = found_in(rig, motion, noise=0.002)
    assert_same_body(found, plainly_found(take, RATE), rig)
    assert_true_plants(found.plants, motion.stands, within=0.08 + 1.0 / rate)


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT), drift=st.floats(-0.04, 0.04))
def test_a_body_that_drifts_in_height_stands_when_it_does(take, rig, drift):
    motion = TAKES[take](RATE)
    found = found_in(rig, motion, drift=drift)
    assert_same(found, plainly_found(take, RATE), rig, within=0.06)
    assert_true_plants(found.plants, motion.stands, within=0.08)


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT), rate=st.floats(15.0, 240.0))
def test_a_t_pose_in_front_of_a_take_is_left_out_at_any_rate(take, rig, rate):
    found = found_in(rig, with_rest_pose(TAKES[take](rate)))
    assert found.first == 1
    assert_same_body(replace(found, first=0), plainly_found(take, RATE), rig)


BONES_OF_LIMBS = [
    "LeftLeg",
    "RightLeg",
    "LeftFoot",
    "RightFoot",
    "LeftForeArm",
    "RightForeArm",
    "LeftHand",
    "RightHand",
]


@settings(max_examples=40)
@given(rig=rigs(), bone=st.sampled_from(BONES_OF_LIMBS), take=st.sampled_from(UPRIGHT))
def test_a_bone_of_nearly_twice_its_twins_length_is_still_its_twin(bone, rig, take):
    rig = replace(rig, longer=bone)
    found = found_in(rig, TAKES[take](RATE))
    assert_same_body(found, plainly_found(take, RATE), rig)


@pytest.mark.parametrize(
    ("without", "gone", "says"),
    [
        (("LeftShoulder", "RightShoulder"), ("shoulder", "elbow", "wrist", "clavicle", "chest"), "no arms found"),
        (("Neck",), ("head",), "no head found"),
    ],
)
@settings(max_examples=20)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT))
def test_a_body_without_arms_or_a_head_is_found_and_says_so(without, gone, says, rig, take):
    rig = replace(rig, without=without, neck="beside")
    found, plain = found_in(rig, TAKES[take](RATE)), plainly_found(take, RATE)
    assert [line.split(":")[0] for line in found.missing] == [says]
    kept = {part: joint for part, joint in plain.joints.items() if part.split()[-1] not in gone}
    found = replace(found, joints={part: joint for part, joint in found.joints.items() if joint is not None})
    assert_same_body(found, replace(plain, joints=kept), rig, parts=kept)
    assert_same_plants(found.plants, plain.plants, within=1.0 / RATE)


@settings(max_examples=30)
@given(rig=rigs(), take=st.sampled_from(UPRIGHT))
def test_the_end_site_of_a_foot_without_a_toe_is_its_toe(take, rig):
    found, plain = found_in(replace(rig, leaf_feet=True), TAKES[take](RATE)), plainly_found(take, RATE)
    assert {found.joints[side + " toe"] for side in ("left", "right")} == {None}
    assert found.joints["left ankle"] == "LeftFoot"
    assert_same_plants(found.plants, plain.plants, within=1.0 / RATE)
