"""Where a motion has the task of each kind, and what it leaves of it."""

from dataclasses import replace
from itertools import pairwise, starmap

import numpy as np
import pytest
from person import BODY, FEET, SKELETON, edited, end, joint, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.body.bones import below
from motionedit.core.measure import Level, Measure
from motionedit.core.motion import Motion
from motionedit.core.priorities import targets as of_all
from motionedit.core.priorities.edit import prepare
from motionedit.core.priorities.kinds import Aim, CenterOfMass, Distance, Floor, Orientation, Pose, Position, Posture
from motionedit.core.priorities.kinds.constraint import ConstraintErrors
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter
from motionedit.core.priorities.targets import errors_of, reached
from motionedit.core.priorities.task_targets import Targets
from motionedit.core.priorities.trajectories.lengths import LengthPoint
from motionedit.core.priorities.trajectories.positions import ControlPoint

FRAMES = 14
MOTION = swaying(FRAMES)
TURN = rot.exp(np.array([0.3, -0.2, 0.4]))
HOLD = ControlPoint("hold", 4, 9, None, np.array([0.1, 0.2, 0.1]))
TURNED = ControlPoint("hold", 4, 9, None, None, TURN)
AHEAD = ControlPoint("hold", 4, 9, np.array([0.5, 1.5, 3.0]))
APART = LengthPoint("hold", 4, 9, length=0.3)
EASES = {"ease_in": 3.0, "ease_out": 3.0}
HAND = end("RightHand", (0.0, -0.1, 0.0))
KINDS = {
    "position": Position(name="c", effector=HAND, points=(HOLD,), **EASES),
    "position along two axes": Position(
        name="c", effector=HAND, points=(HOLD,), measure=Measure(counted=(0, 2)), **EASES
    ),
    "position seen from a joint": Position(
        name="c", effector=HAND, points=(HOLD,), measure=Measure(base=joint("Spine1")), **EASES
    ),
    "hips": Position(name="c", effector=end("Hips"), points=(HOLD,), **EASES),
    "orientation": Orientation(name="c", effector=HAND, points=(TURNED,), **EASES),
    "orientation seen from a joint": Orientation(
        name="c", effector=HAND, points=(TURNED,), measure=Measure(base=joint("Spine1")), **EASES
    ),
    "pose": Pose(name="c", effector=HAND, points=(HOLD,), **EASES),
    "aim": Aim(
        name="c", effector=end("Head"), points=(ControlPoint("hold", 4, 9, np.array([0.5, 1.5, 3.0])),), **EASES
    ),
    "com": CenterOfMass(name="c", points=(ControlPoint("hold", 4, 9, None, np.array([0.1, 0.0, 0.1])),), **EASES),
    "distance": Distance(
        name="c",
        effector=end("LeftHand"),
        to=end("RightHand"),
        points=(LengthPoint("hold", 4, 9, length=0.3),),
        **EASES,
    ),
}


def test_of_lengths_and_angles_that_are_left_the_larger_counts():
    near, turned = np.array([0.1, 0.3]), np.array([0.2, 0.1])
    assert ConstraintErrors(0, near, turned).largest.tolist() == [0.2, 0.3]
    assert ConstraintErrors(0, near, None).largest is near
    assert ConstraintErrors(0, None, turned).largest is turned


@pytest.mark.parametrize(("kind", "has_one"), [("hips", True), ("position", False), ("aim", False)])
def test_a_joint_alone_whose_whole_place_is_asked_for_has_a_goal(kind, has_one):
    places = Targets(4, 5, np.zeros((2, 3)), np.tile(rot.IDENTITY, (2, 1)))
    goal = KINDS[kind].goal(places)
    assert (goal is not None) == has_one
    assert not has_one or goal[0] == joint("Hips")


def asked_of(constraint):
    return prepare(MOTION, [constraint], BODY, LayeredSettings(smoothing=PaperFilter(0)))[0].asked


def other_motion(seed):
    """Return a motion of the person with every joint turned a little otherwise."""
    rng = np.random.default_rng(seed)
    turns = rot.exp(rng.normal(scale=0.2, size=(FRAMES, len(SKELETON), 3)))
    shifts = rng.normal(scale=0.1, size=MOTION.translations.shape)
    return Motion(SKELETON, rot.multiply(MOTION.rotations, turns), MOTION.translations + shifts, MOTION.frame_time)


