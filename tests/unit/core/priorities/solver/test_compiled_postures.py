"""Postures of many joints, which the compiled solver takes out of the system, beside numpy, which factors them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from person import BODY, SKELETON, edited, held, held_feet, joint, swaying
from random_bodies import (
    FEASIBLE,
    INFEASIBLE,
    assert_no_neighbour_changes_a_bit,
    body_of,
    by_numpy,
    constraints_of,
    difference,
    is_met,
    motion_of,
    others_are_same,
)

from motionedit.core.arrays import frozen
from motionedit.core.compiled import solver_name
from motionedit.core.priorities.edit import edit_by_priorities
from motionedit.core.priorities.kinds import CenterOfMass, Posture
from motionedit.core.priorities.settings import LayeredSettings, PaperFilter, Passes

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="no compiled solver here")

# And where a direction is no freedom for either: what they leave out is askew by as much as the tolerance of the rank.
IN_DOUBT = 1e-5
SETTING = LayeredSettings(smoothing=Passes(0), max_iterations=9)
SEEDS = {"seed": st.integers(0, 2**32 - 1), "joints": st.integers(10, 18), "count": st.integers(0, 3)}
PATIENT = {"deadline": None, "suppress_health_check": [HealthCheck.function_scoped_fixture]}


def postures_of(rng, joints):
    """Return one or two postures of most joints, which may share some, anywhere among the layers."""
    found = []
    for i in range(int(rng.integers(1, 3))):
        chosen = rng.choice(np.arange(1, joints), size=int(rng.integers(9, joints)), replace=False)
        own = {"priority": int(rng.integers(0, 6)), "weight": float(rng.uniform(0.3, 3.0))}
        found.append(Posture(name=f"p{i}", joints=tuple(sorted(map(int, chosen))), **own))
    return found


def edit_of(seed, joints, count, **how):
    rng = np.random.default_rng(seed)
    motion = motion_of(rng, joints)
    body, others = body_of(rng, motion), constraints_of(rng, motion, rng.choice([0.02, 0.1]), count)
    others = others[2 * int(rng.integers(2)) :]
    return edit_by_priorities(motion, [*others, *postures_of(rng, joints)], body, replace(SETTING, **how))


# The same examples on every run, as in test_compiled.py.
@given(**SEEDS)
@settings(max_examples=80, derandomize=True, **PATIENT)
def test_both_solvers_hold_joints_alike(patch, seed, joints, count):
    # Nothing gives way: whether something does is told by a threshold, from which rounding may lead anywhere.
    hard = {"smoothing": PaperFilter(0)}
    mine = edit_of(seed, joints, count, **hard)
    theirs = by_numpy(patch, lambda: edit_of(seed, joints, count, **hard))
    np.testing.assert_array_equal(mine.ranks, theirs.ranks)
    assert difference(mine, theirs) < (FEASIBLE if is_met(mine) else INFEASIBLE)
    if is_met(mine):
        np.testing.assert_array_equal(mine.iterations, theirs.iterations)


@given(**SEEDS)
@settings(max_examples=40, **PATIENT)
def test_no_lane_knows_what_its_neighbours_hold(patch, seed, joints, count):
    assert_no_neighbour_changes_a_bit(patch, lambda threads: edit_of(seed, joints, count, threads=threads))


def all_but(*names):
    return tuple(j for j in range(1, len(SKELETON)) if SKELETON.names[j] not in names)


def below_feet_hand_and_com(left_out):
    """Return what is asked with a posture at the bottom, of all joints but the root and some."""
    hand = held("LeftHand", 12, (0.05, 0.1, 0.1), priority=5)
    posture = Posture(name="keep", joints=all_but(*left_out), priority=2)
    return [*held_feet(12), hand, CenterOfMass(name="com", priority=4), posture]


@pytest.mark.parametrize("left_out", [(), ("RightHand",), ("LeftToeBase", "Head")])
def test_a_posture_below_what_hardly_sees_the_other_joints_is_held_alike(patch, left_out):
    """A hand so light hardly moves the centre of mass: whether it does at all is in doubt."""
    motion, asked = swaying(12), below_feet_hand_and_com(left_out)
    mobility = np.where(np.arange(len(SKELETON)) < 6, 0.5, 1.0)
    shares = BODY.masses.shares * np.where(np.arange(len(SKELETON)) == joint("RightHand"), 0.02, 1.0)
    masses = replace(BODY.masses, shares=frozen(shares / shares.sum()))
    body = replace(BODY, masses=masses, mobility=mobility, root_mobility=0.5)
    mine = edited(motion, asked, SETTING, body)
    theirs = by_numpy(patch, lambda: edited(motion, asked, SETTING, body))
    np.testing.assert_array_equal(mine.ranks, theirs.ranks)
    assert difference(mine, theirs) < IN_DOUBT
    others_are_same(patch, lambda: edited(motion, asked, SETTING, body), mine)


def test_what_lies_below_a_posture_of_all_joints_moves_the_root_alone():
    motion = swaying(6)
    keep = Posture(name="keep", joints=tuple(range(len(SKELETON))), priority=9)
    hand = held("LeftHand", 6, (0.1, 0.0, 0.0), priority=3)
    edit = edited(motion, [keep, hand])
    np.testing.assert_allclose(edit.motion.rotations, motion.rotations, atol=1e-12)
    assert edit.errors[1].positions.max() < 1e-5
    assert edit.ranks[0].tolist() == [3 * len(SKELETON), 3]
