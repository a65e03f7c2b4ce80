/* Medians, for which values need not be put in order. */

#include "body.h"

#include <stdlib.h>
#include <string.h>

/* The value that would be in a place if the values were in order: those before it are then no larger. */
static double in_place(double *values, int64_t count, int64_t place)
{
    for (int64_t low = 0, high = count - 1; low < high;) {
        const double middle = values[low + (high - low) / 2];
        int64_t i = low - 1, j = high + 1;
        for (;;) {
            while (values[++i] < middle)
                ;
            while (values[--j] > middle)
                ;
            if (i >= j)
                break;
            const double other = values[i];
            values[i] = values[j], values[j] = other;
        }
        if (place <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[place];
}

double median(const double *values, int64_t count, double *room)
{
    memcpy(room, values, sizeof *room * (size_t)count);
    const double upper = in_place(room, count, count / 2);
    if (count % 2)
        return upper;
    double lower = room[0];
    for (int64_t i = 1; i < count / 2; i++)
        lower = room[i] > lower ? room[i] : lower;
    return (lower + upper) / 2.0;
}

/* A way along one axis at a frame. */
static double way_along(const Poses *poses, int64_t frame, const int64_t *joints, int axis)
{
    double at[4];
    for (int i = 0; i < 4; i++)
        at[i] = joint_place(poses, frame, joints[i])[axis];
    return (at[2] + at[3]) / 2.0 - (at[0] + at[1]) / 2.0;
}

int find_median_ways(const Poses *poses, const int64_t *joints, int64_t count, double *out)
{
    const size_t frames = (size_t)poses->frames + 1;
    double *values = malloc(2 * sizeof *values * frames);
    if (values == NULL)
        return -1;
    for (int64_t i = 0; i < 3 * count; i++) {
        for (int64_t f = 0; f < poses->frames; f++)
            values[f] = way_along(poses, f, joints + 4 * (i / 3), (int)(i % 3));
        out[i] = median(values, poses->frames, values + frames);
    }
    free(values);
    return 0;
}