def errors(asked, targets, motion):
    """Return what a motion leaves of the only constraint, with other targets, as one array."""
    (found,) = errors_of(replace(asked, targets=(targets,)), motion)
    return np.concatenate([part for part in (found.positions, found.angles) if part is not None])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, 1])
def test_nothing_is_left_of_a_constraint_whose_targets_are_where_a_motion_has_it(kind, seed):
    asked, motion = asked_of(KINDS[kind]), other_motion(seed)
    (targets,) = asked.targets
    there = reached(asked, 0, motion)
    assert (there.first, there.last) == (targets.first, targets.last)
    assert errors(asked, targets, motion).max() > 0.01
    assert errors(asked, there, motion).max() < 1e-7
    for name in ("positions", "rotations", "lengths"):
        assert (getattr(there, name) is None) == (getattr(targets, name) is None)


# Over the constraints' frames, 1 to 12, and so that they lie in one that is not the first.
@pytest.mark.parametrize("cuts", [(0, 5, 10, FRAMES), (0, 1, FRAMES)])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_left_of_a_constraint_is_the_same_block_by_block(kind, cuts, monkeypatch):
    asked, motion = asked_of(KINDS[kind]), other_motion(2)
    (whole,) = errors_of(asked, motion)
    blocks = list(starmap(slice, pairwise(cuts)))
    monkeypatch.setattr(of_all, "frame_blocks", lambda _: blocks)
    (found,) = errors_of(asked, motion)
    assert found.first == whole.first == 1
    for name in ("positions", "angles", "places"):
        one, other = getattr(found, name), getattr(whole, name)
        assert (one is None) == (other is None)
        assert one is None or np.allclose(one, other, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    "constraint",
    [
        Floor(name="c", effector=tuple(map(end, FEET)), height=None),
        Posture(name="c", joints=(joint("Head"),)),
    ],
)
def test_what_has_no_place_to_go_back_to_keeps_its_targets(constraint):
    targets = Targets(0, FRAMES - 1)
    assert constraint.reached(targets, None) is targets


ASIDE = Aim(name="a", effector=end("Head"), points=(ControlPoint("hold", 4, 9, np.array([3.0, 1.5, 1.0])),), **EASES)
FLOOR = Floor(name="f", effector=(end("LeftFoot"),), height=Level(np.array([0.0, 1.0, 0.0])))
# 25 cm up and forward.
REACH = Position(
    name="p", effector=HAND, points=(ControlPoint("hold", 4, 9, None, np.array([0.0, 0.2, 0.15])),), **EASES
)
HUMAN = replace(BODY, upper=frozenset(np.flatnonzero(below(SKELETON, joint("Spine1"))).tolist()))


@pytest.mark.parametrize("asked", [[ASIDE], [REACH], [ASIDE, REACH], [ASIDE, KINDS["orientation"]]])
def test_a_body_that_shall_but_turn_and_reach_stays_about_where_it_is(asked):
    edit = edited(MOTION, asked, body=HUMAN)
    for each in edit.errors:
        assert max(part.max() for part in (each.positions, each.angles) if part is not None) < 1e-4
    assert np.abs(edit.motion.translations - MOTION.translations).max() < 0.15


@pytest.mark.parametrize("more", [KINDS["com"], FLOOR, KINDS["hips"]])
def test_where_the_body_shall_go_elsewhere_it_is_not_held_back(more):
    assert not prepare(MOTION, [ASIDE, more], HUMAN, LayeredSettings())[0].asked.pulls_root


@pytest.mark.parametrize("ahead", [0.2, 2.0])
def test_a_body_is_drawn_back_no_more_where_its_hand_is_wanted_farther_away(ahead):
    low = path(MOTION, "RightHand")[0] + np.array([0.0, 0.0, ahead])
    places = low, low + np.array([0.0, 0.3, 0.0])
    goals = [
        Position(name="p", effector=end("RightHand"), points=(ControlPoint("hold", 0, FRAMES - 1, place),), yields=True)
        for place in places
    ]
    one, other = (each.positions for each in edited(MOTION, goals, LayeredSettings(), body=HUMAN).errors)
    assert (np.abs(one + other - 0.3) < 0.03).all()
