/* Where a foot stands: what motionedit/core/feet/stance.py does in many calls of numpy, in one. */

#ifndef MOTIONEDIT_STANCE_H
#define MOTIONEDIT_STANCE_H

#include <stdint.h>

/* A plant of a heel or a toe, both frames in. */
typedef struct {
    int64_t is_toe, start, stop;
} PlantSpan;

/* How a foot goes: its ankle and its toe in the world (F, 3), its turn (F, 4), and the toe in its frame (F, 3). */
typedef struct {
    int64_t frames;
    const double *ankle, *toe_place, *turn, *toe;
} FootTrack;

/* As stance.Stance: which part is down (F,), where (F, 3), the turn (F, 4), and the stand of each frame (F,). */
typedef struct {
    uint8_t *heel, *toe;
    double *heel_place, *toe_place, *turn;
    int64_t *whole;
} StanceFound;

/* Fill in the stance of a foot from n plants, which lie within the frames; -1 where memory ran out. */
int find_stance(const FootTrack *track, const PlantSpan *plants, int64_t count, const StanceFound *found);

/* A leg's hip in the world (F, 3), and how far from it an ankle may be (F,), a rounding more by its own share. */
typedef struct {
    const double *hip, *reach;
    double rounding;
} HipReach;

/* Cut plants of a foot to what the leg can hold in one place, in so many rounds at most: `stop` is then where each is
   held to, -1 where no `shortest` frames are left of one. -1 where memory ran out. */
int keep_plants(
    const FootTrack *track, const HipReach *leg, int64_t shortest, int64_t rounds, PlantSpan *plants, int64_t count);

#endif
