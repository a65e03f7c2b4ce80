/* Whole arrays of rotations. */

#define ONE_LANE
#include "arrays.h"
#include "rotations.h"

#include <math.h>

#define PI 3.14159265358979323846
#define TURN (2.0 * PI)
/* Rad: steps of three angles that are no longer together, less than half a turn by more than rounding, need neither
   whole turns nor the other solution. */
#define SHORT_STEP 3.0

/* Frames whose rotations and angles stay near the processor. */
enum { TILE = 32 };

void multiply_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++)
        q_multiply(a + i * a_step, b + i * b_step, out + 4 * i);
}

void between_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++) {
        double inverse[4];
        q_conjugate(a + i * a_step, inverse);
        q_multiply(inverse, b + i * b_step, out + 4 * i);
    }
}

void rotate_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++, a += a_step, b += b_step, out += 3)
        q_turn(a, b, out);
}

void unrotate_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++, a += a_step, b += b_step, out += 3) {
        double inverse[4];
        q_conjugate(a, inverse);
        q_turn(inverse, b, out);
    }
}

void cross_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++)
        cross(a + i * a_step, b + i * b_step, out + 3 * i);
}

void dot_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++)
        out[i] = dot(a + i * a_step, b + i * b_step);
}

void length_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)a, (void)a_step, (void)apart;
    for (int64_t i = 0; i < count; i++)
        out[i] = sqrt(dot(b + i * b_step, b + i * b_step));
}

void half_cosine_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++, a += a_step, b += b_step)
        out[i] = fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]);
}

void turn_all(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    for (int64_t i = 0; i < count; i++) {
        double inverse[4], turn[4];
        q_conjugate(a + i * a_step, inverse);
        q_multiply(inverse, b + i * b_step, turn);
        out[i] = sqrt(dot(turn + 1, turn + 1)), out[apart + i] = fabs(turn[0]);
    }
}

void scale_vectors(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++, a += a_step, b += b_step, out += 4)
        out[1] = *b * a[0], out[2] = *b * a[1], out[3] = *b * a[2];
}

void scale_shorter(
    const double *a, int64_t a_step, const double *b, int64_t b_step, int64_t count, double *out, int64_t apart)
{
    (void)apart;
    for (int64_t i = 0; i < count; i++, a += a_step, b += b_step, out += 3) {
        const double scale = a[0] < 0.0 ? -*b : *b;
        out[0] = scale * a[1], out[1] = scale * a[2], out[2] = scale * a[3];
    }
}

void from_tangents(const double *tangents, const int *axes, int64_t count, double *out)
{
    const int i = 1 + axes[0], j = 1 + axes[1], k = 1 + axes[2];
    const double sign = (axes[1] - axes[0] + 3) % 3 == 1 ? 1.0 : -1.0; /* e_i e_j = sign e_k */
    for (int64_t n = 0; n < count; n++, tangents += 3, out += 4) {
        const double a = tangents[0], b = tangents[1], c = sign * tangents[2];
        const double scale = 1.0 / sqrt((1.0 + a * a) * (1.0 + b * b) * (1.0 + c * c));
        out[0] = (1.0 - a * b * c) * scale;
        out[i] = (a + b * c) * scale;
        out[j] = (b - a * c) * scale;
        out[k] = (c + a * b) * (scale * sign);
    }
}

/* The lengths of pairs of numbers: apart from what else is done to them, so that several are taken at once. */
static void lengths_of(const double *one, const double *other, int64_t count, double *out)
{
    for (int64_t i = 0; i < count; i++)
        out[i] = sqrt(one[i] * one[i] + other[i] * other[i]);
}

