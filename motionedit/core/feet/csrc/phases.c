/* Plants as feet can keep them: first settled, then, foot by foot, cut to what its leg can hold in one place. */

#include "phases.h"

#include "stance.h"

#include <stdlib.h>
#include <string.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

/* Numbers that are known of a leg at a frame, and those of its toe's place. */
enum { NUMBERS = sizeof(LegPath) / sizeof(double) + 3 };

/* Lay a leg's path out number by number: all its ankles, then all its toes, and so on. */
static FootTrack laid_out(const Soles *soles, int64_t foot, double *numbers, HipReach *leg)
{
    const int64_t frames = soles->frames;
    double *ankle = numbers, *toe_place = ankle + 3 * frames, *turn = toe_place + 3 * frames, *toe = turn + 4 * frames;
    double *hip = toe + 3 * frames, *reach = hip + 3 * frames;
    for (int64_t f = 0; f < frames; f++) {
        const LegPath *path = soles->legs + f * soles->feet + foot;
        memcpy(ankle + 3 * f, path->ankle, sizeof path->ankle);
        memcpy(turn + 4 * f, path->turn, sizeof path->turn);
        memcpy(toe + 3 * f, path->toe, sizeof path->toe);
        memcpy(hip + 3 * f, path->hip, sizeof path->hip);
        q_turn(path->turn, path->toe, toe_place + 3 * f);
        add(toe_place + 3 * f, path->ankle);
        reach[f] = path->reach;
    }
    leg->hip = hip, leg->reach = reach;
    return (FootTrack){frames, ankle, toe_place, turn, toe};
}

/* Cut the plants of one foot; `spans` has room for all plants. */
static int keep_of_foot(const Soles *soles, const PhaseRules *rules, int64_t foot, double *numbers, PlantSpan *spans,
    SolePlant *plants, int64_t count)
{
    HipReach leg = {.rounding = rules->rounding};
    int64_t own = 0;
    for (int64_t k = 0; k < count; k++)
        if (plants[k].foot == foot)
            spans[own++] = (PlantSpan){plants[k].is_toe, plants[k].start, plants[k].stop};
    if (own == 0)
        return 0;
    const FootTrack track = laid_out(soles, foot, numbers, &leg);
    if (keep_plants(&track, &leg, rules->shortest_kept, rules->rounds, spans, own) < 0)
        return -1;
    for (int64_t k = 0; k < count; k++)
        if (plants[k].foot == foot)
            plants[k].stop = (spans++)->stop;
    return 0;
}

int cut_to_phases(const Soles *soles, const PhaseRules *rules, SolePlant *plants, int64_t count)
{
    double *numbers = malloc(sizeof *numbers * NUMBERS * ((size_t)soles->frames + 1));
    PlantSpan *spans = malloc(sizeof *spans * ((size_t)count + 1));
    int status = numbers == NULL || spans == NULL ? -1 : settle_plants(soles, rules, plants, count);
    for (int64_t foot = 0; foot < soles->feet && status == 0; foot++)
        status = keep_of_foot(soles, rules, foot, numbers, spans, plants, count);
    free(numbers), free(spans);
    return status;
}
