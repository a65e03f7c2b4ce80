/* Whole arrays of rotations: what motionedit/core/rotations.py and euler.py do in many calls of numpy, in one loop.
   The same operations in the same order, so that the results are the same to the bit. */

#ifndef MOTIONEDIT_ARRAYS_H
#define MOTIONEDIT_ARRAYS_H

#include <stdint.h>

/* What is done to `count` rows a and b of numbers, each so many numbers after the one before: 0 takes the first for all.
   Rows of results follow each other, or lie in planes, so many numbers `apart`. */
typedef void RowWork(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart);

RowWork multiply_all;    /* out = a b, of quaternions */
RowWork between_all;     /* out = a^-1 b, of unit quaternions */
RowWork rotate_all;      /* out = b turned by a */
RowWork unrotate_all;    /* out = b turned by a^-1 */
RowWork cross_all;       /* out = a x b */
RowWork dot_all;         /* out = a . b, one number each */
RowWork length_all;      /* out = |b|, one number each */
RowWork half_cosine_all; /* out = |a . b|, of quaternions, one number each */
RowWork turn_all;        /* of a^-1 b sine and cosine of half the angle, apart from each other */
RowWork scale_vectors;   /* the vectors of quaternions out = b a, of vectors; their first numbers stay */
RowWork scale_shorter; /* out = b times the vectors of quaternions a, with the sign that turns by half a turn at most */

/* Quaternions of `count` products of three turns about the axes, 0 to 2 and different, each by the tangent of half its
   angle. */
void from_tangents(const double *tangents, const int *axes, int64_t count, double *out);

/* What the Euler angles of rotations about three axes are arc tangents of, shape (6, joints, frames): sine and cosine of
   half the sum of the outer angles, of half their difference, and the lengths of both pairs. The frames begin at
   `rotations`, and are `step` numbers apart; `joints` are the places of those that are wanted. */
void euler_sums(const double *rotations, int64_t step, const int64_t *joints, int64_t count, int64_t frames,
    const int *axes, double *out);

/* The same of one joint's rotations q, `step` numbers apart: its part of each of the six planes, which begin `all` numbers
   apart. */
void sums_of_turns(const double *q, int64_t step, int64_t frames, const int *axes, double *sums, int64_t all);

/* Write `count` tracks, shape (count, frames), times a factor as columns of rows that are so many numbers wide. */
void rows_of_tracks(const double *tracks, const int64_t *columns, int64_t count, int64_t frames, double factor,
    double *rows, int64_t width);

/* Make a track of Euler angles, rad, `step` numbers from axis to axis, continuous: each frame by whole turns, and with three axes by
   the other solution of its rotation, nearest the frame before, the first one nearest `seed`, shape (axes,). */
void nearest_angles(double *angles, int64_t axes, int64_t step, int64_t frames, const double *seed);

#endif
