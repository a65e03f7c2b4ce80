"""What the compiled part reads off whole motions is what numpy reads off them."""

from dataclasses import replace

import numpy as np
import pytest
from human import skeleton_of, standing

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.bent_back import bent_back
from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.in_one_loop import read_off
from motionedit.core.body.limits import human_limits
from motionedit.core.body.quality import squared_jerks
from motionedit.core.body.ranges import beyond_range, regions_of
from motionedit.core.body.steps import change_steps, own_steps
from motionedit.core.body.up import _ways_up
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.kinematics import forward

SKELETON = skeleton_of()
BODY = find_anatomy(SKELETON)


def moving(seed, reach):
    """Return a body whose joints turn anyhow, as far as `reach`, rad."""
    rng = np.random.default_rng(seed)
    motion = standing(SKELETON, frames=30)
    turns = rot.exp(reach * rng.normal(size=(30, len(SKELETON), 3)))
    return replace(motion, rotations=turns * rng.choice([-1.0, 1.0], size=(30, len(SKELETON), 1)))


def steps_in(steps):
    return steps.degrees, steps.frames


def read(motion, first):
    """Return all that is read off a motion, as arrays."""
    poses, other = forward(motion), moving(99, 0.8)
    bends = find_bends(SKELETON, poses, BODY, first=first)
    limits = human_limits(motion, poses, BODY, travel=0, first=first)
    squares, *worst = squared_jerks(poses.positions)
    partly = replace(motion, rotations=motion.rotations.copy())
    partly.rotations[:, 1::2] = other.rotations[:, 1::2]
    touched = {"first": first, "touched": np.ones(len(SKELETON), bool)}
    beyond = beyond_range(motion, other, regions_of(SKELETON, BODY, travel=0), **touched)
    back = bent_back(motion, other, BODY, bends, **touched)
    return [
        *(each for bend in bends for each in (bend.axis, bend.straight, bend.upper, bend.lower, bend.angles)),
        *(np.array(bend.bent) for bend in bends),
        *(limits.joints, limits.centers, limits.along, limits.swing, limits.twist),
        *(center_of_mass(poses, find_masses(SKELETON, BODY)), squares, np.array(worst)),
        np.array([(each.joint, each.frame, each.degrees) for each in (*beyond, *back)]),
        *steps_in(own_steps(motion, first=first)),
        *steps_in(change_steps(motion, partly, first=first)),
    ]


@pytest.mark.compiled
@pytest.mark.parametrize("reach", [0.05, 0.5, 3.0])
@pytest.mark.parametrize("first", [0, 2])
def test_what_is_compiled_is_that_of_numpy(reach, first, monkeypatch):
    motion = moving(1, reach)
    found = read(motion, first)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    for one, other in zip(found, read(motion, first), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)


@pytest.mark.compiled
def test_a_limb_that_is_never_bent_is_found_beside_one_that_is(monkeypatch):
    motion = standing(SKELETON, frames=5)
    rotations = motion.rotations.copy()
    rotations[:, BODY.legs[0].knee] = rot.exp(np.array([0.5, 0.0, 0.0]))
    poses = forward(replace(motion, rotations=rotations))
    found = find_bends(SKELETON, poses, BODY, first=0)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    other = find_bends(SKELETON, poses, BODY, first=0)
    assert [bend.joint for bend in found] == [bend.joint for bend in other]
    np.testing.assert_array_equal([bend.axis for bend in found], [bend.axis for bend in other])


@pytest.mark.compiled
@pytest.mark.parametrize("frames", [1, 2, 29, 30])
def test_which_way_a_body_stands_is_that_of_numpy_to_the_bit(frames, monkeypatch):
    positions = forward(moving(frames, 0.5)).positions[:frames].round(2)
    bodies = [BODY, replace(BODY, head=None), replace(BODY, legs=None)]
    found = [_ways_up(body, positions) for body in bodies]
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    for one, body in zip(found, bodies, strict=True):
        np.testing.assert_array_equal(one, _ways_up(body, positions), strict=True)


