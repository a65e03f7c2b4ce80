/* Whole arrays of rotations: what motionedit/core/rotations.py and euler.py do in many calls of numpy, in one loop.
   The same operations in the same order, so that the results are the same to the bit. */

#ifndef MOTIONEDIT_ARRAYS_H
#define MOTIONEDIT_ARRAYS_H

#include <stdint.h>

/* out = a b of `count` quaternions; a step of 0 takes the first of a or b for all, of 4 each its own. */
void multiply_all(const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out);

/* out = v turned by q; a step of 0 takes the first of q or v for all, else of 4 and of 3 each its own. */
void rotate_all(const double *q, int64_t q_step, const double *v, int64_t v_step, int64_t count, double *out);

/* out = a x b, of 3 numbers each. */
void cross_all(const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out);

/* out = a . b, one number each. */
void dot_all(const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out);

/* Quaternions of `count` products of three turns about the axes, 0 to 2 and different, each by the tangent of half its
   angle: first all of the first turns, then of the second, of the third. */
void from_tangents(const double *tangents, const int *axes, int64_t count, double *out);

/* What the Euler angles of rotations about three axes are arc tangents of, shape (6, joints, frames): sine and cosine of
   half the sum of the outer angles, of half their difference, and the lengths of both pairs. The frames begin at
   `rotations`, and are `step` numbers apart; `joints` are the places of those that are wanted. */
void euler_sums(const double *rotations, int64_t step, const int64_t *joints, int64_t count, int64_t frames,
    const int *axes, double *out);

/* Make a track of Euler angles, rad, `step` numbers from axis to axis, continuous: each frame by whole turns, and with three axes by
   the other solution of its rotation, nearest the frame before, the first one nearest `seed`, shape (axes,). */
void nearest_angles(double *angles, int64_t axes, int64_t step, int64_t frames, const double *seed);

#endif
