"""The phases of stances, found at once: the compiled part and numpy agree."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from human import skeleton_of, standing

from motionedit.core import rotations as rot
from motionedit.core.body.contacts import sole_tracks
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.feet.phases import find_phases, leg_paths
from motionedit.core.kinematics import forward

SKELETON = skeleton_of()
BODY = find_anatomy(SKELETON)
FRAMES = 40
UP = np.array([0.0, 1.0, 0.0])
RULES = (1, 3, 0.1, 0.1, 0.0), (2, 6, 0.0)


def poses_of(rng, *, reach):
    """Return a body that turns a little more at every frame, by `reach` (rad) at the most."""
    motion = standing(SKELETON, frames=FRAMES)
    turns = np.cumsum(rng.normal(scale=reach / FRAMES, size=(FRAMES, len(SKELETON), 3)), axis=0)
    return forward(replace(motion, rotations=rot.multiply(motion.rotations, rot.exp(turns))))


def stands(rng, points):
    """Return stands of each of so many points that follow each other, in the order of their first frames."""
    found = []
    for p in range(points):
        edges = np.unique(rng.integers(0, FRAMES + 1, size=8)).tolist()
        some = [pair for pair in pairwise(edges) if rng.random() < 0.7]
        found += [(p, a, b - 1, 0.1 * a) for a, b in some]
    return sorted(found, key=lambda stand: (stand[1], stand[0]))


def legs_by_toes():
    """Return the body with toes of its own, with none, and with ankles whose ends stand for them."""
    without = [replace(leg, toe=None) for leg in BODY.legs]
    ended = [replace(leg, tip=(0.1, 0.02, 0.2)) for leg in without]
    return {"toes": BODY, "none": replace(BODY, legs=tuple(without)), "ends": replace(BODY, legs=tuple(ended))}


@pytest.mark.compiled
@pytest.mark.parametrize("feet", ["toes", "none", "ends"])
def test_compiled_legs_go_as_those_of_numpy(feet, monkeypatch):
    poses, body = poses_of(np.random.default_rng(3), reach=2.0), legs_by_toes()[feet]
    found = leg_paths(poses, body)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(found, leg_paths(poses, body), strict=True)


@pytest.mark.parametrize("feet", ["toes", "none", "ends"])
def test_toes_are_where_the_soles_are(feet):
    poses, body = poses_of(np.random.default_rng(4), reach=2.0), legs_by_toes()[feet]
    paths, tracks = leg_paths(poses, body), sole_tracks(poses, body)
    ankle, turn, toe = paths[..., :3], paths[..., 3:7], paths[..., 7:10]
    places = ankle + rot.rotate(turn, toe)
    expected = ankle if feet == "none" else tracks[:, 1::2]
    np.testing.assert_allclose(places, expected, atol=1e-12)


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(40))
def test_compiled_phases_are_those_of_numpy(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    # Some bodies stand nearly still, so that much of their plants settles, and legs reach, or are too short.
    poses = poses_of(rng, reach=float(rng.choice([0.02, 0.3, 2.0])))
    tracks, legs = sole_tracks(poses, BODY), leg_paths(poses, BODY)
    legs[..., 13] *= rng.uniform(0.95, 1.02, size=legs.shape[:2])
    asked = stands(rng, len(BODY.sole_points)) if seed else []
    how = {"up": UP, "frame_time": 1.0 / float(rng.choice([30, 60, 240]))}
    found = find_phases(tracks, legs, BODY, asked, **how)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    assert found == find_phases(tracks, legs, BODY, asked, **how)


def test_a_body_without_legs_has_no_paths_and_no_phases():
    poses, body = poses_of(np.random.default_rng(5), reach=1.0), replace(BODY, legs=None)
    paths = leg_paths(poses, body)
    assert paths.shape == (FRAMES, 0, 14)
    assert find_phases(sole_tracks(poses, body), paths, body, [], up=UP, frame_time=0.01) == []


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_plants_and_joints_that_are_none_are_an_error_and_no_crash():
    tracks, legs, sizes = np.zeros((5, 4, 3)), np.zeros((5, 2, 14)), (5, 4, 2, 1, 1.0, 0.01)
    for span in (
        (0, 0, 0, 0, 5),
        (0, 0, 0, -1, 2),
        (0, 0, 0, 3, 2),
        (2, 0, 0, 0, 1),
        (0, 0, 4, 0, 1),
        (0, 0, -1, 0, 1),
    ):
        with pytest.raises(ValueError, match="plant 0 is at no frames, or of no point"):
            compiled().phases(tracks, UP, legs, np.array([span]), *sizes, *RULES)
    plant = np.array([(0, 0, 0, 0, 1)])
    with pytest.raises(ValueError, match="legs has 1120 bytes instead of"):
        compiled().phases(tracks, UP, legs, plant, 5, 4, 3, 1, 1.0, 0.01, *RULES)
    with pytest.raises(ValueError, match="no frames around one"):
        compiled().phases(tracks, UP, legs, plant, *sizes, (0, *RULES[0][1:]), RULES[1])
    places, turns = np.zeros((5, 3, 3)), np.zeros((5, 3, 4))
    for joints in ((0, 1, 2, 3), (0, 1, -1, 2), (0, 1, 2, -2)):
        with pytest.raises(ValueError, match="no joint"):
            compiled().leg_paths(places, turns, 5, 3, np.array([joints]), UP, 1, 1.0, np.zeros((5, 14)))
    with pytest.raises(ValueError, match="paths has 8 bytes instead of"):
        compiled().leg_paths(places, turns, 5, 3, np.array([(0, 1, 2, -1)]), UP, 1, 1.0, np.zeros(1))
