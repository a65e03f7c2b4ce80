/* How well feet stand: feet/measures.py in one pass over the frames, and one over the plants. */

#include "body.h"

#include <math.h>

static void place_of(const FootTracks *feet, int64_t frame, int64_t point, double *place)
{
    for (int a = 0; a < 3; a++)
        place[a] = feet->tracks[3 * (frame * feet->points + point) + a] * feet->scale;
}

static double height_of(const FootTracks *feet, const double *place)
{
    return place[0] * feet->up[0] + place[1] * feet->up[1] + place[2] * feet->up[2];
}

/* How fast a point goes on the level from a frame to the next, m/s. */
static double speed_of(const FootTracks *feet, int64_t frame, int64_t point)
{
    double here[3], there[3], square = 0.0;
    place_of(feet, frame, point, here), place_of(feet, frame + 1, point, there);
    const double low = height_of(feet, here), high = height_of(feet, there);
    for (int a = 0; a < 3; a++) {
        const double step = (there[a] - high * feet->up[a]) - (here[a] - low * feet->up[a]);
        square += step * step;
    }
    return sqrt(square) / feet->frame_time;
}

static double height_at(const FootTracks *feet, int64_t frame, int64_t point)
{
    double place[3];
    place_of(feet, frame, point, place);
    return height_of(feet, place);
}

static double share_of(int64_t some, int64_t all)
{
    return all > 0 ? (double)some / (double)all : 0.0;
}

static void measure_frames(const FootTracks *feet, FootFigures *figures)
{
    int64_t near = 0, fast = 0, under = 0;
    double sum = 0.0, deepest = 0.0;
    for (int64_t f = feet->first; f < feet->frames; f++) {
        double lowest = INFINITY;
        for (int64_t p = 0; p < feet->points; p++) {
            const double height = height_at(feet, f, p);
            lowest = height < lowest ? height : lowest;
            if (f + 1 == feet->frames || !feet->toes[p] || !(height < feet->near_floor) ||
                !(height_at(feet, f + 1, p) < feet->near_floor))
                continue;
            const double speed = speed_of(feet, f, p);
            near++, sum += speed, fast += speed > feet->skates;
        }
        under += -lowest > feet->under;
        deepest = -lowest > deepest ? -lowest : deepest;
    }
    figures->skate_mean = near > 0 ? sum / (double)near : 0.0, figures->skate_ratio = share_of(fast, near);
    figures->penetration_share = share_of(under, feet->frames - feet->first), figures->penetration_max = deepest;
}

static void measure_plants(const FootTracks *feet, FootFigures *figures)
{
    int64_t steps = 0, slides = 0;
    const int64_t *at = feet->at;
    figures->drift_max = figures->floating_max = 0.0;
    for (int64_t k = 0; k < feet->plants; at += feet->counts[k++]) {
        const int64_t count = feet->counts[k], point = feet->point[k];
        /* From where the plant begins: what stands still is not off by the rounding of its place. */
        double start[3], mean[3] = {0.0}, place[3], height = 0.0;
        place_of(feet, at[0], point, start);
        for (int64_t i = 0; i < count; i++) {
            place_of(feet, at[i], point, place);
            height += height_of(feet, place);
            for (int a = 0; a < 3; a++)
                mean[a] += place[a] - start[a];
            if (feet->toes[point] && i + 1 < count && at[i] + 1 < feet->frames)
                steps++, slides += speed_of(feet, at[i], point) > feet->slides;
        }
        for (int a = 0; a < 3; a++)
            mean[a] /= (double)count;
        for (int64_t i = 0; i < count; i++) {
            place_of(feet, at[i], point, place);
            for (int a = 0; a < 3; a++)
                place[a] = place[a] - start[a] - mean[a];
            const double square = place[0] * place[0] + place[1] * place[1] + place[2] * place[2];
            figures->drift_max = fmax(figures->drift_max, sqrt(square));
        }
        if (feet->toes[point])
            figures->floating_max = fmax(figures->floating_max, height / (double)count);
    }
    figures->sliding_share = share_of(slides, steps);
}

void measure_feet(const FootTracks *feet, FootFigures *figures)
{
    measure_frames(feet, figures);
    measure_plants(feet, figures);
}
