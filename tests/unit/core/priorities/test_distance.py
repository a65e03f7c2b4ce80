"""Two points of the body keep a distance, or stay within one."""

import numpy as np
import pytest
from human import with_rotation
from hypothesis import given, settings
from hypothesis import strategies as st
from person import FEET, HARD, SKELETON, edited, end, held, held_feet, joint, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds import CenterOfMass, Distance
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.recruiting import NotOnTheWayError, RecruitRule
from motionedit.core.priorities.settings import LayeredSettings, Passes
from motionedit.core.priorities.trajectories.lengths import LengthPoint

FRAMES = 12
MM = 1e-3
MOTION = with_rotation(swaying(FRAMES), "LeftArm", slice(None), np.linspace(0.0, 0.8, FRAMES)[:, None] * [0, 0, 1])
MOVABLE = Movable(SKELETON, 0, frozenset(range(len(SKELETON))))


def between(motion, one, other):
    return np.linalg.norm(path(motion, *one) - path(motion, *other), axis=1)


OWN = between(MOTION, ("LeftHand",), ("RightHand",))


def hands(length=None, bound="distance", first=0, last=FRAMES - 1, **more):
    points = () if length is None else (LengthPoint("hold", first, last, length=length, bound=bound),)
    keys = {"name": "hands", "priority": 5, "effector": end("LeftHand"), "to": end("RightHand")}
    return Distance(**keys | more, points=points)


def apart(edit):
    return between(edit.motion, ("LeftHand",), ("RightHand",))


@pytest.mark.parametrize("length", [0.05, 0.2, 0.6, 1.3])
def test_two_hands_are_as_far_apart_as_asked_and_nothing_else_moves(length):
    edit = edited(MOTION, [*held_feet(FRAMES), hands(length)])
    np.testing.assert_allclose(apart(edit), length, atol=1e-5)
    np.testing.assert_array_equal(edit.errors[-1].positions < 0.01 * MM, True)
    arms = {f"{side}{bone}" for side in ("Left", "Right") for bone in ("Shoulder", "Arm", "ForeArm")}
    assert {SKELETON.names[j] for j in np.flatnonzero(edit.touched.any(axis=0))} <= arms
    assert not edit.moved.any()


def test_without_points_the_distance_is_the_inputs_while_an_arm_is_moved():
    edit = edited(MOTION, [*held_feet(FRAMES), hands(), held("RightHand", FRAMES, (0.2, 0.3, 0.1), priority=3)])
    np.testing.assert_allclose(apart(edit), OWN, atol=1e-5)
    assert edit.errors[-1].positions.max() < 0.01 * MM
    assert np.abs(path(edit.motion, "LeftHand") - path(MOTION, "LeftHand")).max() > 0.05


@pytest.mark.parametrize(("bound", "length"), [("at_least", OWN.min() - 1e-6), ("at_most", OWN.max() + 1e-6)])
def test_a_bound_that_is_kept_leaves_every_frame_as_it_was(bound, length):
    edit = edited(MOTION, [hands(length, bound)], LayeredSettings(smoothing=Passes(2, 1.0)))
    assert not edit.touched.any()
    assert edit.iterations.max() == 1
    np.testing.assert_array_equal(edit.errors[0].positions, 0.0)


@pytest.mark.parametrize(("bound", "sign"), [("at_least", 1.0), ("at_most", -1.0)])
def test_a_bound_is_met_exactly_where_the_input_breaks_it_and_nowhere_else(bound, sign):
    limit = float(np.median(OWN))
    broken = sign * (limit - OWN) > 0.0
    assert np.count_nonzero(broken) == FRAMES // 2
    edit = edited(MOTION, [hands(limit, bound)])
    np.testing.assert_allclose(apart(edit)[broken], limit, atol=1e-5)
    assert not edit.touched[~broken].any()


def test_a_bound_lets_a_layer_below_go_as_far_as_it_and_no_farther():
    away = held("RightHand", FRAMES, (-2.0, 0.5, 0.0), priority=3)
    free, bound = (edited(MOTION, [*held_feet(FRAMES), *more, away]) for more in ([], [hands(0.7, "at_most")]))
    assert apart(free).min() > 0.7
    np.testing.assert_allclose(apart(bound), 0.7, atol=1e-5)
    near = held("RightHand", FRAMES, (-0.1, 0.0, 0.0), priority=3)
    met = edited(MOTION, [*held_feet(FRAMES), hands(0.7, "at_most"), near])
    assert met.errors[-1].positions.max() < 0.01 * MM
    assert apart(met).max() < 0.7 + 1e-6
    assert apart(met).min() < 0.5


def test_a_distance_gives_way_to_what_is_above_it():
    apart_by_hand = [held("RightHand", FRAMES, priority=9), held("LeftHand", FRAMES, priority=9)]
    edit = edited(MOTION, [*apart_by_hand, hands(0.1)])
    assert max(each.positions.max() for each in edit.errors[:2]) < 0.01 * MM
    np.testing.assert_allclose(edit.errors[2].positions, apart(edit) - 0.1, atol=1e-9)
    assert edit.converged.all()


