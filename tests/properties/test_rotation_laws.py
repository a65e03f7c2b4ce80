"""The laws of the rotation algebra, over many shapes, near the identity and near half a turn."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from motionedit.core import rotations as rot
from motionedit.core.euler import other_solution, solve_angles
from motionedit.core.slerp import slerp

SHAPES = nps.array_shapes(min_dims=0, max_dims=3, max_side=4)
PARTS = st.floats(-1.0, 1.0, width=64)


@st.composite
def vectors(draw, shape=None):
    """Return rotation vectors of at most half a turn, often tiny, often near half a turn."""
    shape = draw(SHAPES) if shape is None else shape
    direction = draw(nps.arrays(np.float64, (*shape, 3), elements=PARTS)) + np.array([0.0, 0.0, 2.0])
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    angles = st.one_of(
        st.floats(0.0, 3.1), st.sampled_from([0.0, 1e-12, 1e-8, 1e-4, 3.14159, np.pi]), st.floats(0.0, 1e-3)
    )
    return direction * draw(nps.arrays(np.float64, (*shape, 1), elements=angles))


@st.composite
def some(draw, count):
    shape = draw(SHAPES)
    return [rot.exp(draw(vectors(shape=shape))) for _ in range(count)]


def assert_same(a, b, atol=1e-13):
    np.testing.assert_allclose(rot.angle_between(a, b), 0.0, atol=atol)


@given(vectors())
def test_log_undoes_exp(v):
    assert_same(rot.exp(rot.log(rot.exp(v))), rot.exp(v), atol=1e-14)
    below = np.linalg.norm(v, axis=-1) < np.pi - 1e-6
    np.testing.assert_allclose(rot.log(rot.exp(v))[below], v[below], atol=1e-14)


@given(some(3))
def test_products_are_associative_and_unit(quaternions):
    a, b, c = quaternions
    assert_same(rot.multiply(rot.multiply(a, b), c), rot.multiply(a, rot.multiply(b, c)))
    np.testing.assert_allclose(np.linalg.norm(rot.multiply(a, b), axis=-1), 1.0, atol=1e-14)


@given(some(1))
def test_the_inverse_and_the_identity(quaternions):
    (a,) = quaternions
    identity = np.broadcast_to(rot.IDENTITY, a.shape)
    assert_same(rot.multiply(a, rot.conjugate(a)), identity)
    assert_same(rot.multiply(a, identity), a)
    assert_same(a, -a)


@given(some(2), vectors(shape=()))
def test_turning_by_a_product_is_turning_twice(quaternions, v):
    a, b = quaternions
    np.testing.assert_allclose(rot.rotate(rot.multiply(a, b), v), rot.rotate(a, rot.rotate(b, v)), atol=1e-13)
    np.testing.assert_allclose(rot.to_matrix(a) @ v, rot.rotate(a, v), atol=1e-13)


@given(some(1))
def test_matrices_come_back(quaternions):
    (a,) = quaternions
    assert_same(rot.from_matrix(rot.to_matrix(a)), a, atol=1e-12)


@given(some(3))
def test_the_angle_between_is_a_distance(quaternions):
    a, b, c = quaternions
    ab, bc, ac = rot.angle_between(a, b), rot.angle_between(b, c), rot.angle_between(a, c)
    np.testing.assert_allclose(ab, rot.angle_between(b, a), atol=1e-14)
    np.testing.assert_allclose(ab, rot.angle_between(rot.multiply(c, a), rot.multiply(c, b)), atol=1e-13)
    assert np.all(ac <= ab + bc + 1e-13)


@given(some(2), st.floats(0.0, 1.0))
def test_slerp_from_either_end_meets(quaternions, t):
    a, b = quaternions
    near = rot.angle_between(a, b) < np.pi - 1e-6
    there = slerp(a, b, np.full(a.shape[:-1], t))
    back = slerp(b, a, np.full(a.shape[:-1], 1.0 - t))
    assert_same(there[near], back[near], atol=1e-9)


@given(some(1), st.permutations([0, 1, 2]))
def test_both_euler_solutions_rebuild_the_rotation(quaternions, axes):
    (a,) = quaternions
    first = solve_angles(np.moveaxis(a, -1, 0), tuple(axes))
    for angles in (first, other_solution(first)):
        assert_same(rot.from_euler(np.moveaxis(angles, 0, -1), axes), a)
