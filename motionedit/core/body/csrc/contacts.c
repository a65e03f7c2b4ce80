/* When points of feet stand: contacts.py in one pass a point. */

#include "body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    int64_t first, last;
} Run;

/* The runs of what is there, at most half as many as frames, rounded up. */
static int64_t runs_of(const uint8_t *there, int64_t frames, Run *runs)
{
    int64_t count = 0;
    for (int64_t f = 0; f < frames; f++) {
        if (!there[f])
            continue;
        if (count > 0 && runs[count - 1].last == f - 1)
            runs[count - 1].last = f;
        else
            runs[count].first = runs[count].last = f, count++;
    }
    return count;
}

/* Leave of the runs of what is `wide` those in which the speed is anywhere below a limit; how many. */
static int64_t slow_runs(uint8_t *wide, const double *speed, double limit, int64_t frames, Run *runs)
{
    const int64_t count = runs_of(wide, frames, runs);
    int64_t kept = 0;
    for (int64_t k = 0; k < count; k++) {
        int64_t f = runs[k].first;
        while (f <= runs[k].last && !(speed[f] < limit))
            f++;
        if (f <= runs[k].last)
            runs[kept++] = runs[k];
        else
            memset(wide + runs[k].first, 0, (size_t)(runs[k].last - runs[k].first + 1));
    }
    return kept;
}

