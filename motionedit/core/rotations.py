"""Unit quaternions, rotation vectors, matrices and Euler angles, each function over arrays of any leading shape.

Quaternions are ``[w, x, y, z]``, rotation vectors and angles are in radians, matrices act on column vectors. An
Euler order such as ``ZXY`` names BVH channels in their order: R = Rz Rx Ry.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from motionedit.core.compiled import compiled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from motionedit.core.arrays import FloatArray

TURN = 2.0 * np.pi
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
IDENTITY.setflags(write=False)
_CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])

# Below this angle (rad) sin(x)/x and its kin are taken from their series, exact to double precision there.
_SMALL_ANGLE = 1e-4


def multiply(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the Hamilton product a b, shape (..., 4): first turn by b, then by a."""
    product = _in_one_loop("multiply", a, b, 4)
    if product is not None:
        return product
    aw, ax, ay, az = parts_of(a)
    bw, bx, by, bz = parts_of(b)
    # Part by part into its place: four parts beside the product would double the memory of a long motion.
    product = np.empty((*np.broadcast(aw, bw).shape, 4))
    product[..., 0] = aw * bw - ax * bx - ay * by - az * bz
    product[..., 1] = aw * bx + ax * bw + ay * bz - az * by
    product[..., 2] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 3] = aw * bz + ax * by - ay * bx + az * bw
    return product


def between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a^-1 b of unit quaternions, shape (..., 4): the turn that leads from a to b, in the frame of a."""
    product = _in_one_loop("between", a, b, 4)
    return multiply(conjugate(a), b) if product is None else product


def conjugate(q: FloatArray) -> FloatArray:
    """Return the inverse of unit quaternions, shape (..., 4)."""
    inverse: FloatArray = q * _CONJUGATE
    return inverse


def normalize(q: FloatArray) -> FloatArray:
    """Return quaternions scaled to unit length, shape (..., 4)."""
    unit: FloatArray = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return unit


def rotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Return vectors v turned by q, shape (..., 3)."""
    turned = _in_one_loop("rotate", q, v, 3)
    if turned is not None:
        return turned
    w, xyz = q[..., :1], q[..., 1:]
    t = 2.0 * cross(xyz, v)
    return v + w * t + cross(xyz, t)


def unrotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Return vectors v turned by the inverse of unit quaternions q, shape (..., 3)."""
    turned = _in_one_loop("unrotate", q, v, 3)
    return rotate(conjugate(q), v) if turned is None else turned


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross product a x b, shape (..., 3); several times faster than `numpy.cross`."""
    product = _in_one_loop("cross", a, b, 3)
    if product is not None:
        return product
    ax, ay, az = parts_of(a)
    bx, by, bz = parts_of(b)
    product = np.empty((*np.broadcast(ax, bx).shape, 3))
    product[..., 0] = ay * bz - az * by
    product[..., 1] = az * bx - ax * bz
    product[..., 2] = ax * by - ay * bx
    return product


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the dot products of vectors, shape (...): a sum over a short last axis takes several times as long."""
    product = _in_one_loop("dot", a, b)
    if product is not None:
        return product
    ax, ay, az = parts_of(a)
    bx, by, bz = parts_of(b)
    summed: FloatArray = ax * bx + ay * by + az * bz
    return summed


def length(v: FloatArray) -> FloatArray:
    """Return the lengths of vectors, shape (...): a norm over a short last axis takes several times as long."""
    kernel = compiled()
    if kernel is None:
        return np.sqrt(dot(v, v))
    found = np.empty(v.shape[:-1])
    if not kernel.length(v, v, found):
        own = np.ascontiguousarray(v, np.float64)
        kernel.length(own, own, found)
    return found


def _in_one_loop(
    what: str,
    a: FloatArray,
    b: FloatArray,
    *width: int,
    planes: tuple[int, ...] = (),
    out: FloatArray | None = None,
) -> FloatArray | None:
    """Return what the compiled part makes of rows of numbers, the same to the bit; None where numpy makes it.

    `width` is how many numbers a row of the result has; none where it is one without an axis of its own. The result is
    `out`, if it is given.
    """
    kernel = compiled()
    if kernel is None:
        return None
    one, other = a.shape[:-1], b.shape[:-1]
    leading = one if one == other or not other else np.broadcast_shapes(one, other) if one else other
    out = np.empty(planes + leading + width) if out is None else out
    work = getattr(kernel, what)
    if not work(a, b, out):
        work(np.ascontiguousarray(a, np.float64), np.ascontiguousarray(b, np.float64), out)
    return out


def parts_of(v: FloatArray) -> list[FloatArray]:
    """Return the parts of vectors or quaternions, shape (...) each; `numpy.moveaxis` takes longer than a product."""
    return [v[..., i] for i in range(v.shape[-1])]


def skew(v: FloatArray) -> FloatArray:
    """Return the matrices [v]x with [v]x u = v x u, shape (..., 3, 3)."""
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    rows = np.stack((zero, -z, y, z, zero, -x, -y, x, zero), axis=-1)
    return rows.reshape(*v.shape[:-1], 3, 3)


def exp(v: FloatArray) -> FloatArray:
    """Return the quaternions of rotation vectors v (rad), shape (..., 4)."""
    half = 0.5 * length(v)
    q = np.empty((*v.shape[:-1], 4))
    np.cos(half, out=q[..., 0])
    # sin(x)/x by np.sinc, whose argument is x/pi, is exact at 0.
    scale = np.reshape(0.5 * np.sinc(half / np.pi), (*v.shape[:-1], 1))
    if _in_one_loop("scaled_vectors", v, scale, out=q) is None:
        np.multiply(scale, v, out=q[..., 1:])
    return q


def log(q: FloatArray) -> FloatArray:
    """Return the rotation vectors (rad, length at most pi) of unit quaternions; the sign of q does not matter."""
    w = q[..., 0]
    s = length(q[..., 1:])
    scale = np.arctan2(s, np.abs(w))
    scale *= 2.0
    small = s < _SMALL_ANGLE
    if np.any(small):
        scale = np.where(small, 2.0 + s * s / 3.0, scale / np.where(small, 1.0, s))
    else:
        scale /= s
    found = _in_one_loop("scaled_shorter", q, np.reshape(scale, (*q.shape[:-1], 1)), 3)
    if found is not None:
        return found
    v: FloatArray = np.where(w < 0.0, -scale, scale)[..., None] * q[..., 1:]
    return v


def angle_between(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the geodesic angles (rad, 0 to pi) between rotations a and b, shape (...)."""
    halves = _in_one_loop("turn", a, b, planes=(2,))
    if halves is None:
        d = between(a, b)
        angle: FloatArray = 2.0 * np.arctan2(length(d[..., 1:]), np.abs(d[..., 0]))
        return angle
    angle = np.arctan2(halves[0], halves[1])
    angle *= 2.0
    return angle


def half_cosines(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cosines of half the angles between rotations, |a . b|, shape (...): they cost less than the angles."""
    found = _in_one_loop("half_cosine", a, b)
    return np.abs(np.einsum("...i,...i->...", a, b)) if found is None else found


def to_matrix(q: FloatArray) -> FloatArray:
    """Return the rotation matrices of unit quaternions, shape (..., 3, 3)."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    xx, yy, zz, xy, xz, yz, wx, wy, wz = x * x, y * y, z * z, x * y, x * z, y * z, w * x, w * y, w * z
    rows = np.stack(
        (
            *(1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)),
            *(2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)),
            *(2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)),
        ),
        axis=-1,
    )
    return rows.reshape(*q.shape[:-1], 3, 3)


