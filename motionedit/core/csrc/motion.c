/* Whole motions: the low-passed displacement between passes. */

#define ONE_LANE
#include "motion.h"
#include "rotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
/* Radians: a rotation vector as short as this has no direction to add a turn along. */
#define NO_LENGTH 1e-9

/* One column of numbers through a symmetric filter, with odd reflection at the ends: about where a line through what is
   near to an end, weighted as the filter is, has it.

   padded: shape (frames + 2 radius, width), its middle filled; taps: shape (radius + 1,), the middle one first. */
static void low_pass(double *padded, int64_t frames, int64_t width, int64_t radius, const double *taps, double *out)
{
    double *rows = padded + radius * width, *last = rows + (frames - 1) * width, sums[3] = {0.0, 0.0, 0.0};
    for (int64_t k = 0; k <= radius; k++)
        sums[0] += taps[k], sums[1] += taps[k] * (double)k, sums[2] += taps[k] * (double)k * (double)k;
    const double scale = radius ? 1.0 / (sums[0] * sums[2] - sums[1] * sums[1]) : 0.0;
    for (int64_t a = 0; a < width; a++) {
        double head = radius ? 0.0 : rows[a], tail = radius ? 0.0 : last[a];
        for (int64_t k = 0; radius && k <= radius; k++) {
            const double weight = scale * taps[k] * (sums[2] - sums[1] * (double)k);
            head += weight * rows[k * width + a], tail += weight * last[a - k * width];
        }
        for (int64_t i = 1; i <= radius; i++) {
            rows[a - i * width] = 2.0 * head - rows[a + i * width];
            last[a + i * width] = 2.0 * tail - last[a - i * width];
        }
    }
    for (int64_t i = 0; i < frames * width; i++)
        out[i] = taps[0] * rows[i];
    for (int64_t k = 1; k <= radius; k++)
        for (int64_t i = 0; i < frames * width; i++)
            out[i] += taps[k] * (rows[i - k * width] + rows[i + k * width]);
}

/* As low_pass, of rows that nothing is laid around. rows, out: shape (frames, width). Returns -1 where memory ran out. */
int low_passed_rows(const double *rows, int64_t frames, int64_t width, int64_t radius, const double *taps, double *out)
{
    double *padded = malloc(sizeof *padded * (size_t)((frames + 2 * radius) * width + 1));
    if (padded == NULL)
        return -1;
    memcpy(padded + radius * width, rows, sizeof *rows * (size_t)(frames * width));
    low_pass(padded, frames, width, radius, taps, out);
    free(padded);
    return 0;
}

/* The rotation vector as a quaternion; any length. */
static void q_exp_any(const double *v, double *out)
{
    const double angle = sqrt(dot(v, v));
    if (angle <= 0.5) {
        q_exp(v, out);
        return;
    }
    const double scale = sin(0.5 * angle) / angle;
    out[0] = cos(0.5 * angle), out[1] = scale * v[0], out[2] = scale * v[1], out[3] = scale * v[2];
}

/* Of the rotation vectors v (1 + 2 pi k / |v|), which are one rotation, the one nearest to the frame before. */
static void unwrap(double *v, const double *before)
{
    double step[3];
    for (int a = 0; a < 3; a++)
        step[a] = v[a] - before[a];
    const double length = sqrt(dot(v, v));
    if (dot(step, step) <= PI * PI || length < NO_LENGTH)
        return;
    const double turns = round((dot(v, before) / length - length) / (2.0 * PI));
    for (int a = 0; a < 3; a++)
        v[a] *= 1.0 + 2.0 * PI * turns / length;
}

/* Rotations plus their low-passed displacement, d = log(q_before^-1 q_after), joint by joint.

   Joints with an axis in their parent's frame are hinges, d = a . log(q_after q_before^-1) their turns about it; an
   axis of zeros is none. before, after, out: shape (frames, joints, 4); axes: (joints, 3). Frames before `first` keep their displacement, lend none; components
   below `none` (rad) are 0, and joints without any stay as they were before. Returns -1 where memory ran out. */
int smooth_rotations(const double *before, const double *after, const double *axes, int64_t frames, int64_t joints,
    int64_t first, int64_t radius, const double *taps, double none, double *out)
{
    const int64_t count = frames - first;
    double *turns = malloc(sizeof *turns * (size_t)(3 * (2 * count + 2 * radius + first) + 1));
    if (turns == NULL)
        return -1;
    double *padded = turns + 3 * first, *smooth = padded + 3 * (count + 2 * radius);
    for (int64_t j = 0; j < joints; j++) {
        const double *axis = axes + 3 * j;
        const int is_hinge = axis[0] != 0.0 || axis[1] != 0.0 || axis[2] != 0.0;
        int moves = 0;
        for (int64_t f = 0; f < frames; f++) {
            const double *q = before + 4 * (f * joints + j), *edited = after + 4 * (f * joints + j);
            double inverse[4], turn[4], *v = f < first ? turns + 3 * f : padded + 3 * (f - first + radius);
            if (memcmp(q, edited, 4 * sizeof *q) == 0) {
                v[0] = v[1] = v[2] = 0.0;
                continue;
            }
            q_conjugate(q, inverse);
            if (is_hinge)
                q_multiply(edited, inverse, turn);
            else
                q_multiply(inverse, edited, turn);
            q_log(turn, turn);
            if (is_hinge) {
                const double angle = dot(axis, turn);
                turn[0] = angle * axis[0], turn[1] = angle * axis[1], turn[2] = angle * axis[2];
            }
            if (f > first)
                unwrap(turn, v - 3);
            for (int a = 0; a < 3; a++) {
                v[a] = fabs(turn[a]) < none ? 0.0 : turn[a];
                moves |= v[a] != 0.0;
            }
        }
        if (moves)
            low_pass(padded, count, 3, radius, taps, smooth);
        for (int64_t f = 0; f < frames; f++) {
            const double *q = before + 4 * (f * joints + j), *v = f < first ? turns + 3 * f : smooth + 3 * (f - first);
            double turn[4];
            if (!moves || (v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0)) {
                memcpy(out + 4 * (f * joints + j), q, 4 * sizeof *q);
                continue;
            }
            q_exp_any(v, turn);
            if (is_hinge)
                q_multiply(turn, q, out + 4 * (f * joints + j));
            else
                q_multiply(q, turn, out + 4 * (f * joints + j));
        }
    }
    free(turns);
    return 0;
}
