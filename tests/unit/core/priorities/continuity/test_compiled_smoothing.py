"""Compiled kinematics and smoothing of whole motions beside numpy's."""

import numpy as np
import pytest
from random_bodies import by_numpy, motion_of

from motionedit.core import rotations as rot
from motionedit.core.body.hinges import plain_hinge
from motionedit.core.compiled import solver_name
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.priorities.continuity.displacement import smoothed_displacement

pytestmark = pytest.mark.skipif(solver_name() == "numpy", reason="no compiled solver here")


@pytest.mark.parametrize("joints", [1, 2, 31])
def test_kinematics_are_the_same(patch, joints):
    rng = np.random.default_rng(joints)
    motion = motion_of(rng, joints, 20)
    mine, theirs = forward(motion), by_numpy(patch, lambda: forward(motion))
    np.testing.assert_allclose(mine.positions, theirs.positions, atol=1e-14)
    np.testing.assert_allclose(mine.rotations, theirs.rotations, atol=1e-14)


@pytest.mark.parametrize(("first", "sigma"), [(0, 1.5), (2, 3.0), (0, 40.0), (19, 1.0), (0, 0.0)])
def test_smoothing_is_the_same(patch, first, sigma):
    rng = np.random.default_rng(1)
    before = motion_of(rng, 6, 20)
    turned = before.rotations.copy()
    turned[4:9, 2] = rot.multiply(turned[4:9, 2], rot.exp(rng.normal(scale=1.5, size=(5, 3))))
    after = Motion(before.skeleton, turned, before.translations + rng.normal(size=(20, 1, 3)), before.frame_time)
    mine = smoothed_displacement(before, after, sigma=sigma, first=first)
    theirs = by_numpy(patch, lambda: smoothed_displacement(before, after, sigma=sigma, first=first))
    np.testing.assert_allclose(mine.rotations, theirs.rotations, atol=1e-13)
    np.testing.assert_allclose(mine.translations, theirs.translations, atol=1e-13)
    still = [j for j in range(6) if j != 2]
    np.testing.assert_array_equal(mine.rotations[:, still], before.rotations[:, still])


def two_alike(patch, before, after, **how):
    """Return a smoothed displacement as C has it, numpy's being the same."""
    mine = smoothed_displacement(before, after, **how)
    theirs = by_numpy(patch, lambda: smoothed_displacement(before, after, **how))
    np.testing.assert_allclose(mine.rotations, theirs.rotations, atol=1e-13)
    return mine


@pytest.mark.parametrize("first", [0, 3])
def test_hinges_are_smoothed_about_their_axes_alike(patch, first):
    rng = np.random.default_rng(2)
    before = motion_of(rng, 6, 40)
    axes = rng.normal(size=(2, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    hinges = tuple(plain_hinge(joint, axis, (-9.0, 9.0)) for joint, axis in zip((2, 4), axes, strict=True))
    turned = before.rotations.copy()
    for hinge in hinges:
        by = rng.normal(scale=0.4, size=(40, 1)) * hinge.axis
        turned[:, hinge.joint] = rot.multiply(rot.exp(by), turned[:, hinge.joint])
    turned[:, 3] = rot.multiply(turned[:, 3], rot.exp(rng.normal(scale=0.4, size=(40, 3))))
    after = Motion(before.skeleton, turned, before.translations, before.frame_time)
    smooth = two_alike(patch, before, after, sigma=2.0, first=first, hinges=hinges)
    for hinge in hinges:
        v = rot.log(rot.multiply(smooth.rotations[:, hinge.joint], rot.conjugate(before.rotations[:, hinge.joint])))
        assert np.linalg.norm(np.cross(v, hinge.axis), axis=1).max() < 1e-12
        assert 0.0 < np.abs(np.diff(v @ hinge.axis)[first:]).max() < 0.3
    # Of a joint that is no hinge the displacement is another on that side: taking it for one would show.
    assert (
        rot.angle_between(smooth.rotations, two_alike(patch, before, after, sigma=2.0, first=first).rotations).max()
        > 0.0
    )


@pytest.mark.parametrize("is_hinge", [False, True])
def test_a_change_that_passes_half_a_turn_is_smoothed_through_it(patch, is_hinge):
    rng = np.random.default_rng(3)
    before = motion_of(rng, 4, 60)
    axis = np.array([0.6, 0.0, 0.8])
    # From 1 to 5.5 rad and on: a rotation vector would turn round at pi.
    angles = np.linspace(1.0, 5.5, 60)
    turned, turns = before.rotations.copy(), rot.exp(angles[:, None] * axis)
    turned[:, 2] = rot.multiply(turns, turned[:, 2]) if is_hinge else rot.multiply(turned[:, 2], turns)
    after = Motion(before.skeleton, turned, before.translations, before.frame_time)
    hinges = (plain_hinge(2, axis, (-9.0, 9.0)),) if is_hinge else ()
    smooth = two_alike(patch, before, after, sigma=2.0, first=0, hinges=hinges)
    # A straight line stays as it is.
    assert rot.angle_between(smooth.rotations[:, 2], turned[:, 2]).max() < 1e-7
