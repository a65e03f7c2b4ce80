/* Whole motions: world transforms, and low-passed rows and displacements. */

#ifndef MOTIONEDIT_MOTION_H
#define MOTIONEDIT_MOTION_H

#include <stdint.h>

void world_poses(const int64_t *parents, const int64_t *places, const double *offsets, int64_t frames, int64_t joints,
    int64_t translated, const double *rotations, const double *translations, double *positions, double *world);
int low_passed_rows(const double *rows, int64_t frames, int64_t width, int64_t radius, const double *taps, double *out);
int smooth_rotations(const double *before, const double *after, const double *axes, int64_t frames, int64_t joints,
    int64_t first, int64_t radius, const double *taps, double none, double *out);

#endif
