/* Vectors (x, y, z), unit quaternions (w, x, y, z) as in motionedit/core/rotations.py, and rotation matrices,
   row-major; angles in radians. A number is a V: one of each lane. */

#ifndef MOTIONEDIT_ROTATIONS_H
#define MOTIONEDIT_ROTATIONS_H

#include "lanes.h"

#include <math.h>

static inline V dot(const V *a, const V *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* a . b of a plain vector */
static inline V along(const double *a, const V *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(const V *a, const V *b, V *out)
{
    const V x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

/* out += s a */
static inline void add_scaled(V *out, V s, const V *a)
{
    out[0] += s * a[0], out[1] += s * a[1], out[2] += s * a[2];
}

static inline void add(V *out, const V *a)
{
    out[0] += a[0], out[1] += a[1], out[2] += a[2];
}

/* The Hamilton product a b: first turn by b, then by a. */
static inline void q_multiply(const V *a, const V *b, V *out)
{
    const V w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    const V x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    const V y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    const V z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    out[0] = w, out[1] = x, out[2] = y, out[3] = z;
}

static inline void q_conjugate(const V *q, V *out)
{
    out[0] = q[0], out[1] = -q[1], out[2] = -q[2], out[3] = -q[3];
}

/* v turned by the unit quaternion (w, u): v + w t + u x t with t = 2 (u x v). */
static inline void q_turn(const V *q, const V *v, V *out)
{
    V t[3], s[3];
    cross(q + 1, v, t);
    t[0] = 2.0 * t[0], t[1] = 2.0 * t[1], t[2] = 2.0 * t[2];
    cross(q + 1, t, s);
    for (int a = 0; a < 3; a++)
        out[a] = v[a] + q[0] * t[a] + s[a];
}

/* The matrix of a unit quaternion. */
static inline void matrix_of(const V *q, V *R)
{
    const V w = q[0], x = q[1], y = q[2], z = q[3];
    const V xx = x * x, yy = y * y, zz = z * z, xy = x * y, xz = x * z, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
    R[0] = 1.0 - 2.0 * (yy + zz), R[1] = 2.0 * (xy - wz), R[2] = 2.0 * (xz + wy);
    R[3] = 2.0 * (xy + wz), R[4] = 1.0 - 2.0 * (xx + zz), R[5] = 2.0 * (yz - wx);
    R[6] = 2.0 * (xz - wy), R[7] = 2.0 * (yz + wx), R[8] = 1.0 - 2.0 * (xx + yy);
}

/* out = A B */
static inline void matrix_product(const V *A, const V *B, V *out)
{
    for (int i = 0; i < 3; i++) {
        const V a = A[3 * i], b = A[3 * i + 1], c = A[3 * i + 2];
        out[3 * i] = a * B[0] + b * B[3] + c * B[6];
        out[3 * i + 1] = a * B[1] + b * B[4] + c * B[7];
        out[3 * i + 2] = a * B[2] + b * B[5] + c * B[8];
    }
}

/* R v */
static inline void turned(const V *R, const V *v, V *out)
{
    const V x = v[0], y = v[1], z = v[2];
    out[0] = R[0] * x + R[1] * y + R[2] * z;
    out[1] = R[3] * x + R[4] * y + R[5] * z;
    out[2] = R[6] * x + R[7] * y + R[8] * z;
}

/* R v of a plain vector */
static inline void turned_plain(const V *R, const double *v, V *out)
{
    for (int i = 0; i < 3; i++)
        out[i] = R[3 * i] * v[0] + R[3 * i + 1] * v[1] + R[3 * i + 2] * v[2];
}

/* R^T v */
static inline void turned_back(const V *R, const V *v, V *out)
{
    const V x = v[0], y = v[1], z = v[2];
    out[0] = R[0] * x + R[3] * y + R[6] * z;
    out[1] = R[1] * x + R[4] * y + R[7] * z;
    out[2] = R[2] * x + R[5] * y + R[8] * z;
}

/* The quaternion of a rotation vector v, |v| <= 0.5: cos h and sin h / h by their series, exact to double precision. */
static inline void q_exp(const V *v, V *out)
{
    const V t = -0.25 * dot(v, v); /* -h^2, h half the angle */
    const V c =
        1.0 + t * (1.0 / 2 + t * (1.0 / 24 + t * (1.0 / 720 +
                                                     t * (1.0 / 40320 + t * (1.0 / 3628800 + t * (1.0 / 479001600))))));
    const V s = 1.0 + t * (1.0 / 6 + t * (1.0 / 120 + t * (1.0 / 5040 + t * (1.0 / 362880 + t * (1.0 / 39916800)))));
    out[0] = c, out[1] = 0.5 * s * v[0], out[2] = 0.5 * s * v[1], out[3] = 0.5 * s * v[2];
}

/* The rotation vector of a unit quaternion, at most pi long; the sign of q does not matter. */
static inline void q_log(const V *q, V *out)
{
    /* asin(s) / s by its series in t = s^2; up to t = 0.04, 23 degrees, the next term is below 1e-17 of the whole. */
    static const double series[] = {1.0, 1.0 / 6, 3.0 / 40, 5.0 / 112, 35.0 / 1152, 63.0 / 2816, 231.0 / 13312,
        143.0 / 10240, 6435.0 / 557056, 12155.0 / 1245184, 46189.0 / 5505024, 88179.0 / 12058624};
    const V t = dot(q + 1, q + 1), sign = choose(less(q[0], all(0.0)), all(-1.0), all(1.0));
    V scale = all(series[11]);
    for (int i = 10; i >= 0; i--)
        scale = series[i] + t * scale;
    scale *= 2.0;
    const Mask far = ~less(t, all(0.04));
    if (any(far))
        for (int lane = 0; lane < LANES; lane++)
            if (MASK_LANE(far, lane)) {
                const double s = sqrt(LANE(t, lane));
                LANE(scale, lane) = 2.0 * atan2(s, fabs(LANE(q[0], lane))) / s;
            }
    scale *= sign;
    out[0] = scale * q[1], out[1] = scale * q[2], out[2] = scale * q[3];
}

#endif
