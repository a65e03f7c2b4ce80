/* Euler angles as rows of a file where an edit touched them, joint by joint and run by run. */

#include "touched_rows.h"

#include "../../csrc/arrays.h"

#include <math.h>

#define PI 3.14159265358979323846

/* One solution of a joint's angles at all frames, in place of half of its sums, as `_angles_of_sums` in euler.py has it;
   0 where one is near gimbal lock. */
static int solve_angles(const Turned *of, double *sums, int64_t plane)
{
    int locked = 0;
    for (int64_t f = 0; f < of->frames; f++) {
        const double plus = sums[f], minus = sums[2 * plane + f];
        sums[plane + f] = plus + minus;
        sums[3 * plane + f] = 2.0 * sums[4 * plane + f] - PI / 2.0;
        sums[5 * plane + f] = of->sign * (plus - minus);
        locked |= fabs(sums[3 * plane + f]) > of->most_middle;
    }
    return !locked;
}

/* The input's angles of three columns at a frame, rad; 0 where one is wound up. */
static int given_at(const Turned *of, int64_t frame, const int64_t *columns, double *angles)
{
    for (int i = 0; i < 3; i++) {
        const double degrees = of->given[frame * of->width + columns[i]];
        if (!(fabs(degrees) <= of->most_wound))
            return 0;
        angles[i] = degrees * (PI / 180.0);
    }
    return 1;
}

/* Make a run of touched frames continuous, from the input's angles at the frame before; 0 where it does not meet those at
   its own last one. */
static int follow(const Turned *of, int64_t start, int64_t stop, const int64_t *columns, double *angles, int64_t step)
{
    double seed[3], last[3];
    if (!given_at(of, start > 0 ? start - 1 : 0, columns, seed))
        return 0;
    nearest_angles(angles + start, 3, step, stop - start, seed);
    if (stop == of->frames)
        return 1;
    if (!given_at(of, stop - 1, columns, last))
        return 0;
    for (int i = 0; i < 3; i++)
        if (rint((last[i] - angles[i * step + stop - 1]) / PI) != 0.0)
            return 0;
    return 1;
}

int touched_rows(const Turned *of, double *sums, double *values, uint8_t *cells)
{
    const int64_t plane = of->count * of->frames, step = 2 * plane;
    for (int64_t n = 0; n < of->count; n++) {
        const uint8_t *const touched = of->touched + of->joints[n];
        const int64_t *const columns = of->columns + 3 * n;
        double *const angles = sums + plane + n * of->frames;
        if (!solve_angles(of, sums + n * of->frames, plane))
            return 0;
        for (int64_t start = 0, stop; start < of->frames; start = stop) {
            for (stop = start; stop < of->frames && touched[stop * of->all]; stop++)
                ;
            if (stop == start) {
                stop++;
                continue;
            }
            if (!follow(of, start, stop, columns, angles, step))
                return 0;
            for (int64_t f = start; f < stop; f++)
                for (int i = 0; i < 3; i++) {
                    values[f * of->width + columns[i]] = (180.0 / PI) * angles[i * step + f];
                    cells[f * of->width + columns[i]] = 1;
                }
        }
    }
    return 1;
}
