"""Nothing of some points goes below a height: limits, which are rows of one side."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from person import FEET, HARD, SKELETON, UP, edited, end, held, held_feet, joint, path, swaying
from scipy.optimize import minimize

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import find_masses
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import Effector, forward
from motionedit.core.measure import Level
from motionedit.core.motion import Motion
from motionedit.core.priorities.kinds import CenterOfMass, Floor
from motionedit.core.priorities.kinds.constraint import Movable
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import Body, LayeredSettings, Passes
from motionedit.core.priorities.trajectories.positions import ControlPoint
from motionedit.core.skeleton import Skeleton

FRAMES = 12
MM = 1e-3
MOTION = swaying(FRAMES)
LOWEST = {name: path(MOTION, name)[:, 1].min() for name in SKELETON.names}
LEGS = RecruitRule("joints", joints=tuple(map(joint, SKELETON.names[2:5] + SKELETON.names[7:10])))


def floor(height, names=FEET, priority=9, **more):
    points = tuple(end(name) for name in names)
    return Floor(name="floor", priority=priority, effector=points, height=Level(UP, height), **more)


def heights(motion, names=FEET):
    return np.stack([path(motion, name)[:, 1] for name in names], axis=1)


def test_a_floor_that_nothing_touches_leaves_every_frame_as_it_was():
    edit = edited(MOTION, [floor(LOWEST["RightToeBase"] - 1e-6)], LayeredSettings(smoothing=Passes(2, 1.0)))
    assert not edit.touched.any()
    assert not edit.moved.any()
    assert edit.iterations.max() == 1
    np.testing.assert_array_equal(edit.errors[0].positions, 0.0)


def test_a_sunk_foot_is_lifted_to_the_floor_and_the_other_stays():
    height = LOWEST["RightToeBase"] + 0.012
    assert height < LOWEST["LeftToeBase"]
    edit = edited(MOTION, [floor(height, recruit=LEGS)], LayeredSettings(smoothing=Passes(3, 1.0)))
    found = heights(edit.motion)
    np.testing.assert_allclose(found[:, FEET.index("RightToeBase")], height, atol=0.01 * MM)
    np.testing.assert_allclose(found[:, :2], heights(MOTION)[:, :2], atol=1e-12)
    touched = {SKELETON.names[j] for j in np.flatnonzero(edit.touched.any(axis=0))}
    assert touched <= {"RightUpLeg", "RightLeg", "RightFoot"}
    assert edit.errors[0].positions.max() < 0.01 * MM
    assert edit.converged.all()


def test_only_frames_in_which_something_is_below_are_solved_anew():
    rise = np.linspace(-0.02, 0.02, FRAMES)[:, None, None] * UP
    motion = Motion(SKELETON, MOTION.rotations, MOTION.translations + rise, MOTION.frame_time)
    edit = edited(motion, [floor(LOWEST["RightToeBase"], recruit=LEGS)])
    sunk = heights(motion)[:, FEET.index("RightToeBase")] < LOWEST["RightToeBase"]
    assert 0 < np.count_nonzero(sunk) < FRAMES
    np.testing.assert_array_equal(edit.touched.any(axis=1), sunk)


@pytest.mark.parametrize("far", [-0.3, -1.0])
def test_no_layer_below_pushes_a_point_through_the_floor(far):
    names = ("LeftHand", "RightHand", "RightForeArm")
    down = ControlPoint("hold", 0, FRAMES - 1, None, far * UP)
    below = [held("RightHand", FRAMES, (0.2, far, 0.3), priority=2), CenterOfMass(name="com", points=(down,))]
    free = edited(MOTION, [*held_feet(FRAMES), *below])
    assert heights(free.motion, names).min() < 0.85
    edit = edited(MOTION, [*held_feet(FRAMES), floor(0.9, names), *below])
    assert heights(edit.motion, names).min() > 0.9 - 0.01 * MM
    # It is held down on the floor, not away from it.
    hard = edited(MOTION, [*held_feet(FRAMES), floor(0.9, names), *below], HARD)
    np.testing.assert_allclose(heights(hard.motion, ["RightHand"]), 0.9, atol=0.1 * MM)
    assert max(each.positions.max() for each in edit.errors[:4]) < 0.01 * MM


def test_a_floor_gives_way_to_what_is_above_it():
    low = held("RightToeBase", FRAMES, (0.0, -0.05, 0.0), priority=20)
    edit = edited(MOTION, [low, floor(LOWEST["RightToeBase"])])
    assert edit.errors[0].positions.max() < 0.01 * MM
    np.testing.assert_allclose(edit.errors[1].positions, 0.05, atol=0.01 * MM)
    np.testing.assert_allclose(edit.errors[1].places, path(edit.motion, "RightToeBase") + 0.05 * UP, atol=1e-5)
    assert edit.converged.all()


def test_a_foot_on_the_floor_is_free_to_go_up():
    for sunk in (0.0, 1e-9, 0.01):
        step = held("RightToeBase", FRAMES, (0.0, 0.1, 0.1), priority=3)
        edit = edited(MOTION, [floor(LOWEST["RightToeBase"] + sunk), step])
        assert edit.errors[1].positions.max() < 0.01 * MM
        assert edit.converged.all()
        # As if there were no floor.
        alone = edited(MOTION, [step])
        assert np.degrees(rot.angle_between(alone.motion.rotations, edit.motion.rotations)).max() < 0.05


def test_a_floor_counts_the_deepest_point_and_is_where_it_is_in_any_direction():
    up = np.array([0.0, 0.6, 0.8])
    names = ("LeftHand", "RightToeBase")
    deepest = np.min([path(MOTION, name) @ up for name in names], axis=0)
    stiff = Floor(
        name="floor",
        effector=tuple(map(end, names)),
        height=Level(up, deepest.max() + 0.05),
        recruit=RecruitRule("joints", joints=(joint("Head"),)),
    )
    edit = edited(MOTION, [stiff])
    np.testing.assert_allclose(edit.errors[0].positions, deepest.max() + 0.05 - deepest)
    lifted = edited(MOTION, [Floor(name="f", effector=stiff.effector, height=stiff.height)])
    assert lifted.errors[0].positions.max() < 0.01 * MM


def test_a_floor_recruits_the_chains_of_all_its_points():
    movable = Movable(SKELETON, 0, frozenset(range(len(SKELETON))))
    asked = floor(0.0, ("LeftFoot", "RightHand"))
    found = asked.recruits(movable)
    wanted = {*SKELETON.chain(joint("LeftLeg")), *SKELETON.chain(joint("RightForeArm"))}
    assert (found.joints, found.root) == (wanted, True)
    assert found == asked.moved_by(movable)
    toe = Floor(name="f", effector=(end("LeftToeBase", (0.0, 0.0, 0.06)),), height=Level(UP))
    assert joint("LeftToeBase") in toe.recruits(movable).joints
    assert asked.words(SKELETON.names) == "floor under LeftFoot, RightHand"


def chain_of(seed, joints=5):
    """Return one frame of a chain of random bones that hangs on a root which stays."""
    rng = np.random.default_rng(seed)
    turns = ("Zrotation", "Xrotation", "Yrotation")
    channels = (("Xposition", "Yposition", "Zposition", *turns), *[turns] * (joints - 1))
    offsets = np.vstack([np.zeros(3), 0.25 * rng.normal(size=(joints - 1, 3))])
    skeleton = Skeleton(tuple("ABCDEFGH"[:joints]), np.arange(-1, joints - 1), offsets, channels)
    rotations = rot.exp(rng.normal(scale=0.5, size=(1, joints, 3)))
    return Motion(skeleton, rotations, np.zeros((1, 1, 3)), 0.01)


def of_chain(motion, height):
    """Return a chain lifted from the third joint on, and its body."""
    count = len(motion.skeleton)
    points = tuple(Effector(j, np.zeros(3)) for j in range(2, count))
    turning = RecruitRule("joints", joints=tuple(range(count - 1)))
    body = Body(find_masses(motion.skeleton, find_anatomy(motion.skeleton)), (), 0, 0)
    return edited(motion, [Floor(name="floor", effector=points, height=Level(UP, height), recruit=turning)], body=body)


def least_turn(motion, height):
    """Return the least sum of squared turns that lifts a chain, found by SciPy."""
    count = 3 * (len(motion.skeleton) - 1)

    def lacks(x):
        rotations = motion.rotations.copy()
        rotations[0, :-1] = rot.multiply(rot.exp(x.reshape(-1, 3)), rotations[0, :-1])
        moved = Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)
        return forward(moved).positions[0, 2:, 1] - height

    found = minimize(
        lambda x: x @ x,
        np.zeros(count),
        jac=lambda x: 2.0 * x,
        constraints=[{"type": "ineq", "fun": lacks}],
        method="SLSQP",
        options={"maxiter": 300, "ftol": 1e-13},
    )
    return found.fun if found.success and lacks(found.x).min() > -1e-6 else None


def turned(motion, edit):
    return np.sum(rot.log(rot.multiply(edit.motion.rotations, rot.conjugate(motion.rotations))) ** 2)


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.floats(0.02, 0.15))
def test_a_chain_of_any_shape_is_lifted_above_the_floor(seed, lift):
    motion = chain_of(seed)
    lowest = forward(motion).positions[0, 2:, 1].min()
    edit = of_chain(motion, lowest + lift)
    # What can be lifted a little farther is not at the end of its reach.
    if least_turn(motion, lowest + lift + 0.02) is not None:
        assert edit.errors[0].positions.max() < 0.1 * MM


def test_chains_are_lifted_by_hardly_more_turning_than_the_least():
    ratios = []
    for seed in range(30):
        motion = chain_of(seed)
        height = forward(motion).positions[0, 2:, 1].min() + 0.08
        least = least_turn(motion, height)
        if least is not None and least > 1e-4:
            ratios.append(turned(motion, of_chain(motion, height)) / least)
    assert len(ratios) > 20
    assert np.median(ratios) == pytest.approx(1.0, abs=0.01)
    assert np.quantile(ratios, 0.9) < 1.2