void sums_of_turns(const double *q, int64_t step, int64_t frames, const int *axes, double *sums, int64_t all)
{
    const int i = 1 + axes[0], j = 1 + axes[1], k = 1 + axes[2];
    const double sign = (axes[1] - axes[0] + 3) % 3 == 1 ? 1.0 : -1.0;
    for (int64_t f = 0; f < frames; f++, q += step) {
        const double z = sign * q[k];
        sums[f] = q[i] + z, sums[all + f] = q[0] + q[j];
        sums[2 * all + f] = q[i] - z, sums[3 * all + f] = q[0] - q[j];
    }
    lengths_of(sums, sums + all, frames, sums + 4 * all);
    lengths_of(sums + 2 * all, sums + 3 * all, frames, sums + 5 * all);
}

void euler_sums(const double *rotations, int64_t step, const int64_t *joints, int64_t count, int64_t frames,
    const int *axes, double *out)
{
    /* A few frames at a time: they stay near the processor for all joints. */
    for (int64_t start = 0; start < frames; start += TILE)
        for (int64_t n = 0; n < count; n++) {
            const int64_t many = frames - start < TILE ? frames - start : TILE;
            sums_of_turns(
                rotations + start * step + 4 * joints[n], step, many, axes, out + n * frames + start, count * frames);
        }
}

void rows_of_tracks(const double *tracks, const int64_t *columns, int64_t count, int64_t frames, double factor,
    double *rows, int64_t width)
{
    for (int64_t start = 0; start < frames; start += TILE)
        for (int64_t n = 0; n < count; n++) {
            double *column = rows + start * width + columns[n];
            for (int64_t f = start; f < frames && f < start + TILE; f++, column += width)
                *column = factor * tracks[n * frames + f];
        }
}

/* The sum of the steps between two triples of angles, each by whole turns the shortest. */
static double distance_of(const double *from, const double *to)
{
    double sum = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        const double step = to[axis] - from[axis];
        sum += fabs(step - TURN * rint(step * (1.0 / TURN)));
    }
    return sum;
}

/* The first frame from `frame` on that is a long step of three angles from the one before. */
static int64_t until_long_step(const double *angles, int64_t step, int64_t frame, int64_t frames)
{
    const double *a = angles, *b = angles + step, *c = b + step;
    while (frame < frames &&
           fabs(a[frame] - a[frame - 1]) + fabs(b[frame] - b[frame - 1]) + fabs(c[frame] - c[frame - 1]) < SHORT_STEP)
        frame++;
    return frame;
}

void nearest_angles(double *angles, int64_t axes, int64_t step, int64_t frames, const double *seed)
{
    double solved[3], taken[3], turns[3] = {0.0};
    int is_other = 0, is_plain = axes == 3; /* whether the other solutions are taken, and whether nothing is changed */
    for (int64_t axis = 0; axis < axes; axis++)
        solved[axis] = taken[axis] = seed[axis];
    for (int64_t f = 0; f < frames; f++) {
        double one[3], other[3];
        if (is_plain && f > 0) {
            f = until_long_step(angles, step, f, frames);
            for (int axis = 0; axis < 3; axis++)
                solved[axis] = taken[axis] = angles[axis * step + f - 1];
            if (f == frames)
                break;
        }
        for (int64_t axis = 0; axis < axes; axis++)
            one[axis] = angles[axis * step + f];
        if (axes == 3) {
            other[0] = one[0] + PI, other[1] = PI - one[1], other[2] = one[2] + PI;
            /* The two solutions are at least a whole turn apart: a step below half a turn needs no other one. */
            const double distance = distance_of(solved, one);
            if (distance >= PI && distance_of(solved, other) < distance)
                is_other = !is_other;
        }
        for (int64_t axis = 0; axis < axes; axis++) {
            const double angle = is_other ? other[axis] : one[axis];
            turns[axis] += rint((angle - taken[axis]) * (1.0 / TURN));
            angles[axis * step + f] = angle - TURN * turns[axis];
            solved[axis] = one[axis], taken[axis] = angle;
        }
        is_plain = axes == 3 && !is_other && turns[0] == 0.0 && turns[1] == 0.0 && turns[2] == 0.0;
    }
}
