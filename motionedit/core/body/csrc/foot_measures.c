/* How well feet stand: feet/measures.py in one pass over the frames, and one over the plants. */

#include "body.h"

#include <math.h>

/* Feet with the rules by which they are measured. */
typedef struct {
    const FootTracks *feet;
    const FootRules *rules;
} Measured;

static const double *point_at(const FootTracks *feet, int64_t frame, int64_t point)
{
    return feet->tracks + 3 * (frame * feet->points + point);
}

static double along_up(const FootTracks *feet, const double *way)
{
    return way[0] * feet->up[0] + way[1] * feet->up[1] + way[2] * feet->up[2];
}

static double length_of(const double *way)
{
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
}

static void metres_at(const Measured *of, int64_t frame, int64_t point, double *place)
{
    for (int a = 0; a < 3; a++)
        place[a] = point_at(of->feet, frame, point)[a] * of->rules->scale;
}

/* How fast a point goes on the level from a frame to the next, m/s. */
static double speed_of(const Measured *of, int64_t frame, int64_t point)
{
    double here[3], there[3], step[3];
    metres_at(of, frame, point, here), metres_at(of, frame + 1, point, there);
    const double low = along_up(of->feet, here), high = along_up(of->feet, there);
    for (int a = 0; a < 3; a++)
        step[a] = (there[a] - high * of->feet->up[a]) - (here[a] - low * of->feet->up[a]);
    return length_of(step) / of->rules->frame_time;
}

static double height_at(const Measured *of, int64_t frame, int64_t point)
{
    double place[3];
    metres_at(of, frame, point, place);
    return along_up(of->feet, place);
}

static double share_of(int64_t some, int64_t all)
{
    return all > 0 ? (double)some / (double)all : 0.0;
}

static void measure_frames(const Measured *of, FootFigures *figures)
{
    const FootTracks *feet = of->feet;
    const FootRules *rules = of->rules;
    int64_t near = 0, fast = 0, under = 0;
    double sum = 0.0, deepest = 0.0;
    for (int64_t f = rules->first; f < feet->frames; f++) {
        double lowest = INFINITY;
        for (int64_t p = 0; p < feet->points; p++) {
            const double height = height_at(of, f, p);
            lowest = height < lowest ? height : lowest;
            if (f + 1 == feet->frames || !rules->toes[p] || !(height < rules->near_floor) ||
                !(height_at(of, f + 1, p) < rules->near_floor))
                continue;
            const double speed = speed_of(of, f, p);
            near++, sum += speed, fast += speed > rules->skates;
        }
        under += -lowest > rules->under;
        deepest = -lowest > deepest ? -lowest : deepest;
    }
    figures->skate_mean = near > 0 ? sum / (double)near : 0.0, figures->skate_ratio = share_of(fast, near);
    figures->penetration_share = share_of(under, feet->frames - rules->first), figures->penetration_max = deepest;
}

static void measure_plants(const Measured *of, FootFigures *figures)
{
    int64_t steps = 0, slides = 0;
    figures->drift_max = figures->floating_max = 0.0;
    for (int64_t k = 0; k < of->feet->plants; k++) {
        const PlantFrames *plant = of->feet->stands + k;
        const int is_toe = of->rules->toes[plant->point] != 0;
        const double count = (double)(plant->stop - plant->start + 1);
        /* From where the plant begins: what stands still is not off by the rounding of its place. */
        double start[3], mean[3] = {0.0}, place[3], height = 0.0;
        metres_at(of, plant->start, plant->point, start);
        for (int64_t f = plant->start; f <= plant->stop; f++) {
            metres_at(of, f, plant->point, place);
            height += along_up(of->feet, place);
            for (int a = 0; a < 3; a++)
                mean[a] += place[a] - start[a];
            if (is_toe && f < plant->stop)
                steps++, slides += speed_of(of, f, plant->point) > of->rules->slides;
        }
        for (int a = 0; a < 3; a++)
            mean[a] /= count;
        for (int64_t f = plant->start; f <= plant->stop; f++) {
            metres_at(of, f, plant->point, place);
            for (int a = 0; a < 3; a++)
                place[a] = place[a] - start[a] - mean[a];
            figures->drift_max = fmax(figures->drift_max, length_of(place));
        }
        if (is_toe)
            figures->floating_max = fmax(figures->floating_max, height / count);
    }
    figures->sliding_share = share_of(slides, steps);
}

void measure_feet(const FootTracks *feet, const FootRules *rules, FootFigures *figures)
{
    const Measured of = {feet, rules};
    measure_frames(&of, figures);
    measure_plants(&of, figures);
}

double farthest_slide(const FootTracks *feet)
{
    double farthest = 0.0;
    for (int64_t k = 0; k < feet->plants; k++)
        for (int64_t f = feet->stands[k].start; f < feet->stands[k].stop; f++) {
            const double *from = point_at(feet, f, feet->stands[k].point);
            const double *to = point_at(feet, f + 1, feet->stands[k].point);
            double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
            const double rise = along_up(feet, step);
            for (int a = 0; a < 3; a++)
                step[a] -= rise * feet->up[a];
            farthest = fmax(farthest, length_of(step));
        }
    return farthest;
}

double farthest_drift(const FootTracks *feet, const double *other)
{
    double farthest = 0.0;
    for (int64_t k = 0; k < feet->plants; k++)
        for (int64_t f = feet->stands[k].start; f <= feet->stands[k].stop; f++) {
            const double *own = point_at(feet, f, feet->stands[k].point), *its = other + (own - feet->tracks);
            const double way[3] = {its[0] - own[0], its[1] - own[1], its[2] - own[2]};
            farthest = fmax(farthest, length_of(way));
        }
    return farthest;
}