def test_a_distance_out_of_reach_is_missed_by_what_it_is_out_of_reach():
    arm = RecruitRule("joints", joints=(joint("LeftForeArm"),))
    turn = hands(1.6, to=end("Head"), recruit=arm)
    elbow = between(MOTION, ("LeftForeArm",), ("Head",))
    out_of_reach = 1.6 - (elbow + 0.25)
    np.testing.assert_allclose(edited(MOTION, [turn], HARD).errors[0].positions, out_of_reach, atol=1e-4)
    # Where it gives way it is not stretched to its end, and nearer than it was.
    softly = edited(MOTION, [turn]).errors[0].positions
    assert (softly > out_of_reach).all()
    assert (softly < out_of_reach + 0.03).all()
    assert (softly < 1.6 - between(MOTION, ("LeftHand",), ("Head",))).all()


def test_the_report_marks_the_place_that_has_the_distance_on_the_way_between_both():
    edit = edited(MOTION, [held("LeftHand", FRAMES, priority=9), held("RightHand", FRAMES, priority=9), hands(0.1)])
    places, left, right = edit.errors[2].places, path(edit.motion, "LeftHand"), path(edit.motion, "RightHand")
    np.testing.assert_allclose(np.linalg.norm(places - right, axis=1), 0.1)
    np.testing.assert_allclose(np.cross(places - right, left - right), 0.0, atol=1e-12)


def test_what_moves_both_ends_alike_is_not_recruited():
    found = hands().recruits(MOVABLE)
    names = {SKELETON.names[j] for j in found.joints}
    assert names == {f"{side}{bone}" for side in ("Left", "Right") for bone in ("Shoulder", "Arm", "ForeArm")}
    assert not found.root
    assert found == hands().moved_by(MOVABLE)


def test_an_end_that_hangs_on_the_other_is_moved_by_the_joints_between():
    found = hands(to=end("Spine1", (0.0, 0.0, 0.2))).recruits(MOVABLE)
    assert {SKELETON.names[j] for j in found.joints} == {"LeftShoulder", "LeftArm", "LeftForeArm"}


def test_up_to_a_joint_of_one_arm_moves_that_arm_alone():
    found = hands(recruit=RecruitRule("up_to", joint=joint("RightArm"))).recruits(MOVABLE)
    assert {SKELETON.names[j] for j in found.joints} == {"RightArm", "RightForeArm"}
    with pytest.raises(NotOnTheWayError) as caught:
        hands(recruit=RecruitRule("up_to", joint=joint("LeftLeg"))).recruits(MOVABLE)
    assert {joint("LeftForeArm"), joint("RightForeArm")} <= caught.value.way


def test_an_end_that_the_travel_does_not_carry_is_left_behind_by_the_root():
    movable = Movable(SKELETON, joint("Spine"), MOVABLE.carriers)
    found = hands(to=end("LeftFoot")).moved_by(movable)
    assert found.root


def test_a_distance_is_said_with_both_of_its_ends():
    assert hands().words(SKELETON.names) == "distance of LeftHand to RightHand"


@settings(max_examples=20)
@given(
    st.integers(0, 10_000),
    st.sampled_from(["distance", "at_least", "at_most"]),
    st.floats(0.9, 1.1),
    st.sampled_from(["RightHand", "LeftToeBase", "RightLeg", "Head"]),
)
def test_a_distance_is_met_or_bounded_from_any_pose(seed, bound, share, other):
    rng = np.random.default_rng(seed)
    turns = rot.exp(rng.normal(scale=0.3, size=(2, len(SKELETON), 3)))
    motion = Motion(SKELETON, rot.multiply(turns, MOTION.rotations[:2]), MOTION.translations[:2], 0.01)
    to = ("LeftForeArm", rng.normal(scale=0.05, size=3))
    own = between(motion, (other, (0.0, 0.05, 0.0)), to)
    length = share * own[0]
    pair = Distance(
        name="pair",
        priority=5,
        effector=end(other, (0.0, 0.05, 0.0)),
        to=end(*to),
        points=(LengthPoint("hold", 0, 1, length=length, bound=bound),),
    )
    feet = [held(name, 2, priority=1) for name in FEET]
    # What is below may not help it or spoil it.
    edit = edited(motion, [pair, *feet, CenterOfMass(name="com", priority=0)])
    found = between(edit.motion, (other, (0.0, 0.05, 0.0)), to)
    left = {"distance": np.abs(found - length), "at_least": length - found, "at_most": found - length}[bound]
    assert left.max() < 0.1 * MM
    np.testing.assert_allclose(edit.errors[0].positions, np.maximum(left, 0.0), atol=1e-9)