static double distance(const double *a, const double *b)
{
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static void find_speeds(const double *places, int64_t frames, const StandRules *rules, double *speed)
{
    for (int64_t f = 0; f < frames; f++) {
        const int64_t before = f > rules->half ? f - rules->half : 0;
        const int64_t after = f + rules->half < frames ? f + rules->half : frames - 1;
        speed[f] = distance(places + 3 * after, places + 3 * before) / ((double)(after - before) * rules->frame_time);
    }
}

/* The least of the values within `width` frames on both sides; `padded` has room for frames + 2 width, its middle
   filled, and what is least around frame f is then in its place f. */
static void rolling_minimum(double *padded, int64_t frames, int64_t width)
{
    int64_t length = frames + 2 * width, span = 1;
    const int64_t window = 2 * width + 1;
    for (int64_t i = 0; i < width; i++)
        padded[i] = padded[frames + width + i] = INFINITY;
    while (span < window) {
        const int64_t step = span < window - span ? span : window - span;
        length -= step;
        for (int64_t i = 0; i < length; i++)
            padded[i] = padded[i + step] < padded[i] ? padded[i + step] : padded[i];
        span += step;
    }
}

/* Put runs together where fewer frames part them than a gap has and the point stays at its place; how many. */
static int64_t close_gaps(Run *runs, int64_t count, const double *places, const StandRules *rules)
{
    int64_t joined = 0;
    for (int64_t k = 0; k < count; k++) {
        int together = joined > 0 && runs[k].first - runs[joined - 1].last - 1 < rules->longest_gap;
        for (int64_t f = together ? runs[joined - 1].last + 1 : 0; together && f <= runs[k].first; f++)
            together = distance(places + 3 * f, places + 3 * runs[joined - 1].last) < rules->same_place;
        if (together)
            runs[joined - 1].last = runs[k].last;
        else
            runs[joined++] = runs[k];
    }
    return joined;
}

static int any_below(const double *heights, int64_t start, int64_t stop, double level)
{
    for (int64_t f = start; f < stop; f++)
        if (heights[f] < level)
            return 1;
    return 0;
}

/* Whether a stretch is the top of a jump or a foot held in the air: the point comes up to it, and goes down from it.
   `from` is the slow run in which the stretch before began: stretches come in their order. */
static int is_top(Run run, int64_t *from, const Run *slow, int64_t slows, const double *heights, const double *lowest,
    int64_t frames, const StandRules *rules, double *room)
{
    double level = heights[run.first];
    for (int64_t f = run.first; f <= run.last; f++)
        level = heights[f] < level ? heights[f] : level;
    while (slow[*from].last < run.first)
        (*from)++;
    int64_t to = *from;
    while (to + 1 < slows && slow[to + 1].first <= run.last)
        to++;
    const int64_t began = slow[*from].first, ended = slow[to].last, while_ = rules->top_while;
    const int64_t start = began > while_ ? began - while_ : 0;
    const int64_t stop = ended + 1 + while_ < frames ? ended + 1 + while_ : frames;
    const int comes = began > start, goes = stop > ended + 1;
    const double below = level - rules->top;
    if ((!comes && !goes) || (comes && !any_below(heights, start, began, below)) ||
        (goes && !any_below(heights, ended + 1, stop, below)))
        return 0;
    const int64_t count = run.last - run.first + 1;
    return (double)count < rules->held || median(lowest + run.first, count, room) < below;
}

/* Room for one point: what is known of it at each frame. */
typedef struct {
    double *places, *heights, *lowest, *speed, *low, *sorted;
    uint8_t *wide;
    Run *slow, *planted;
} Room;

static void *make_room(Room *room, int64_t frames, int64_t width)
{
    const size_t count = (size_t)frames, numbers = 7 * count + count + 2 * (size_t)width;
    double *all = malloc(sizeof *all * numbers + 2 * sizeof(Run) * (count / 2 + 1) + count);
    if (all == NULL)
        return NULL;
    room->places = all, room->heights = all + 3 * count, room->lowest = room->heights + count;
    room->speed = room->lowest + count, room->sorted = room->speed + count, room->low = room->sorted + count;
    room->slow = (Run *)(void *)(all + numbers), room->planted = room->slow + count / 2 + 1;
    room->wide = (uint8_t *)(room->planted + count / 2 + 1);
    return all;
}

/* The stretches in which a point stands, in `room->planted`; how many. */
static int64_t stands_of(const Room *room, int64_t frames, const StandRules *rules)
{
    double *low = room->low + rules->low_while;
    find_speeds(room->places, frames, rules, room->speed);
    for (int64_t f = 0; f < frames; f++)
        room->wide[f] = room->speed[f] < rules->leaves;
    const int64_t slows = slow_runs(room->wide, room->speed, rules->enters, frames, room->slow);
    for (int64_t f = 0; f < frames; f++)
        low[f] = room->wide[f] ? room->heights[f] : INFINITY;
    rolling_minimum(room->low, frames, rules->low_while);
    for (int64_t f = 0; f < frames; f++)
        room->wide[f] = room->wide[f] && room->heights[f] < room->low[f] + rules->low;
    int64_t count = slow_runs(room->wide, room->speed, rules->enters, frames, room->planted), kept = 0, from = 0;
    count = close_gaps(room->planted, count, room->places, rules);
    for (int64_t k = 0; k < count; k++) {
        const Run run = room->planted[k];
        if (run.last - run.first + 1 >= rules->shortest &&
            !is_top(run, &from, room->slow, slows, room->heights, room->lowest, frames, rules, room->sorted))
            room->planted[kept++] = run;
    }
    return kept;
}

static double height_of(const double *place, const double *up)
{
    return place[0] * up[0] + place[1] * up[1] + place[2] * up[2];
}

int64_t find_stands(const double *tracks, int64_t frames, int64_t points, const int64_t *feet, const double *up,
    double metre, const StandRules *rules, Stand **found)
{
    Room room;
    void *all = make_room(&room, frames, rules->low_while);
    int64_t count = 0;
    *found = NULL;
    for (int64_t p = 0; all != NULL && p < points; p++) {
        for (int64_t f = 0; f < frames; f++) {
            const double *places = tracks + 3 * f * points;
            for (int a = 0; a < 3; a++)
                room.places[3 * f + a] = places[3 * p + a] / metre;
            double lowest = INFINITY;
            for (int64_t q = 0; q < points; q++)
                if (feet[q] != feet[p]) {
                    const double height = height_of(places + 3 * q, up);
                    lowest = height < lowest ? height : lowest;
                }
            room.heights[f] = height_of(places + 3 * p, up) / metre, room.lowest[f] = lowest / metre;
        }
        const int64_t more = stands_of(&room, frames, rules);
        Stand *stands = realloc(*found, sizeof *stands * (size_t)(count + more + 1));
        if (stands == NULL) {
            free(all), all = NULL;
            break;
        }
        *found = stands;
        for (int64_t k = 0; k < more; k++) {
            const Run run = room.planted[k];
            const double height = median(room.heights + run.first, run.last - run.first + 1, room.sorted);
            stands[count++] = (Stand){p, run.first, run.last, height};
        }
    }
    if (all == NULL)
        free(*found), *found = NULL;
    free(all);
    return all == NULL ? -1 : count;
}
