/* A motion sampled at parts of frames. */

#define ONE_LANE
#include "samples.h"

#include "../../csrc/arrays.h"
#include "../../csrc/rotations.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Frames whose rotations and sums stay near the processor. */
enum { TILE = 32 };

static int64_t after(const Samples *samples, int64_t sample)
{
    const int64_t frame = samples->at[sample] + 1;
    return frame < samples->frames ? frame : samples->frames - 1;
}

void arc_cosines(const Samples *samples, const Ways *ways, double *cosines, double *sizes)
{
    const int64_t frame = 4 * ways->joints;
    for (int64_t n = 0; n < samples->count; n++) {
        const double *a = ways->rotations + frame * samples->at[n], *b = ways->rotations + frame * after(samples, n);
        for (int64_t j = 0; j < ways->joints; j++, a += 4, b += 4) {
            const double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], size = fabs(cosine);
            *cosines++ = cosine, *sizes++ = size > 1.0 ? 1.0 : size;
        }
    }
}

void arc_parts(const Samples *samples, int64_t joints, double *parts)
{
    const int64_t all = samples->count * joints;
    for (int64_t n = 0; n < samples->count; n++, parts += joints) {
        const double t = samples->t[n], rest = 1.0 - t;
        for (int64_t j = 0; j < joints; j++) {
            const double half = 0.5 * parts[j];
            parts[j] = half, parts[all + j] = rest * half, parts[2 * all + j] = t * half;
        }
    }
}

void arc_weights(const Samples *samples, int64_t joints, const double *cosines, double straight, double *parts)
{
    const int64_t all = samples->count * joints;
    for (int64_t n = 0; n < samples->count; n++, parts += joints, cosines += joints) {
        const double t = samples->t[n];
        double *const first = parts + all, *const second = first + all;
        /* Both forms of each weight, so that nothing depends on a branch: several are found at once. */
        for (int64_t j = 0; j < joints; j++) {
            const double whole = parts[j], rest = first[j], way = second[j], sine = whole / (1.0 + whole * whole);
            const double from = rest / (1.0 + rest * rest) / sine, to = way / (1.0 + way * way) / sine;
            first[j] = whole < straight ? 1.0 - t : from;
            second[j] = copysign(whole < straight ? t : to, cosines[j]);
        }
    }
}

/* The rotation of a joint at a sample. */
static inline void turn_at(const Samples *samples, const Ways *ways, int64_t sample, int64_t joint, double *out)
{
    const double *a = ways->rotations + 4 * (ways->joints * samples->at[sample] + joint);
    const double *b = ways->rotations + 4 * (ways->joints * after(samples, sample) + joint);
    const double first = ways->first[sample * ways->joints + joint],
                 second = ways->second[sample * ways->joints + joint];
    for (int part = 0; part < 4; part++)
        out[part] = first * a[part] + second * b[part];
}

void sampled_turns(const Samples *samples, const Ways *ways, double *out)
{
    for (int64_t n = 0; n < samples->count; n++)
        for (int64_t j = 0; j < ways->joints; j++, out += 4)
            turn_at(samples, ways, n, j, out);
}

void sampled_sums(const Samples *samples, const Ways *ways, const Placing *placing, const int64_t *joints, int64_t many,
    const int *axes, double *sums)
{
    double turns[4 * TILE];
    for (int64_t start = 0; start < samples->count; start += TILE)
        for (int64_t k = 0; k < many; k++) {
            const int64_t frames = samples->count - start < TILE ? samples->count - start : TILE;
            for (int64_t f = 0; f < frames; f++)
                turn_at(samples, ways, start + f, joints[k], turns + 4 * f);
            for (int64_t f = 0; joints[k] == 0 && f < frames; f++)
                q_multiply(placing->rotation, turns + 4 * f, turns + 4 * f);
            sums_of_turns(turns, 4, frames, axes, sums + k * samples->count + start, many * samples->count);
        }
}

int angle_columns(double *sums, int64_t frames, const Solving *solving, const double *seeds, const Columns *columns)
{
    const int64_t plane = columns->count * frames;
    const double sign = (solving->axes[1] - solving->axes[0] + 3) % 3 == 1 ? 1.0 : -1.0;
    for (int64_t k = 0; k < columns->count; k++) {
        double *const at = sums + k * frames, *const angles = at + plane;
        int is_locked = 0;
        for (int64_t f = 0; f < frames; f++) {
            const double plus = at[f], minus = at[2 * plane + f], middle = at[4 * plane + f] * 2.0 - PI / 2.0;
            angles[f] = plus + minus, angles[2 * plane + f] = middle;
            angles[4 * plane + f] = (plus - minus) * sign;
            is_locked |= fabs(middle) > solving->locked;
        }
        if (is_locked)
            return 0;
        nearest_angles(angles, 3, 2 * plane, frames, seeds + 3 * k);
        for (int axis = 0; axis < 3; axis++) {
            double *row = columns->rows + columns->columns[3 * k + axis];
            for (int64_t f = 0; f < frames; f++, row += columns->width)
                *row = solving->factor * angles[2 * plane * axis + f];
        }
    }
    return 1;
}

void place_columns(
    const Samples *samples, const double *translations, int64_t placed, const Placing *placing, const Columns *columns)
{
    const int64_t frame = 3 * columns->count;
    for (int64_t n = 0; n < samples->count; n++) {
        const double *a = translations + frame * samples->at[n], *b = translations + frame * after(samples, n);
        double *const row = columns->rows + n * columns->width;
        for (int64_t p = 0; p < columns->count; p++, a += 3, b += 3) {
            double place[3], turned[3];
            for (int axis = 0; axis < 3; axis++)
                turned[axis] = a[axis] + samples->t[n] * (b[axis] - a[axis]);
            if (p == placed) {
                for (int axis = 0; axis < 3; axis++)
                    place[axis] = 0.0 + turned[axis] - placing->origin[axis];
                q_turn(placing->rotation, place, turned);
            }
            for (int axis = 0; axis < 3; axis++)
                if (columns->columns[3 * p + axis] >= 0)
                    row[columns->columns[3 * p + axis]] = turned[axis];
        }
    }
}
