/* Plants cut to what a leg can hold in one place: what motionedit/core/feet/phases.py does round by round. */

#include "stance.h"

#include <math.h>
#include <stdlib.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

/* Let heels come up once the hip is out of their reach, where the toe stays down: as reach.released. */
static void release(const HipReach *leg, int64_t frames, const StanceFound *stance)
{
    for (int64_t start = 0, stop; start < frames; start = stop + 1) {
        int64_t near = -1;
        for (stop = start; stop < frames && stance->heel[stop] && stance->toe[stop]; stop++) {
            const double *hip = leg->hip + 3 * stop, *heel = stance->heel_place + 3 * stop;
            const double way[3] = {hip[0] - heel[0], hip[1] - heel[1], hip[2] - heel[2]};
            if (!(sqrt(dot(way, way)) > leg->reach[stop] * (1.0 + leg->rounding)))
                near = stop;
        }
        /* The frames from `start` to before `stop` are flat. */
        if (stop == start || near == stop - 1 || (stop < frames && stance->heel[stop]))
            continue;
        for (int64_t f = near < 0 ? start : near + 1; f < stop; f++)
            stance->heel[f] = 0;
    }
}

/* The last frame of a plant after heels came up; -1 where nothing is left of it. */
static int64_t held_to(const PlantSpan *plant, const StanceFound *stance, int64_t shortest)
{
    int64_t stop = plant->stop;
    while (!plant->is_toe && stop >= plant->start && !stance->heel[stop])
        stop--;
    if (stop == plant->stop)
        return stop;
    if (stop - plant->start >= shortest)
        for (int64_t f = plant->start; f <= stop; f++)
            if (stance->toe[f])
                return stop;
    return -1;
}

typedef struct {
    PlantSpan plant;
    int64_t place, stop; /* among those that were given; where it is held to now, -1 where nothing is left of it */
    int asked;           /* in this round */
} Kept;

static int by_start(const void *a, const void *b)
{
    const Kept *one = *(Kept *const *)a, *other = *(Kept *const *)b;
    return one->plant.start != other->plant.start ? (one->plant.start < other->plant.start ? -1 : 1)
                                                  : (one->place > other->place) - (one->place < other->place);
}

/* Ask on for those that overlap or meet one that changed, or another that does, and so on, of plants by their starts.
   What hangs together with none that changed would come out as it is. */
static void ask_beside_changed(Kept **in_order, int64_t count)
{
    for (int64_t first = 0, next; first < count; first = next) {
        int64_t stop = -2;
        int changed = 0;
        for (next = first; next < count; next++) {
            const Kept *each = in_order[next];
            if (!each->asked)
                continue;
            if (stop >= 0 && each->plant.start > stop + 1)
                break;
            stop = each->plant.stop > stop ? each->plant.stop : stop;
            changed |= each->stop != each->plant.stop;
        }
        for (int64_t i = first; i < next; i++) {
            Kept *each = in_order[i];
            each->asked &= changed && each->stop >= 0;
            each->plant.stop = each->stop;
        }
    }
}

/* One round; returns whether anything was asked for, -1 where memory ran out. `some` has room for all plants. */
static int keep_once(const FootTrack *track, const HipReach *leg, int64_t shortest, Kept *kept, int64_t count,
    PlantSpan *some, const StanceFound *stance)
{
    int64_t asked = 0;
    for (int64_t k = 0; k < count; k++)
        if (kept[k].asked)
            some[asked++] = kept[k].plant;
    if (asked == 0)
        return 0;
    if (find_stance(track, some, asked, stance) < 0)
        return -1;
    release(leg, track->frames, stance);
    for (int64_t k = 0; k < count; k++)
        if (kept[k].asked)
            kept[k].stop = held_to(&kept[k].plant, stance, shortest);
    return 1;
}

int keep_plants(
    const FootTrack *track, const HipReach *leg, int64_t shortest, int64_t rounds, PlantSpan *plants, int64_t count)
{
    const size_t frames = (size_t)track->frames, all = (size_t)count + 1;
    double *numbers = malloc(sizeof *numbers * 10 * (frames + 1));
    int64_t *whole = malloc(sizeof *whole * (frames + 1));
    uint8_t *down = malloc(2 * (frames + 1));
    Kept *kept = malloc(sizeof *kept * all), **in_order = malloc(sizeof *in_order * all);
    PlantSpan *some = malloc(sizeof *some * all);
    int going = numbers && whole && down && kept && in_order && some ? 1 : -1;
    if (going > 0) {
        const StanceFound stance = {down, down + frames, numbers, numbers + 3 * frames, numbers + 6 * frames, whole};
        for (int64_t k = 0; k < count; k++) {
            kept[k] = (Kept){plants[k], k, plants[k].stop, 1};
            in_order[k] = kept + k;
        }
        qsort(in_order, (size_t)count, sizeof *in_order, by_start);
        for (int64_t round = 0; round < rounds && going > 0; round++) {
            going = keep_once(track, leg, shortest, kept, count, some, &stance);
            if (going > 0)
                ask_beside_changed(in_order, count);
        }
        for (int64_t k = 0; k < count; k++)
            plants[k].stop = kept[k].stop;
    }
    free(numbers), free(whole), free(down), free(kept), free(in_order), free(some);
    return going < 0 ? -1 : 0;
}
