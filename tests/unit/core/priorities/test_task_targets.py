"""Targets between others, targets that are moved along, and what they say of what they do not have."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core import rotations as rot
from motionedit.core.priorities.task_targets import Targets, between, moved
from motionedit.core.slerp import slerp


def random_targets(seed, n=9):
    rng = np.random.default_rng(seed)
    return Targets(
        3, 2 + n, rng.normal(size=(n, 3)), rot.exp(rng.normal(scale=0.8, size=(n, 3))), rng.uniform(0.1, 2.0, size=n)
    )


@given(st.integers(0, 1000), st.integers(0, 1000), st.floats(0.0, 1.0))
def test_between_two_targets_every_part_is_on_the_straight_way(one, other, share):
    a, b = random_targets(one), random_targets(other)
    found = between(a, b, np.full(9, share))
    assert (found.first, found.last) == (3, 11)
    np.testing.assert_allclose(found.positions, (1 - share) * a.positions + share * b.positions, atol=1e-12)
    np.testing.assert_allclose(found.lengths, (1 - share) * a.lengths + share * b.lengths, atol=1e-12)
    expected = slerp(a.rotations, b.rotations, np.full(9, share))
    assert rot.angle_between(found.rotations, expected).max() < 1e-7


@given(st.integers(0, 1000), st.integers(0, 1000), st.integers(0, 1000))
def test_targets_are_moved_by_so_much_of_the_way_as_their_share(wanted, one, other):
    targets, before, after = map(random_targets, (wanted, one, other))
    none, half, whole = (moved(targets, before, after, np.full(9, share)) for share in (0.0, 0.5, 1.0))
    np.testing.assert_array_equal(none.positions, targets.positions)
    np.testing.assert_allclose(half.positions - targets.positions, 0.5 * (after.positions - before.positions))
    np.testing.assert_allclose(whole.lengths - targets.lengths, after.lengths - before.lengths)
    turn = rot.multiply(rot.conjugate(before.rotations), after.rotations)
    assert rot.angle_between(whole.rotations, rot.multiply(targets.rotations, turn)).max() < 1e-7
    # What rides where the one motion has it goes to where the other has it.
    rides = moved(before, before, after, np.ones(9))
    np.testing.assert_allclose(rides.positions, after.positions, atol=1e-12)
    assert rot.angle_between(rides.rotations, after.rotations).max() < 1e-7


def test_postures_go_the_way_of_rotations_joint_by_joint():
    one, other = (random_targets(seed).rotations for seed in (1, 2))
    a, b = (Targets(3, 11, postures=np.stack(pair, axis=1)) for pair in ((one, other), (other, one)))
    half = between(a, b, np.full(9, 0.5)).postures
    middle = slerp(one, other, np.full(9, 0.5))
    assert rot.angle_between(half, np.stack((middle, middle), axis=1)).max() < 1e-7
    assert rot.angle_between(moved(a, a, b, np.ones(9)).postures, b.postures).max() < 1e-7
    assert a.within(slice(4, 6)).postures.shape == (2, 2, 4)


def test_targets_say_what_they_do_not_have():
    empty = Targets(0, 3)
    with pytest.raises(ValueError, match="no positions"):
        _ = empty.all_positions
    with pytest.raises(ValueError, match="no lengths"):
        _ = empty.all_lengths
    with pytest.raises(ValueError, match="no rotations"):
        empty.rotations_at(np.arange(2))
