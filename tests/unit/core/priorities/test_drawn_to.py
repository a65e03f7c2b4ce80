"""What the first solve is drawn to: the input, and how a body meets what is asked by itself."""

import numpy as np
import pytest
from person import BODY, ONCE, SKELETON, UP, end, held, held_feet, joint, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.gaze import gaze_of
from motionedit.core.body.stiffness import human_mobility
from motionedit.core.kinematics import forward
from motionedit.core.priorities.drawn_to import drawn_to, turned_at
from motionedit.core.priorities.edit import edit_by_priorities, prepare
from motionedit.core.priorities.kinds import Aim, Position
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.trajectories.positions import ControlPoint
from motionedit.dataclass import replace

FRAMES = 24
MOTION = swaying(FRAMES)
ANATOMY = find_anatomy(SKELETON)
LEAST = replace(BODY, mobility=human_mobility(SKELETON, ANATOMY, travel=0))
LOOKING = replace(LEAST, gaze=gaze_of(SKELETON, ANATOMY, up=UP))
CROUCHING = replace(LOOKING, legs=ANATOMY.legs, bends=find_bends(SKELETON, forward(MOTION), ANATOMY, first=0))
LOWER = held("Head", FRAMES, (0.0, -0.2, 0.0), priority=5)
ASIDE, ACROSS = (3.0, 3.0, 0.6), (-3.0, 2.0, 1.0)


def looking_at(place, first=0, last=FRAMES - 1, name="Head", **more):
    point = ControlPoint("hold", first, last, np.array(place), None)
    return Aim(name="eyes", effector=end(name), points=(point,), **more)


def roll(motion):
    """Return how far the head's side is from level, degrees, shape (F,)."""
    side = rot.rotate(forward(motion).rotations[:, joint("Head")], np.array([1.0, 0.0, 0.0]))
    return np.degrees(np.arcsin(side @ UP))


def referred(*constraints, body=LOOKING):
    return turned_at(MOTION, drawn_to(prepare(MOTION, constraints, body, ONCE)[0].asked))


def test_a_head_that_looks_aside_and_up_stays_level_and_the_feet_stand():
    least, looking = (edit_by_priorities(MOTION, [looking_at(ASIDE)], body, ONCE) for body in (LEAST, LOOKING))
    assert max(errors.angles.max() for edit in (least, looking) for errors in edit.errors) < 1e-4
    own = roll(MOTION)
    assert np.abs(roll(least.motion) - own).max() > 5.0
    assert np.abs(roll(looking.motion) - own).max() < 0.5
    moved = [
        np.linalg.norm(path(edit.motion, "LeftFoot") - path(MOTION, "LeftFoot"), axis=1).max()
        for edit in (least, looking)
    ]
    assert moved[1] < 0.5 * moved[0]


@pytest.mark.parametrize(
    ("body", "name"), [(LEAST, "Head"), (replace(LOOKING, mobility=None), "Head"), (LOOKING, "LeftHand")]
)
def test_it_is_the_input_where_a_body_has_no_way_of_its_own(body, name):
    assert referred(looking_at(ASIDE, name=name), body=body) is MOTION


def test_what_is_overruled_has_no_say():
    below, above = looking_at(ASIDE), looking_at(ACROSS, 8, 15, priority=5)
    alone, first, both = (referred(*each).rotations for each in ([below], [above], [below, above]))
    np.testing.assert_array_equal(both[8:16], first[8:16])
    np.testing.assert_array_equal(both[:8], alone[:8])
    np.testing.assert_array_equal(both[16:], alone[16:])
    assert np.abs(first[8:16] - alone[8:16]).max() > 0.1


def lean(motion):
    """Return how far the chest is turned from where it is in the input, degrees, the most of all frames."""
    turns = [forward(each).rotations[:, joint("Spine1")] for each in (MOTION, motion)]
    return np.degrees(rot.angle_between(*turns).max())


def test_a_head_that_shall_be_lower_is_so_by_the_knees():
    asked = [*held_feet(FRAMES), LOWER]
    least, crouching = (edit_by_priorities(MOTION, asked, body, ONCE) for body in (LOOKING, CROUCHING))
    for edit in (least, crouching):
        assert max(errors.positions.max() for errors in edit.errors) < 1e-4
    assert lean(least.motion) > 10.0
    assert lean(crouching.motion) < 0.4 * lean(least.motion)


@pytest.mark.parametrize(
    "asked",
    [
        [LOWER],
        [*held_feet(FRAMES), held("Head", FRAMES, (0.0, 0.2, 0.0))],
        [*held_feet(FRAMES), held("Head", FRAMES, (0.0, -0.2, 0.0), recruit=RecruitRule("levels", levels=2))],
        [*held_feet(FRAMES), held("LeftHand", FRAMES, (0.0, -0.2, 0.0))],
    ],
    ids=["no feet are held", "up", "the root is not recruited", "a hand"],
)
def test_legs_stay_where_the_trunk_need_not_go_down_on_them(asked):
    legs = [joint(name) for name in ("LeftUpLeg", "LeftLeg", "RightLeg")]
    np.testing.assert_allclose(
        referred(*asked, body=CROUCHING).rotations[:, legs], MOTION.rotations[:, legs], atol=1e-9
    )


def test_a_foot_that_shall_be_higher_is_so_by_its_leg():
    foot = held("LeftFoot", FRAMES, (0.0, 0.25, 0.0), priority=5)
    least, drawing = (edit_by_priorities(MOTION, [foot], body, ONCE) for body in (LOOKING, CROUCHING))
    assert max(edit.errors[0].positions.max() for edit in (least, drawing)) < 1e-4
    rises = [
        np.linalg.norm(path(edit.motion, "Spine1") - path(MOTION, "Spine1"), axis=1).max() for edit in (least, drawing)
    ]
    assert rises[0] > 0.08
    assert rises[1] < 0.5 * rises[0]


def test_feet_that_shall_both_be_higher_take_the_body_along():
    feet = [held(name, FRAMES, (0.0, 0.25, 0.0)) for name in ("LeftFoot", "RightFoot")]
    assert referred(*feet, body=CROUCHING) is MOTION


def test_legs_bend_as_far_as_feet_are_held():
    feet = [held_within(name, 12, 16, ease=6) for name in ("LeftFoot", "RightFoot")]
    low = rot.angle_between(referred(*feet, LOWER, body=CROUCHING).rotations, MOTION.rotations)[:, joint("LeftLeg")]
    assert low[:6].max() < 1e-6
    assert low[12:17].min() > 0.3
    assert (np.diff(low[6:13]) > 0.0).all()


def held_within(name, first, last, *, ease):
    point = ControlPoint("hold", first, last, None, np.zeros(3))
    return Position(name=name, effector=end(name), priority=10, points=(point,), ease_in=ease, ease_out=ease)
