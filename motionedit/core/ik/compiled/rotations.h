/* Vectors (x, y, z) and unit quaternions (w, x, y, z), as in motionedit/core/rotations.py; angles in radians. */

#ifndef MOTIONEDIT_ROTATIONS_H
#define MOTIONEDIT_ROTATIONS_H

#include <math.h>

static inline double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void cross(const double *a, const double *b, double *out)
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

/* out += s a */
static inline void add_scaled(double *out, double s, const double *a)
{
    out[0] += s * a[0], out[1] += s * a[1], out[2] += s * a[2];
}

/* The Hamilton product a b: first turn by b, then by a. */
static inline void q_multiply(const double *a, const double *b, double *out)
{
    const double w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    const double x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    const double y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    const double z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    out[0] = w, out[1] = x, out[2] = y, out[3] = z;
}

static inline void q_conjugate(const double *q, double *out)
{
    out[0] = q[0], out[1] = -q[1], out[2] = -q[2], out[3] = -q[3];
}

/* v turned by q: v + 2 w (u x v) + 2 u x (u x v). */
static inline void q_rotate(const double *q, const double *v, double *out)
{
    double t[3], s[3];
    cross(q + 1, v, t);
    t[0] *= 2.0, t[1] *= 2.0, t[2] *= 2.0;
    cross(q + 1, t, s);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] + q[0] * t[i] + s[i];
}

/* v turned by the inverse of q. */
static inline void q_rotate_back(const double *q, const double *v, double *out)
{
    double inverse[4];
    q_conjugate(q, inverse);
    q_rotate(inverse, v, out);
}

/* The quaternion of a rotation vector v, |v| <= 0.5: cos h and sin h / h by their series, exact to double precision. */
static inline void q_exp(const double *v, double *out)
{
    const double t = -0.25 * dot(v, v); /* -h^2, h half the angle */
    const double c = 1.0 + t / 2 * (1.0 + t / 12 * (1.0 + t / 30 * (1.0 + t / 56 * (1.0 + t / 90 * (1.0 + t / 132)))));
    const double s = 1.0 + t / 6 * (1.0 + t / 20 * (1.0 + t / 42 * (1.0 + t / 72 * (1.0 + t / 110 * (1.0 + t / 156)))));
    out[0] = c, out[1] = 0.5 * s * v[0], out[2] = 0.5 * s * v[1], out[3] = 0.5 * s * v[2];
}

/* The rotation vector of a unit quaternion, at most pi long; the sign of q does not matter. */
static inline void q_log(const double *q, double *out)
{
    const double sign = q[0] < 0.0 ? -1.0 : 1.0, t = dot(q + 1, q + 1);
    double scale;
    if (t < 1e-3) /* 2 asin(s) / s by its series in t = s^2; the next term is below 1e-19 */
        scale = 2.0 * (1.0 + t * (1.0 / 6 + t * (3.0 / 40 + t * (15.0 / 336 + t * (105.0 / 3456 + t * (945.0 / 42240))))));
    else {
        const double s = sqrt(t);
        scale = 2.0 * atan2(s, sign * q[0]) / s;
    }
    scale *= sign;
    out[0] = scale * q[1], out[1] = scale * q[2], out[2] = scale * q[3];
}

#endif
