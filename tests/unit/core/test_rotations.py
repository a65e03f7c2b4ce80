"""Rotations agree with closed forms and with scipy, near 0 and near pi too."""

from itertools import permutations, product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.slerp import slerp, slerp_frames

ORDERS = ["".join(order) for order in permutations("XYZ")]
ANGLES = [0.0, 1e-300, 1e-12, 9.9e-5, 1.01e-4, 0.3, np.pi / 2, np.pi - 1e-9, np.pi]
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0


@pytest.fixture
def rng():
    return np.random.default_rng(11)


def random_quaternions(rng, *shape):
    return rot.normalize(rng.normal(size=(*shape, 4)))


def scipy_of(q):
    return Rotation.from_quat(np.reshape(q, (-1, 4)), scalar_first=True)


def same_rotation(a, b, *, atol=1e-14):
    np.testing.assert_allclose(rot.angle_between(a, b), 0.0, atol=atol)


@pytest.mark.parametrize("angle", ANGLES)
def test_exp_and_log_have_their_closed_forms(angle):
    q = rot.exp(angle * AXIS)
    np.testing.assert_allclose(q[0], np.cos(angle / 2), atol=4e-16)
    np.testing.assert_allclose(q[1:], np.sin(angle / 2) * AXIS, rtol=1e-15, atol=1e-300)
    back = rot.log(q)
    np.testing.assert_allclose(back, angle * AXIS, rtol=2e-15, atol=1e-300)
    np.testing.assert_allclose(rot.log(-q), back, rtol=2e-15, atol=1e-15)


def test_log_of_any_sign_is_at_most_half_a_turn(rng):
    q = random_quaternions(rng, 200)
    np.testing.assert_allclose(rot.log(-q), rot.log(q), atol=1e-15)
    assert np.linalg.norm(rot.log(q), axis=-1).max() <= np.pi + 1e-15
    np.testing.assert_allclose(rot.log(q), scipy_of(q).as_rotvec(), atol=1e-14)


def test_products_and_inverses_are_scipys(rng):
    a, b = random_quaternions(rng, 50), random_quaternions(rng, 50)
    same_rotation(rot.multiply(a, b), (scipy_of(a) * scipy_of(b)).as_quat(scalar_first=True))
    same_rotation(rot.conjugate(a), scipy_of(a).inv().as_quat(scalar_first=True))
    v = rng.normal(size=(50, 3))
    np.testing.assert_allclose(rot.rotate(a, v), scipy_of(a).apply(v), atol=1e-14)
    np.testing.assert_allclose(rot.angle_between(a, b), (scipy_of(a).inv() * scipy_of(b)).magnitude(), atol=1e-14)


