"""Capsules: distances in closed form, by sampling, and between the limbs of a body."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from studies.capsules import Capsule, clearances, limb_pairs, segment_distance

WALK = Path(__file__).resolve().parents[2] / "data" / "walk.bvh"


@pytest.mark.parametrize(
    ("a", "b", "c", "d", "distance"),
    [
        ((-1, 0, 0), (1, 0, 0), (0, -1, 3), (0, 1, 3), 3.0),
        ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), 0.0),
        ((0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 0), 2.0),
        ((0, 0, 0), (1, 0, 0), (4, 4, 0), (9, 4, 0), 5.0),
        ((0, 0, 0), (1, 0, 0), (3, -1, 0), (3, 1, 0), 2.0),
        ((0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0), 5.0),
        ((0, 0, 0), (0, 0, 0), (-1, 2, 0), (1, 2, 0), 2.0),
        ((0, 0, 0), (2, 0, 0), (1, 0, 0), (5, 0, 0), 0.0),
    ],
)
def test_distances_of_segments_in_closed_form(a, b, c, d, distance):
    ends = [np.array(end, dtype=float) for end in (a, b, c, d)]
    assert segment_distance(*ends) == pytest.approx(distance)
    assert segment_distance(*ends[2:], *ends[:2]) == pytest.approx(distance)
    assert segment_distance(*ends[1::-1], *ends[2:]) == pytest.approx(distance)


def test_no_pair_of_points_on_two_segments_is_nearer_than_their_distance():
    a, b, c, d = np.random.default_rng(5).standard_normal((4, 200, 3))
    share = np.linspace(0.0, 1.0, 101)[:, None, None]
    one, other = a + share * (b - a), c + share * (d - c)
    sampled = np.linalg.norm(one[:, None] - other[None], axis=-1).min(axis=(0, 1))
    found = segment_distance(a, b, c, d)
    assert np.all(found <= sampled + 1e-12)
    assert np.all(sampled - found < 0.05)


def test_the_room_between_capsules_is_the_distance_less_both_radii():
    positions = np.array([[(0, 0, 0), (1, 0, 0), (0, 5, 0), (1, 5, 0)], [(0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 0)]])
    pair = (Capsule(0, 1, 1.0), Capsule(2, 3, 1.5))
    assert clearances(positions.astype(float), [pair])[:, 0] == pytest.approx([2.5, -0.5])


def test_the_limbs_of_a_walk_stay_out_of_each_other_until_an_arm_is_pushed_into_the_chest():
    motion = read_clip(WALK).motion
    anatomy = find_anatomy(motion.skeleton)
    positions = forward(motion).positions.copy()
    pairs = limb_pairs(anatomy)
    assert clearances(positions, pairs).min() > 0.0
    (arm, _), trunk = anatomy.arms, 0.5 * (positions[:, anatomy.pelvis] + positions[:, anatomy.chest])
    positions[:, arm.wrist] = trunk
    assert clearances(positions, pairs).min() < -0.05 * anatomy.leg_length


def test_a_body_without_limbs_has_no_pairs(walk_without_limbs):
    assert limb_pairs(walk_without_limbs) == []
    assert clearances(np.zeros((3, 1, 3)), []).shape == (3, 0)


@pytest.fixture
def walk_without_limbs():
    from dataclasses import replace

    return replace(find_anatomy(read_clip(WALK).motion.skeleton), arms=None, legs=None, pelvis=None, chest=None)
