/* What motionedit/core/body does in many calls of numpy, in one: the same to the bit. */

#ifndef MOTIONEDIT_BODY_H
#define MOTIONEDIT_BODY_H

#include <stdint.h>

/* By what a point is taken to stand: contacts.py says what each is. Times are in frames, lengths in metres. */
typedef struct {
    int64_t half, low_while, longest_gap, shortest, top_while;
    double frame_time, enters, leaves, low, same_place, top, held;
} StandRules;

/* A stretch in which a point stands, both ends in, and how high, in metres. */
typedef struct {
    int64_t point, start, stop;
    double height;
} Stand;

/* The stands of P points along tracks (F, P, 3), so many units to a metre; `feet` (P,) says whose they are.

   Returns how many there are in `found`, which is to be freed; -1 where memory ran out. */
int64_t find_stands(const double *tracks, int64_t frames, int64_t points, const int64_t *feet, const double *up,
    double metre, const StandRules *rules, Stand **found);

#endif
