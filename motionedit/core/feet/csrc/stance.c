/* Plants of a heel and a toe as one foot: which hang together, and where each is. */

#include "stance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ONE_LANE
#include "../../csrc/rotations.h"

/* A frame at which a heel and a toe are down. */
typedef struct {
    int64_t heel, toe, frame;
} Both;

static int in_order(const void *a, const void *b)
{
    const Both *one = a, *other = b;
    if (one->heel != other->heel)
        return one->heel < other->heel ? -1 : 1;
    if (one->toe != other->toe)
        return one->toe < other->toe ? -1 : 1;
    return (one->frame > other->frame) - (one->frame < other->frame);
}

/* To which stand each plant belongs, where it is within it, and which of its stand is next, in a ring. */
typedef struct {
    int64_t count, *whole, *next;
    double *offsets; /* shape (count, 3) */
} Stands;

/* Hang a toe on a heel, so that it is `way` from it, with all that hangs on it. */
static void chain(Stands *stands, int64_t heel, int64_t toe, const double *way)
{
    double shift[3];
    if (stands->whole[toe] == stands->whole[heel])
        return;
    for (int a = 0; a < 3; a++)
        shift[a] = stands->offsets[3 * heel + a] + way[a] - stands->offsets[3 * toe + a];
    int64_t k = toe;
    do {
        stands->whole[k] = stands->whole[heel];
        for (int a = 0; a < 3; a++)
            stands->offsets[3 * k + a] += shift[a];
        k = stands->next[k];
    } while (k != toe);
    const int64_t after = stands->next[heel];
    stands->next[heel] = stands->next[toe], stands->next[toe] = after;
}

/* Give frames in which heel and toe are down together one turn, and hang the toe on the heel by it. */
static void link_both(const FootTrack *track, const Both *both, int64_t count, const StanceFound *found, Stands *stands)
{
    double sum[4] = {0.0}, arm[3] = {0.0}, way[3];
    const double *first = track->turn + 4 * both[0].frame;
    for (int64_t i = 0; i < count; i++) {
        const double *q = track->turn + 4 * both[i].frame, *toe = track->toe + 3 * both[i].frame;
        const double sign = q[0] * first[0] + q[1] * first[1] + q[2] * first[2] + q[3] * first[3] < 0.0 ? -1.0 : 1.0;
        for (int a = 0; a < 4; a++)
            sum[a] += sign * q[a];
        for (int a = 0; a < 3; a++)
            arm[a] += toe[a];
    }
    double square = 0.0;
    for (int a = 0; a < 4; a++) /* rounded once, as in the products of vectors that numpy has made */
        square = fma(sum[a], sum[a], square);
    for (int a = 0; a < 4; a++)
        sum[a] /= sqrt(square);
    for (int a = 0; a < 3; a++)
        arm[a] /= (double)count;
    for (int64_t i = 0; i < count; i++)
        memcpy(found->turn + 4 * both[i].frame, sum, sizeof sum);
    q_turn(sum, arm, way);
    chain(stands, both[0].heel, both[0].toe, way);
}

/* Toes by the frame at which they come down, and by that at which they go up: the last of each frame, -1 where there is
   none, and before each toe another of its frame. */
typedef struct {
    int64_t *at, *before;
} ByFrame;

static void sort_toes(const PlantSpan *plants, int64_t count, int64_t frames, int by_stop, const ByFrame *toes)
{
    for (int64_t f = 0; f < frames; f++)
        toes->at[f] = -1;
    for (int64_t k = 0; k < count; k++) {
        const int64_t frame = by_stop ? plants[k].stop : plants[k].start;
        if (plants[k].is_toe)
            toes->before[k] = toes->at[frame], toes->at[frame] = k;
    }
}

static int ascending(const void *a, const void *b)
{
    const int64_t one = *(const int64_t *)a, other = *(const int64_t *)b;
    return (one > other) - (one < other);
}

/* Hang together heels and toes of which one comes down as the other goes up; `found` has room for all plants twice. */
static void link_meetings(const FootTrack *track, const PlantSpan *plants, const ByFrame *by_start,
    const ByFrame *by_stop, int64_t *found, Stands *stands)
{
    for (int64_t h = 0; h < stands->count; h++) {
        const PlantSpan *heel = plants + h;
        int64_t meeting = 0;
        if (heel->is_toe)
            continue;
        for (int64_t t = heel->stop + 1 < track->frames ? by_start->at[heel->stop + 1] : -1; t >= 0;
            t = by_start->before[t])
            found[meeting++] = t;
        for (int64_t t = heel->start > 0 ? by_stop->at[heel->start - 1] : -1; t >= 0; t = by_stop->before[t])
            found[meeting++] = t;
        qsort(found, (size_t)meeting, sizeof *found, ascending);
        for (int64_t i = 0; i < meeting; i++) {
            const PlantSpan *toe = plants + found[i];
            const int64_t at = heel->start > toe->start ? heel->start : toe->start;
            double way[3];
            q_turn(track->turn + 4 * at, track->toe + 3 * at, way);
            chain(stands, h, found[i], way);
        }
    }
}

