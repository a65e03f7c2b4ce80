"""How a body looks somewhere by itself: about the vertical, its head level."""

import numpy as np
import pytest
from human import skeleton_of, standing

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.gaze import gaze_of

SKELETON = skeleton_of()
UP, AHEAD, LEFT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
GAZE = gaze_of(SKELETON, find_anatomy(SKELETON), up=UP)
CHAIN = SKELETON.chain(SKELETON.names.index("Head")).tolist()
NAMES = [SKELETON.names[joint] for joint in CHAIN]


def toward(aside, height):
    """Return unit directions so many degrees to the left and above the level, shape (n, 3)."""
    aside, height = np.broadcast_arrays(np.radians(aside), np.radians(height))
    level = np.cos(height)
    return np.stack((level * np.sin(aside), np.sin(height), level * np.cos(aside)), axis=-1).reshape(-1, 3)


def turned(goals, weights=None, ahead=AHEAD):
    """Return the world rotations of the chain of one who stands, by name, each shape (n, 4)."""
    count = len(goals)
    weights = np.ones(len(CHAIN)) if weights is None else weights
    looks = np.broadcast_to(ahead, (count, 3))
    local = GAZE.turned(standing(SKELETON, count), slice(0, count), CHAIN, weights, looks, goals)
    world = local[:, 0]
    found = {NAMES[0]: world}
    for k in range(1, len(CHAIN)):
        world = found[NAMES[k]] = rot.multiply(world, local[:, k])
    return found


def about_up(rotations):
    """Return how far rotations turn what looked ahead to the left, degrees."""
    look = rot.rotate(rotations, AHEAD)
    return np.degrees(np.arctan2(look @ LEFT, look @ AHEAD))


@pytest.mark.parametrize(("aside", "height"), [(0.0, 30.0), (60.0, 0.0), (-90.0, 25.0), (120.0, -40.0)])
def test_a_head_looks_at_its_goal_and_stays_level(aside, height):
    goals = toward(aside, height)
    head = turned(goals)["Head"]
    np.testing.assert_allclose(rot.rotate(head, AHEAD), goals, atol=1e-12)
    np.testing.assert_allclose(rot.rotate(head, LEFT) @ UP, 0.0, atol=1e-12)


def test_the_back_turns_about_the_vertical_and_half_as_far_as_the_neck():
    found = turned(toward(15.0, 20.0))
    np.testing.assert_allclose(rot.rotate(found["Spine1"], UP), [UP], atol=0.01)
    assert about_up(found["Spine1"]) == pytest.approx(5.0, abs=0.2)
    assert about_up(found["Spine"]) == pytest.approx(2.5, abs=0.1)
    assert about_up(found["Hips"]) == pytest.approx(0.0, abs=0.05)


def test_what_is_beyond_the_neck_and_the_back_is_left_to_the_hips():
    found = turned(toward(130.0, 0.0))
    hips, chest, head = (about_up(found[name])[0] for name in ("Hips", "Spine1", "Head"))
    assert head == pytest.approx(130.0)
    assert 45.0 < head - chest < 50.0
    assert 35.0 < chest - hips < 40.0


def test_joints_without_weight_keep_their_turns():
    weights = np.array([name in ("Neck", "Head") for name in NAMES], dtype=float)
    found = turned(toward(30.0, 10.0), weights)
    assert about_up(found["Spine1"]) == pytest.approx(0.0)
    assert about_up(found["Head"]) == pytest.approx(20.0, abs=0.2)


OVER = np.linspace(-90.0, 90.0, 361)


@pytest.mark.parametrize(
    ("aside", "height"),
    [(np.linspace(-180.0, 180.0, 721), 10.0), (40.0, OVER), (200.0, OVER)],
    ids=["all around", "over the top", "over the top behind"],
)
def test_nothing_steps_where_a_goal_goes_around(aside, height):
    for rotations in turned(toward(aside, height)).values():
        assert np.degrees(rot.angle_between(rotations[:-1], rotations[1:]).max()) < 8.0


def test_who_looks_straight_up_is_left_alone():
    for rotations in turned(toward(50.0, 0.0), ahead=UP).values():
        np.testing.assert_array_equal(rotations, [rot.IDENTITY])