@pytest.mark.parametrize("frames", range(4))
def test_so_few_frames_have_no_jerk(frames):
    squares, largest, _, _ = squared_jerks(np.ones((frames, 3, 3)))
    assert len(squares) == max(frames - 3, 0)
    assert largest == 0.0


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_joints_and_arrays_that_are_none_are_an_error_and_no_crash():
    turns, places = np.zeros((5, 2, 4)), np.zeros((5, 2, 3))
    bone, bent = np.ones(3), np.ones(4)
    for joints in ([2], [-1]):
        with pytest.raises(ValueError, match=f"no joint {joints[0]}"):
            read_off("cones", None, turns, np.array(joints), bone, bent, shape=(1, 6))
    with pytest.raises(ValueError, match="results has 8 bytes instead of"):
        read_off("cones", None, turns, np.array([0]), bone, bent, shape=(1,))
    with pytest.raises(ValueError, match="results has 24 bytes instead of"):
        read_off("center", places, turns, np.array([0]), np.ones(3), np.ones(1), shape=(1, 3))
    with pytest.raises(ValueError, match="numbers has 16 bytes instead of"):
        read_off("carried", places, turns, np.array([0]), np.zeros(2), shape=(5, 1, 3))
    with pytest.raises(ValueError, match="no positions"):
        read_off("carried", None, turns, np.array([0]), np.zeros(3), shape=(5, 1, 3))
    with pytest.raises(ValueError, match="positions has 24 bytes instead of"):
        read_off("carried", np.zeros(3), turns, np.array([0]), np.zeros(3), shape=(5, 1, 3))
    with pytest.raises(ValueError, match="no such frames"):
        compiled().jerks(places, 2, 2, np.zeros(0))
    with pytest.raises(ValueError, match="results has 8 bytes instead of"):
        compiled().jerks(places, 5, 2, np.zeros(1))
    with pytest.raises(ValueError, match="no such frames"):
        read_off("cones", None, turns, np.array([0]), bone, bent, shape=(1, 6), first=5)
    limbs, how = np.zeros((1, 4), int), (1, 0.1, 0.2, 0.1, 2)
    out = [np.zeros((1, 5), bool), *map(np.zeros, (3, 6, 15, 10))]
    for given, first in (((places, None), 0), ((places, turns), -1)):
        with pytest.raises(ValueError, match="no positions or rotations, or no such frames"):
            compiled().bends(*given, 5, 2, first, limbs, *how, *out)
    for i, name in enumerate(("straight", "axes", "bones", "lower", "turns")):
        with pytest.raises(ValueError, match=f"{name} has 0 bytes instead of"):
            compiled().bends(places, turns, 5, 2, 0, limbs, *how, *out[:i], np.zeros(0), *out[i + 1 :])
    with pytest.raises(ValueError, match="no joint 2"):
        compiled().bends(places, turns, 5, 2, 0, limbs + 2, *how, *out)
    for given, frames in ((None, 5), (places, 0)):
        with pytest.raises(ValueError, match="no positions, or no frames"):
            compiled().median_ways(given, frames, 2, limbs, 1, np.zeros(3))
    with pytest.raises(ValueError, match="no joint 2"):
        compiled().median_ways(places, 5, 2, limbs + 2, 1, np.zeros(3))
    with pytest.raises(ValueError, match="results has 16 bytes instead of"):
        compiled().median_ways(places, 5, 2, limbs, 1, np.zeros(2))
    with pytest.raises(ValueError, match="numbers of other frames"):
        compiled().same(turns, turns[:4], places, places, 5, np.zeros(5, bool))
    with pytest.raises(ValueError, match="frames has 4 bytes instead of"):
        compiled().same(turns, turns, places, places, 5, np.zeros(4, bool))
    with pytest.raises(ValueError, match="rotations has 320 bytes instead of"):
        compiled().turned(turns, turns, 5, 0.1, np.zeros(5, bool))
    with pytest.raises(ValueError, match="rotations has 320 bytes instead of"):
        compiled().stepping(turns, turns, 4, 2, 0.9, np.zeros(2, bool))
    with pytest.raises(ValueError, match="no rotations"):
        compiled().steps(turns, None, 5, 2, 0, np.zeros(2), np.zeros(2, int))
    with pytest.raises(ValueError, match="frames has 8 bytes instead of"):
        compiled().steps(None, turns, 5, 2, 0, np.zeros(2), np.zeros(1, int))