/* Where each plant is: the mean of its stand's ways from the motion's own places is nothing. `members` has room for all
   plants; those that have a place are no longer in their ring. */
static void place_plants(
    const FootTrack *track, const PlantSpan *plants, const Stands *stands, int64_t *members, double *places)
{
    for (int64_t first = 0; first < stands->count; first++) {
        double mean[3] = {0.0};
        int64_t frames = 0, count = 0;
        for (int64_t k = first, next; stands->next[k] >= 0; k = next) {
            members[count++] = k;
            next = stands->next[k], stands->next[k] = -1;
        }
        qsort(members, (size_t)count, sizeof *members, ascending);
        for (int64_t i = 0; i < count; i++) {
            const PlantSpan *plant = plants + members[i];
            const double *tracks = plant->is_toe ? track->toe_place : track->ankle;
            for (int64_t f = plant->start; f <= plant->stop; f++, frames++)
                for (int a = 0; a < 3; a++)
                    mean[a] += tracks[3 * f + a] - stands->offsets[3 * members[i] + a];
        }
        for (int64_t i = 0; i < count; i++)
            for (int a = 0; a < 3; a++)
                places[3 * members[i] + a] = mean[a] / (double)frames + stands->offsets[3 * members[i] + a];
    }
}

/* The frames at which heel and toe are down, by heels and toes; `down` (2, F) are the plants there, -1 where none is. */
static int64_t find_both(const int64_t *down, int64_t frames, Both *both)
{
    int64_t count = 0;
    int sorted = 1; /* as they are where plants are in the order of their frames */
    for (int64_t f = 0; f < frames; f++)
        if (down[f] >= 0 && down[frames + f] >= 0) {
            both[count] = (Both){down[f], down[frames + f], f};
            sorted = sorted && (count == 0 || in_order(both + count - 1, both + count) < 0);
            count++;
        }
    if (!sorted)
        qsort(both, (size_t)count, sizeof *both, in_order);
    return count;
}

/* Write where each part is at each frame, from the plants' places. */
static void write_places(
    const int64_t *down, const Stands *stands, const double *places, int64_t frames, const StanceFound *found)
{
    uint8_t *flags[2] = {found->heel, found->toe};
    double *out[2] = {found->heel_place, found->toe_place};
    for (int64_t f = 0; f < frames; f++) {
        const int64_t there = down[f] >= 0 ? down[f] : down[frames + f];
        found->whole[f] = there < 0 ? -1 : stands->whole[there];
        for (int part = 0; part < 2; part++) {
            const int64_t k = down[part * frames + f];
            flags[part][f] = k >= 0;
            for (int a = 0; a < 3; a++)
                out[part][3 * f + a] = k < 0 ? 0.0 : places[3 * k + a];
        }
    }
}

int find_stance(const FootTrack *track, const PlantSpan *plants, int64_t count, const StanceFound *found)
{
    const int64_t frames = track->frames;
    const size_t numbers = 6 * (size_t)count + 1, integers = 4 * (size_t)frames + 6 * (size_t)count + 1;
    double *places = calloc(numbers, sizeof *places);
    int64_t *down = malloc(sizeof *down * integers);
    Both *both = malloc(sizeof *both * ((size_t)frames + 1));
    const int fits = places != NULL && down != NULL && both != NULL;
    if (fits) {
        int64_t *by_frame = down + 2 * frames, *by_plant = by_frame + 2 * frames;
        Stands stands = {count, by_plant, by_plant + count, places + 3 * count};
        const ByFrame by_start = {by_frame, by_plant + 2 * count}, by_stop = {by_frame + frames, by_plant + 3 * count};
        int64_t *some = by_plant + 4 * count;
        for (int64_t f = 0; f < 2 * frames; f++)
            down[f] = -1;
        for (int64_t k = 0; k < count; k++) {
            stands.whole[k] = stands.next[k] = k;
            for (int64_t f = plants[k].start; f <= plants[k].stop; f++)
                down[(plants[k].is_toe ? frames : 0) + f] = k;
        }
        memcpy(found->turn, track->turn, 4 * sizeof *found->turn * (size_t)frames);
        const int64_t pairs = find_both(down, frames, both);
        for (int64_t i = 0, next; i < pairs; i = next) {
            for (next = i + 1; next < pairs && both[next].heel == both[i].heel && both[next].toe == both[i].toe;)
                next++;
            link_both(track, both + i, next - i, found, &stands);
        }
        sort_toes(plants, count, frames, 0, &by_start), sort_toes(plants, count, frames, 1, &by_stop);
        link_meetings(track, plants, &by_start, &by_stop, some, &stands);
        place_plants(track, plants, &stands, some, places);
        write_places(down, &stands, places, frames, found);
    }
    free(places), free(down), free(both);
    return fits ? 0 : -1;
}