def test_cross_and_skew_are_the_cross_product(rng):
    a, b = rng.normal(size=(7, 4, 3)), rng.normal(size=(7, 4, 3))
    np.testing.assert_allclose(rot.cross(a, b), np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose((rot.skew(a) @ b[..., None])[..., 0], np.cross(a, b), atol=1e-15)


def test_matrices_are_scipys_and_come_back_near_half_turns_too(rng):
    half_turns = np.concatenate((np.zeros((50, 1)), rng.normal(size=(50, 3))), axis=1)
    axes = np.eye(4)[1:]
    near = half_turns + 1e-9 * rng.normal(size=(50, 4))
    q = rot.normalize(np.concatenate((random_quaternions(rng, 50), half_turns, axes, near)))
    np.testing.assert_allclose(rot.to_matrix(q), scipy_of(q).as_matrix(), atol=1e-14)
    back = rot.from_matrix(rot.to_matrix(q))
    same_rotation(back, q, atol=1e-13)
    assert (back[:, 0] >= 0.0).all()


@pytest.mark.parametrize("order", ORDERS)
def test_euler_angles_are_bvh_channels_in_their_order(order, rng):
    angles = rng.uniform(-7.0, 7.0, size=(40, 3))
    q = rot.from_euler(angles, rot.euler_axes(order))
    same_rotation(q, Rotation.from_euler(order, angles).as_quat(scalar_first=True))
    np.testing.assert_allclose(np.linalg.norm(q, axis=-1), 1.0, atol=1e-15)


@pytest.mark.parametrize("order", ORDERS)
def test_euler_angles_at_quarter_and_half_turns_keep_full_precision(order):
    angles = np.radians(list(product((-540.0, -180.0, -90.0, 0.0, 90.0, 180.0, 360.0, 1e6), repeat=3)))
    q = rot.from_euler(angles, rot.euler_axes(order))
    same_rotation(q, Rotation.from_euler(order, angles).as_quat(scalar_first=True), atol=1e-9)
    q = rot.from_euler(angles[np.abs(angles).max(axis=1) < 7.0], rot.euler_axes(order))
    assert np.abs(np.linalg.norm(q, axis=-1) - 1.0).max() < 4e-16


def test_fewer_than_three_axes_and_a_single_pose_work(rng):
    angles = rng.uniform(-3.0, 3.0, size=3)
    same_rotation(
        rot.from_euler(angles, (2, 0, 1)),
        rot.multiply(rot.from_euler(angles[:2], (2, 0)), rot.from_euler(angles[2:], (1,))),
    )
    assert rot.from_euler(np.zeros((5, 0)), ()).tolist() == [[1.0, 0.0, 0.0, 0.0]] * 5
    given = rng.uniform(size=(4, 3))
    kept = given.copy()
    rot.from_euler(given, (0, 1, 2))
    np.testing.assert_array_equal(given, kept)


def test_slerp_turns_evenly_along_the_shorter_arc(rng):
    a, b = random_quaternions(rng, 30), random_quaternions(rng, 30)
    for t in (0.0, 0.25, 1.0):
        middle = slerp(a, b, np.full(30, t))
        np.testing.assert_allclose(rot.angle_between(a, middle), t * rot.angle_between(a, b), atol=1e-14)
        np.testing.assert_allclose(rot.angle_between(middle, b), (1 - t) * rot.angle_between(a, b), atol=1e-14)


def frames_of(rng):
    """Return rotations (F, J, 4), two of them with no way between them and one with half a turn's, and places."""
    q = random_quaternions(rng, 40).reshape(8, 5, 4)
    q[3, 1], q[4, 2] = q[2, 1], -q[3, 2]
    q[6, 0] = rot.multiply(q[5, 0], rot.about_axis(1, np.array(np.pi)))
    frames = np.array([0, 2, 2, 3, 5, 6, 7, 7])
    return q, frames, np.array([0.0, 0.25, 0.9, 0.5, 0.5, 1.0, 0.0, 0.5])


def test_places_between_frames_are_those_of_scipy(rng):
    q, frames, t = frames_of(rng)
    found = slerp_frames(q, frames, t)
    for n, (frame, part) in enumerate(zip(frames.tolist(), t.tolist(), strict=True)):
        after = q[min(frame + 1, 7)]
        for j in range(5):
            if n != 4 or j != 0:  # half a turn has two ways
                between = Slerp([0.0, 1.0], scipy_of(np.stack((q[frame, j], after[j]))))(part)
                same_rotation(found[n, j], between.as_quat(scalar_first=True), atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(found, axis=-1), 1.0, atol=1e-15)
    # At a frame it is that frame, to the bit.
    np.testing.assert_array_equal(found[t == 0.0], q[frames[t == 0.0]])


@pytest.mark.compiled
def test_compiled_places_between_frames_are_those_of_numpy_to_the_bit(rng, monkeypatch):
    q, frames, t = frames_of(rng)
    compiled = slerp_frames(q, frames, t)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(compiled, slerp_frames(q, frames, t), strict=True)


def test_the_mean_is_scipys_whatever_the_signs(rng):
    q = rot.multiply(random_quaternions(rng, 1), rot.exp(0.4 * rng.normal(size=(60, 3))))
    q *= rng.choice([-1.0, 1.0], size=(60, 1))
    same_rotation(rot.mean_of_products(q.T @ q), scipy_of(q).mean().as_quat(scalar_first=True), atol=1e-12)
    parts = q.reshape(12, 5, 4)
    several = rot.mean_of_products(np.swapaxes(parts, 1, 2) @ parts)
    same_rotation(several, np.stack([rot.mean_of_products(part.T @ part) for part in parts]))


LEADING = [
    *[((), (7,)), ((7,), ()), ((7,), (7,)), ((5, 3), (5, 3)), ((0,), (0,)), ((1,), (7,)), ((3,), (5, 3)), ((), ())],
    *[((5, 1), (5, 3)), ((5, 1), (1, 3)), ((2, 5, 3), (5, 1))],
]
WORK = {
    rot.multiply: (4, 4),
    rot.between: (4, 4),
    rot.angle_between: (4, 4),
    rot.rotate: (4, 3),
    rot.unrotate: (4, 3),
    rot.cross: (3, 3),
    rot.dot: (3, 3),
}
# How rows lie in memory: one after the other, backwards, every other number, of another kind.
LYING = [lambda x: x, lambda x: x[::-1], lambda x: x.repeat(2, axis=-1)[..., ::2], lambda x: x.astype(np.float32)]


@pytest.mark.compiled
@pytest.mark.parametrize("leading", LEADING)
@pytest.mark.parametrize("work", WORK, ids=lambda work: work.__name__)
def test_what_is_compiled_is_that_of_numpy_to_the_bit(work, leading, monkeypatch):
    rng = np.random.default_rng(3)
    a, b = (rng.normal(size=(*shape, n)) for shape, n in zip(leading, WORK[work], strict=True))
    pairs = [(lies(a) if a.ndim > 1 else a, lies(b) if b.ndim > 1 else b) for lies in LYING]
    compiled = [(work(*pair), rot.length(pair[0][..., :3])) for pair in pairs]
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    # Numbers of less precision are as many of full precision.
    pairs = [tuple(each.astype(np.float64) for each in pair) for pair in pairs]
    for (found, lengths), pair in zip(compiled, pairs, strict=True):
        np.testing.assert_array_equal(found, work(*pair), strict=True)
        np.testing.assert_array_equal(lengths, rot.length(pair[0][..., :3]), strict=True)


@pytest.mark.compiled
@pytest.mark.parametrize("leading", [(), (0,), (7,), (5, 3)])
@pytest.mark.parametrize("lies", LYING)
def test_compiled_rotation_vectors_are_those_of_numpy_to_the_bit(leading, lies, monkeypatch):
    rng = np.random.default_rng(6)
    v = rng.normal(size=(*leading, 3)) * rng.choice([0.0, 1e-9, 1e-4, 1.0, 3.0], size=(*leading, 1))
    q = rot.exp(v) * rng.choice([-1.0, 1.0], size=(*leading, 1))
    v, q = (lies(each) if leading else each for each in (v, q))
    compiled = rot.exp(v), rot.log(q)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    for found, work, given in zip(compiled, (rot.exp, rot.log), (v, q), strict=True):
        np.testing.assert_array_equal(found, work(given.astype(np.float64)), strict=True)


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_rows_of_another_width_are_an_error_and_no_crash():
    with pytest.raises(ValueError, match="not rows of 4 numbers"):
        rot.multiply(np.zeros((7, 3)), np.zeros((7, 4)))
    for shape in ((7, 3), (5, 4), (7, 7, 4), (4,)):
        with pytest.raises(ValueError, match=r"results|rows"):
            compiled().multiply(np.zeros((7, 4)), np.zeros((7, 4)), np.empty(shape, np.float32))
    for shape in ((3, 7), (7,), (2, 7, 1)):
        with pytest.raises(ValueError, match=r"results|rows"):
            compiled().turn(np.zeros((7, 4)), np.zeros((7, 4)), np.empty(shape))


@pytest.mark.compiled
@pytest.mark.parametrize("axes", list(permutations(range(3))))
@pytest.mark.parametrize("leading", [(), (0,), (7,), (5, 3)])
def test_compiled_turns_about_three_axes_are_those_of_numpy_to_the_bit(axes, leading, rng, monkeypatch):
    angles = rng.uniform(-7.0, 7.0, size=(*leading, 6))[..., ::2]
    angles[..., :1] = np.where(rng.random(angles[..., :1].shape) < 0.3, np.pi, angles[..., :1])
    compiled = rot.from_euler(angles, axes)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(compiled, rot.from_euler(angles, axes), strict=True)


def test_dots_and_lengths_are_sums_and_norms_to_the_bit():
    a, b = np.random.default_rng(5).normal(size=(2, 500, 3))
    np.testing.assert_array_equal(rot.dot(a, b), np.sum(a * b, axis=-1))
    np.testing.assert_array_equal(rot.length(a), np.linalg.norm(a, axis=-1))
