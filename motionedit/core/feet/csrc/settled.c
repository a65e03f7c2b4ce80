/* Plants cut to when a point has settled: what motionedit/core/feet/settled.py does for all in many calls of numpy. */

#include "phases.h"

#include <math.h>
#include <stdlib.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

/* What is known of a plant at each of its frames, and as much room again for a median. */
typedef struct {
    double *places, *speeds, *heights, *room;
} Settling;

static void find_speeds(const Soles *soles, const PhaseRules *rules, int64_t frames, const Settling *own)
{
    for (int64_t f = 0; f < frames; f++) {
        const int64_t before = f > rules->half ? f - rules->half : 0;
        const int64_t after = f + rules->half < frames ? f + rules->half : frames - 1;
        const double *from = own->places + 3 * before, *to = own->places + 3 * after;
        const double way[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        /* A plant of one frame, which is too short to be cut, has no speed. */
        own->speeds[f] = sqrt(dot(way, way)) / ((double)(after > before ? after - before : 1) * soles->frame_time);
        own->heights[f] = dot(own->places + 3 * f, soles->up);
    }
}

/* Cut a plant to its first and last frame that are calm, where that leaves enough of it. */
static void settle(const Soles *soles, const PhaseRules *rules, const Settling *own, SolePlant *plant)
{
    const int64_t frames = plant->stop - plant->start + 1;
    int64_t first = -1, last = -1;
    for (int64_t f = 0; f < frames; f++)
        for (int a = 0; a < 3; a++)
            own->places[3 * f + a] =
                soles->tracks[3 * ((plant->start + f) * soles->points + plant->point) + a] / soles->metre;
    find_speeds(soles, rules, frames, own);
    const double fast = median(own->speeds, frames, own->room) + rules->faster;
    const double middle = median(own->heights, frames, own->room);
    for (int64_t f = 0; f < frames; f++)
        if (own->speeds[f] <= fast && fabs(own->heights[f] - middle) <= rules->above)
            first = first < 0 ? f : first, last = f;
    if (frames >= rules->fewest && first >= 0 && (double)(last - first + 1) * soles->frame_time >= rules->shortest)
        plant->stop = plant->start + last, plant->start += first;
}

int settle_plants(const Soles *soles, const PhaseRules *rules, SolePlant *plants, int64_t count)
{
    size_t most = 1;
    for (int64_t k = 0; k < count; k++) {
        const size_t frames = (size_t)(plants[k].stop - plants[k].start + 1);
        most = frames > most ? frames : most;
    }
    double *numbers = malloc(6 * sizeof *numbers * most);
    if (numbers == NULL)
        return -1;
    const Settling own = {numbers, numbers + 3 * most, numbers + 4 * most, numbers + 5 * most};
    for (int64_t k = 0; k < count; k++)
        settle(soles, rules, &own, plants + k);
    free(numbers);
    return 0;
}
