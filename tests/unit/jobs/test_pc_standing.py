"""Which plants an edit by coefficients leaves alone: those of a foot that a goal is about."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core import kinematics
from motionedit.core.bvh import read_clip
from motionedit.core.coefficients.goal_chains import GoalRequest
from motionedit.core.feet.put_back import Fixed
from motionedit.core.kinematics import Effector
from motionedit.core.measure import WORLD, Measure
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.edit_pc.standing import fixed_by, plants_without

WALK = Path(__file__).resolve().parents[3] / "data" / "walk.bvh"


def test_a_plant_is_left_alone_where_its_foot_has_a_goal_shortly_before_it_stands():
    facts = facts_of(read_clip(WALK))
    left, _ = facts.anatomy.legs
    plant = next(p for p in facts.plants if p.foot == "left" and p.start > 0)
    second = round(1.0 / facts.clip.motion.frame_time)
    others = [p for p in facts.plants if p.foot == "right"]
    for joint in (left.ankle, left.knee):
        near = plants_without(facts, [Fixed(joint, plant.start - second // 10)])
        assert plant not in near
        assert [p for p in near if p.foot == "right"] == others
    middle = (facts.plants[0].start + facts.plants[0].stop) // 2
    for fixed in ([], [Fixed(facts.travel, middle)], [Fixed(left.ankle, 10 * len(facts.clip.motion))]):
        assert plants_without(facts, fixed) == list(facts.plants)
    ends = np.array([[p.start, p.stop] for p in facts.plants if p.foot == "left"])
    free = [f for f in range(len(facts.clip.motion)) if (np.abs(ends - f) > second // 4).all()]
    in_air = [f for f in free if not ((ends[:, 0] <= f) & (f <= ends[:, 1])).any()]
    if in_air:
        assert plants_without(facts, [Fixed(left.ankle, in_air[0])]) == list(facts.plants)


def test_a_foot_that_stands_where_its_goal_has_it_is_not_free_elsewhere():
    facts = facts_of(read_clip(WALK))
    foot = Effector(facts.anatomy.legs[0].ankle, np.zeros(3))
    plant = next(p for p in facts.plants if p.foot == "left")
    places = kinematics.effector_positions(facts.poses, foot)

    def fixed(frame, shift, *, kept=True, measure=WORLD):
        place = measure.positions(places[None, frame], facts.poses.at([frame]))[0] + np.array([0.0, 0.0, shift])
        request = GoalRequest(frame, foot, place, None, measure=measure)
        return fixed_by([request], facts, kept=kept)

    middle = (plant.start + plant.stop) // 2
    own = [Fixed(foot.joint, middle)]
    assert fixed(middle, 0.0) == []
    assert fixed(middle, 1.0) == own
    assert fixed(middle, 0.0, kept=False) == own
    assert fixed(middle, 0.0, measure=Measure(base=facts.travel)) == own
    stood = {f for p in facts.plants if p.foot == "left" for f in range(p.start, p.stop + 1)}
    in_air = min(set(range(len(places))) - stood)
    assert fixed(in_air, 0.0) == [Fixed(foot.joint, in_air)]


@pytest.mark.parametrize(
    ("shift", "lifted"),
    [((0, 10, 0), True), ((5, 10, 0), True), ((15, 10, 0), False), ((0, 2, 0), False), ((0, -10, 0), False)],
)
def test_a_goal_that_takes_a_foot_up_lifts_it(shift, lifted):
    facts = facts_of(read_clip(WALK))
    foot, frame = Effector(facts.anatomy.legs[0].ankle, np.zeros(3)), 20
    place = facts.poses.positions[frame, foot.joint] + np.array(shift)
    (fixed,) = fixed_by([GoalRequest(frame, foot, place, None)], facts, kept=True)
    assert fixed.lifted == lifted
