"""Which joints a constraint may move, and the rule that keeps layers strict ([PRIO] 4.1)."""

import numpy as np
import pytest
from human import BONES, above, skeleton_of

from motionedit.core.kinematics import Effector
from motionedit.core.measure import Measure
from motionedit.core.priorities.kinds import Position
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.recruiting import (
    Breach,
    Reach,
    RecruitRule,
    Recruits,
    breaches,
    expanded,
    recruit_chain,
)

SKELETON = skeleton_of()
NAMES = SKELETON.names


def named(recruits, names=NAMES):
    return {names[j] for j in recruits.joints}


def chain(rule, start="RightForeArm"):
    return recruit_chain(SKELETON, rule, start=NAMES.index(start), travel=0)


def test_all_goes_to_the_root_with_its_translation():
    found = chain(RecruitRule())
    assert named(found) == {"RightForeArm", "RightArm", "RightShoulder", "Spine1", "Spine", "Hips"}
    assert found.root


def test_up_to_and_levels_and_a_list_leave_the_roots_translation_alone():
    up_to = chain(RecruitRule("up_to", joint=NAMES.index("RightShoulder")))
    levels = chain(RecruitRule("levels", levels=2))
    listed = chain(RecruitRule("joints", joints=(3, 4)))
    assert named(up_to) == {"RightForeArm", "RightArm", "RightShoulder"}
    assert named(levels) == {"RightForeArm", "RightArm"}
    assert listed.joints == {3, 4}
    assert not any(each.root for each in (up_to, levels, listed))


def test_up_to_a_joint_that_is_not_on_the_way_is_an_error():
    with pytest.raises(ValueError, match="is not between the effector and the root"):
        chain(RecruitRule("up_to", joint=NAMES.index("LeftLeg")))


def test_a_static_root_above_the_travel_is_never_recruited():
    skeleton = skeleton_of(above(BONES, "World"))
    found = recruit_chain(skeleton, RecruitRule(), start=skeleton.names.index("Spine"), travel=1)
    assert named(found, skeleton.names) == {"Spine", "Hips"}


@pytest.mark.parametrize(
    ("joint", "base", "root"),
    [
        ("RightHand", None, True),
        ("RightHand", "Spine", False),
        ("RightHand", "World", True),
        ("World", "RightHand", True),
        ("World", None, False),
    ],
)
def test_the_roots_translation_moves_what_it_does_not_move_at_both_ends(joint, base, root):
    skeleton = skeleton_of(above(BONES, "World"))
    index = skeleton.names.index
    seen_from = Measure(base=None if base is None else index(base))
    constraint = Position(name="p", effector=Effector(index(joint), np.zeros(3)), measure=seen_from)
    assert constraint.moved_by(Movable(skeleton, index("Hips"), frozenset())).root == root


def test_what_moves_a_higher_task_must_be_recruited_by_it():
    hand = Recruits(frozenset({1, 2, 3}), root=True)
    foot = Recruits(frozenset({8, 9}), root=False)
    reach_foot = Reach(frozenset({1, 8, 9}), root=True, first=0, last=10)
    reach_hand = Reach(frozenset({1, 2, 3}), root=True, first=5, last=20)
    found = breaches([10, 4], [foot, hand], [reach_foot, reach_hand])
    assert found == [Breach(0, 1, frozenset({1}), root=True)]
    sets, mended = expanded([10, 4], [foot, hand], [reach_foot, reach_hand])
    assert sets[0] == Recruits(frozenset({1, 8, 9}), root=True)
    assert mended == found
    assert not breaches([10, 4], sets, [reach_foot, reach_hand])


def test_constraints_that_are_never_active_together_do_not_meet():
    a, b = Recruits(frozenset({1}), root=False), Recruits(frozenset({2}), root=True)
    apart = [Reach(frozenset({1, 2}), True, 0, 4), Reach(frozenset({2}), True, 5, 9)]
    assert breaches([2, 1], [a, b], apart) == []


def test_a_lower_constraint_may_have_less_than_a_higher_one_uses():
    # Eq. (2) as printed would refuse nothing here, and would refuse feet above a whole-body CoM, which is exact.
    feet, com = Recruits(frozenset({0, 1}), True), Recruits(frozenset(range(9)), True)
    reaches = [Reach(frozenset({0, 1}), True, 0, 9), Reach(frozenset(range(9)), True, 0, 9)]
    assert breaches([2, 1], [feet, com], reaches) == []
