/* Euler angles as rows of a file: what motionedit/core/euler_pieces.py does of short clips, in one loop. The same
   operations in the same order, so that the results are the same to the bit. */

#ifndef MOTIONEDIT_TOUCHED_ROWS_H
#define MOTIONEDIT_TOUCHED_ROWS_H

#include <stdint.h>

/* Joints that turn about the same three axes, `count` of `all`, each with three columns of rows that are so wide, in as many
   frames: where they are touched, shape (frames, all), and the rows that the input has, degrees. `sign` is that of the axes,
   as in euler.py; middle angles beyond the most are near gimbal lock, rad, and given ones are wound up, degrees. */
typedef struct {
    const int64_t *joints, *columns;
    int64_t count, all, frames, width;
    const uint8_t *touched;
    const double *given;
    double sign, most_middle, most_wound;
} Turned;

/* Write the angles of the touched frames, degrees, into rows of values, and which `cells` these are. `sums`, shape
   (6, count, frames), are those of `euler_sums`, of each pair the arc tangent in place of the first; they are used up.
   Returns 0 where an angle is near gimbal lock, or a run of frames does not meet the input after it by itself. */
int touched_rows(const Turned *of, double *sums, double *values, uint8_t *cells);

#endif
