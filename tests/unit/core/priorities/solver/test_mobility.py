"""How readily joints give: the change is the least in their measure, and none is the paper's."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from person import BODY, SKELETON, edited, held, joint, path, swaying

from motionedit.core import rotations as rot
from motionedit.core.kinematics import forward
from motionedit.core.priorities.recruiting import RecruitRule
from motionedit.core.priorities.settings import LayeredSettings, Passes

FRAMES = 6
MOTION = swaying(FRAMES)
ARM = [joint(name) for name in ("Spine", "Spine1", "RightShoulder", "RightArm", "RightForeArm")]
RECRUIT = RecruitRule("joints", joints=tuple(ARM))
FINE = LayeredSettings(smoothing=Passes(0), max_iterations=200)


def reach(mobility, settings=FINE, **body):
    hand = held("RightHand", FRAMES, (0.1, 0.15, 0.2), recruit=RECRUIT)
    return edited(MOTION, [hand], settings, replace(BODY, mobility=mobility, **body))


def turns(edit):
    """Return the changes of the arm's joints as rotation vectors in the world, shape (F, K, 3)."""
    local = rot.log(rot.multiply(edit.motion.rotations, rot.conjugate(MOTION.rotations)))[:, ARM]
    parents = [int(SKELETON.parents[j]) for j in ARM]
    return rot.rotate(forward(edit.motion).rotations[:, parents], local)


@pytest.mark.parametrize("solver", ["compiled", "numpy"])
@given(seed=st.integers(0, 1000))
@settings(max_examples=10, deadline=None)
def test_the_change_is_the_least_that_reaches_each_joints_by_the_square_of_its_mobility(solver, seed):
    mobility = np.ones(len(SKELETON))
    mobility[ARM] = np.random.default_rng(seed).uniform(0.3, 1.0, size=len(ARM))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MOTIONEDIT_SOLVER", solver if solver == "numpy" else "")
        edit = reach(mobility)
    assert edit.errors[0].positions.max() < 1e-6
    places, hand = forward(edit.motion).positions[:, ARM], path(edit.motion, "RightHand")
    # Lagrange: w / m^2 of all joints is J^T l, where a turn w of a joint at p moves the hand at x by w x (x - p).
    weighed = (turns(edit) / mobility[ARM, None] ** 2).reshape(FRAMES, -1)
    for frame in range(FRAMES):
        J = np.concatenate([np.cross(np.eye(3), hand[frame] - p) for p in places[frame]])
        _, rest, *_ = np.linalg.lstsq(J, weighed[frame], rcond=None)
        assert np.sqrt(rest.sum()) < 2e-3 * np.linalg.norm(weighed[frame])


def test_where_all_joints_give_alike_it_is_the_papers_measure_to_the_last_bit():
    one, other = reach(None), reach(np.ones(len(SKELETON)))
    assert one.motion.rotations.tobytes() == other.motion.rotations.tobytes()
    alike = reach(np.full(len(SKELETON), 0.5), root_mobility=0.5)
    assert rot.angle_between(one.motion.rotations, alike.motion.rotations).max() < 1e-3


@pytest.mark.parametrize("name", ["Spine", "RightShoulder", "RightArm", "RightForeArm"])
def test_a_stiffer_joint_turns_less_and_the_others_more(name):
    found = []
    for mobility in (1.0, 0.6, 0.3):
        each = np.ones(len(SKELETON))
        each[joint(name)] = mobility
        found.append(np.linalg.norm(turns(reach(each)), axis=2).mean(axis=0))
    k = ARM.index(joint(name))
    found = np.array(found)
    assert (np.diff(found[:, k]) < 0.0).all()
    assert (np.diff(np.delete(found, k, axis=1).sum(axis=1)) > 0.0).all()