def from_matrix(R: FloatArray) -> FloatArray:
    """Return the unit quaternions (w >= 0) of rotation matrices, shape (..., 4).

    The largest of the four parts is found first (Shepperd), so nothing is lost near half a turn.
    """
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    # 4 q q^T, whose row of largest diagonal is q up to scale.
    outer = np.empty((*R.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1.0 + xx + yy + zz
    outer[..., 1, 1] = 1.0 + xx - yy - zz
    outer[..., 2, 2] = 1.0 - xx + yy - zz
    outer[..., 3, 3] = 1.0 - xx - yy + zz
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        a, b = R[..., k - 1, j - 1], R[..., j - 1, k - 1]
        outer[..., 0, i] = outer[..., i, 0] = a - b
        outer[..., j, k] = outer[..., k, j] = a + b
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    q = normalize(np.take_along_axis(outer, best[..., None, None], axis=-2)[..., 0, :])
    return np.where(q[..., :1] < 0.0, -q, q)


def mean_of_products(products: FloatArray) -> FloatArray:
    """Return the Markley mean of rotations of which sum q q^T is known, shape (..., 4, 4).

    It is the eigenvector with the largest eigenvalue, w >= 0.
    """
    _, vectors = np.linalg.eigh(products)
    best: FloatArray = vectors[..., -1]
    return np.where(best[..., :1] < 0.0, -best, best)


def about_axis(axis: int, angle: FloatArray) -> FloatArray:
    """Return the quaternions of turns by `angle` (rad, shape (...)) about coordinate axis 0, 1 or 2."""
    q = np.zeros((*np.shape(angle), 4))
    q[..., 0] = np.cos(0.5 * angle)
    q[..., 1 + axis] = np.sin(0.5 * angle)
    return q


def from_euler(angles: FloatArray, axes: Sequence[int]) -> FloatArray:
    """Return the quaternions of Euler angles, shape (..., 4).

    Parameters
    ----------
    angles : shape (..., len(axes)), rad
        In the order of `axes`.
    axes : sequence of 0, 1, 2
        Coordinate axes in channel order: (2, 0, 1) is ZXY, R = Rz Rx Ry. Any number of them, none is the identity.
    """
    if len(axes) == 3 and len(set(axes)) == 3:
        return from_half_angles(np.multiply(angles, 0.5, order="C"), axes)
    q = np.broadcast_to(IDENTITY, (*angles.shape[:-1], 4))
    for i, axis in enumerate(axes):
        turn = about_axis(axis, angles[..., i])
        q = turn if i == 0 else multiply(q, turn)
    return q


def from_half_angles(half: FloatArray, axes: Sequence[int], *, out: FloatArray | None = None) -> FloatArray:
    """Return the product of three turns about different axes, each as (1, t e_axis) / sqrt(1 + t^2), t = tan(a/2).

    One tangent takes the place of a sine and a cosine, which cost ten times as much; near half a turn t is large but
    finite, and the quotients keep their precision. The halves of the angles, shape (..., 3) rad, are used up; the
    quaternions are written to `out`, shape (..., 4), if it is given.
    """
    i, j, k = axes
    sign = sign_of(axes)
    np.tan(half, out=half)
    q, kernel = np.empty((*half.shape[:-1], 4)) if out is None else out, compiled()
    if kernel is not None and q.flags.c_contiguous:
        kernel.from_tangents(half, i, j, k, q)
        return q
    a, b, c = half[..., 0], half[..., 1], sign * half[..., 2]
    scale = 1.0 / np.sqrt((1.0 + a * a) * (1.0 + b * b) * (1.0 + c * c))
    ab, bc, ac = a * b, b * c, a * c
    q[..., 0] = (1.0 - ab * c) * scale
    q[..., 1 + i] = (a + bc) * scale
    q[..., 1 + j] = (b - ac) * scale
    scale *= sign
    q[..., 1 + k] = (c + ab) * scale
    return q


def sign_of(axes: Sequence[int]) -> float:
    """Return the sign in e_i e_j = sign e_k, of the first two axes and the third."""
    return 1.0 if (axes[1] - axes[0]) % 3 == 1 else -1.0


def euler_axes(order: str) -> tuple[int, ...]:
    """Return the axes of an order's name: ``ZXY`` is (2, 0, 1)."""
    return tuple("XYZ".index(letter) for letter in order.upper())
