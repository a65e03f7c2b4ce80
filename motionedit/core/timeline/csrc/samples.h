/* A motion sampled at parts of frames: what core/rotations.py, timeline/ and euler.py do in many calls of numpy, in a
   few loops between those of numpy's own arc cosines, tangents and arc tangents. The same operations in the same order,
   so that the results are the same to the bit. */

#ifndef MOTIONEDIT_SAMPLES_H
#define MOTIONEDIT_SAMPLES_H

#include <stdint.h>

/* Where a motion of so many `frames` is sampled: at fractions t (count,) of the ways from frames `at` (count,) to the
   ones after, of the last one to itself. */
typedef struct {
    const int64_t *at;
    const double *t;
    int64_t frames, count;
} Samples;

/* Rotations (frames, joints, 4) on the way from frame to frame: of each sample the quaternions at both ends are weighed
   by `first` and `second`, shape (count, joints). */
typedef struct {
    const double *rotations, *first, *second;
    int64_t joints;
} Ways;

/* A rigid motion on the ground, x = rotation (x - origin), of the one joint that carries the travel. */
typedef struct {
    const double *rotation, *origin;
} Placing;

/* The cosines between the rotations at both ends, shape (count, joints), and their sizes, at most 1. */
void arc_cosines(const Samples *samples, const Ways *ways, double *cosines, double *sizes);

/* Of arcs, whole ones between quaternions, shape (count, joints): half of each, of what is left of it at t, and of its
   way to t, (3, count, joints). The arcs are where the first of these go. */
void arc_parts(const Samples *samples, int64_t joints, double *parts);

/* The weights of both ends, the second and the third of `parts` by then, of the cosines between these and of the
   tangents of `parts`; `straight` is the tangent below which an arc is a line. */
void arc_weights(const Samples *samples, int64_t joints, const double *cosines, double straight, double *parts);

/* The rotations of all joints at the samples, shape (count, joints, 4). */
void sampled_turns(const Samples *samples, const Ways *ways, double *out);

/* What the Euler angles of `many` joints about three axes are arc tangents of at the samples, as `euler_sums`; the first
   joint of all is placed. */
void sampled_sums(const Samples *samples, const Ways *ways, const Placing *placing, const int64_t *joints, int64_t many,
    const int *axes, double *sums);

/* Joints' columns of rows that are `width` numbers wide, three for each: of a position, -1 where it has no channel. */
typedef struct {
    const int64_t *columns;
    int64_t count, width;
    double *rows;
} Columns;

/* How arc tangents become Euler angles about three axes: beyond what a middle angle is locked, rad, and what they are
   times as they are written. */
typedef struct {
    int axes[3];
    double locked, factor;
} Solving;

/* Write the Euler angles of joints, each nearest the frame before and the first nearest its seed,
   (joints, 3) rad, from the arc tangents of `sums`, (3, joints, frames) of (6, joints, frames), which are used up. Returns 0
   where one is locked. */
int angle_columns(double *sums, int64_t frames, const Solving *solving, const double *seeds, const Columns *columns);

/* Write the translations (frames, moved, 3) of joints at the samples; of the `placed` one, if there is one, placed. */
void place_columns(
    const Samples *samples, const double *translations, int64_t placed, const Placing *placing, const Columns *columns);

#endif
