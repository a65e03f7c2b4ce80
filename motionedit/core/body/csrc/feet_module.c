/* Buffers from Python for what is about feet: sizes are checked here, so that a slip there is an error and not a crash. */

#include "../../csrc/module.h"

#include "../../feet/csrc/stance.h"
#include "body.h"
#include "../../csrc/held.h"

#include <stdlib.h>

/* [(point, first frame, last frame, height), ...] */
static PyObject *list_of(const Stand *stands, int64_t count)
{
    PyObject *list = PyList_New((Py_ssize_t)count);
    for (int64_t i = 0; list != NULL && i < count; i++) {
        PyObject *item = Py_BuildValue("LLLd", (long long)stands[i].point, (long long)stands[i].start,
            (long long)stands[i].stop, stands[i].height);
        if (item == NULL || PyList_SetItem(list, (Py_ssize_t)i, item) < 0)
            Py_CLEAR(list);
    }
    return list;
}

static PyObject *stands(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    StandRules rules;
    PyObject *given[3], *list = NULL;
    long long frames, points, half, low_while, longest_gap, shortest, top_while;
    double metre;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOLLd(LLLLLddddddd)", given, given + 1, given + 2, &frames, &points, &metre,
            &half, &low_while, &longest_gap, &shortest, &top_while, &rules.frame_time, &rules.enters, &rules.leaves,
            &rules.low, &rules.same_place, &rules.top, &rules.held))
        return NULL;
    rules.half = half, rules.low_while = low_while, rules.longest_gap = longest_gap;
    rules.shortest = shortest, rules.top_while = top_while;
    if (frames < 2 || points < 0 || half < 1 || low_while < 0 || top_while < 0) {
        PyErr_SetString(PyExc_ValueError, "too few frames, or none around one");
        return NULL;
    }
    const double *tracks = items_of(&held, given[0], 3 * frames * points, sizeof *tracks, 0, "tracks");
    const int64_t *feet = tracks == NULL ? NULL : items_of(&held, given[1], points, sizeof *feet, 0, "feet");
    const double *up = feet == NULL ? NULL : items_of(&held, given[2], 3, sizeof *up, 0, "up");
    if (up != NULL) {
        Stand *found = NULL;
        int64_t count;
        Py_BEGIN_ALLOW_THREADS count = find_stands(tracks, frames, points, feet, up, metre, &rules, &found);
        Py_END_ALLOW_THREADS if (count < 0) PyErr_NoMemory();
        else list = list_of(found, count);
        free(found);
    }
    let_go(&held);
    return list;
}

/* Take tracks, up, which may be None, and plants that a call is given; whether these are at frames, and of points, that
   there are. */
static int take_feet(
    Held *held, PyObject **given, long long frames, long long points, long long plants, FootTracks *feet)
{
    *feet = (FootTracks){.frames = frames, .points = points, .plants = plants};
    if (frames < 0 || points < 0) {
        PyErr_SetString(PyExc_ValueError, "no such frames or points");
        return 0;
    }
    if ((feet->tracks = items_of(held, given[0], 3 * frames * points, sizeof(double), 0, "tracks")) == NULL ||
        (given[1] != Py_None && (feet->up = items_of(held, given[1], 3, sizeof(double), 0, "up")) == NULL) ||
        (feet->stands = items_of(held, given[2], plants, sizeof(PlantFrames), 0, "plants")) == NULL)
        return 0;
    for (int64_t k = 0; k < plants; k++) {
        const PlantFrames *plant = feet->stands + k;
        if (plant->point < 0 || plant->point >= points || plant->start < 0 || plant->start > plant->stop ||
            plant->stop >= frames) {
            PyErr_Format(PyExc_ValueError, "plant %lld is at no frames, or of no point", (long long)k);
            return 0;
        }
    }
    return 1;
}

static int has_up(const FootTracks *feet)
{
    if (feet->up == NULL)
        PyErr_SetString(PyExc_ValueError, "no up");
    return feet->up != NULL;
}

static PyObject *foot_figures(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[4], *found = NULL;
    FootTracks feet;
    FootRules rules;
    FootFigures figures;
    long long frames, points, plants, first;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOLLLOL(dddddd)", given, given + 1, given + 2, &frames, &points, &plants,
            given + 3, &first, &rules.scale, &rules.frame_time, &rules.near_floor, &rules.skates, &rules.slides,
            &rules.under))
        return NULL;
    rules.first = first;
    if (first < 0)
        return PyErr_Format(PyExc_ValueError, "no such frames");
    if (take_feet(&held, given, frames, points, plants, &feet) &&
        (rules.toes = items_of(&held, given[3], points, 1, 0, "toes")) != NULL && has_up(&feet)) {
        measure_feet(&feet, &rules, &figures);
        found = Py_BuildValue("ddddddd", figures.skate_mean, figures.skate_ratio, figures.sliding_share,
            figures.penetration_share, figures.penetration_max, figures.drift_max, figures.floating_max);
    }
    let_go(&held);
    return found;
}

static PyObject *foot_slide(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[3], *found = NULL;
    FootTracks feet;
    long long frames, points, plants;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOLLL", given, given + 1, given + 2, &frames, &points, &plants))
        return NULL;
    if (take_feet(&held, given, frames, points, plants, &feet) && has_up(&feet))
        found = PyFloat_FromDouble(farthest_slide(&feet));
    let_go(&held);
    return found;
}

static PyObject *foot_drift(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[4], *found = NULL;
    FootTracks feet;
    long long frames, points, plants;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOLLLO", given, given + 1, given + 2, &frames, &points, &plants, given + 3))
        return NULL;
    if (take_feet(&held, given, frames, points, plants, &feet)) {
        const double *other = items_of(&held, given[3], 3 * frames * points, sizeof *other, 0, "other tracks");
        if (other != NULL)
            found = PyFloat_FromDouble(farthest_drift(&feet, other));
    }
    let_go(&held);
    return found;
}

/* An array of a foot's frames, or of its plants. */
typedef struct {
    const char *name;
    size_t bytes;
    int64_t width;
} Item;

/* Where the arrays of a foot are, the plants at `plants_at` and what is written from `written` on; 0, and an error,
   where one does not fit. */
static int take_foot(Held *held, PyObject **given, const Item *items, int count, int plants_at, int written,
    int64_t frames, int64_t plants, void **at)
{
    for (int i = 0; i < count; i++) {
        const int64_t many = items[i].width * (i == plants_at ? plants : frames);
        at[i] = items_of(held, given[i], many, items[i].bytes, i >= written, items[i].name);
        if (at[i] == NULL)
            return 0;
    }
    for (int64_t k = 0; k < plants; k++) {
        const PlantSpan *plant = (const PlantSpan *)at[plants_at] + k;
        if (plant->start < 0 || plant->start > plant->stop || plant->stop >= frames) {
            PyErr_Format(PyExc_ValueError, "plant %lld is at no frames", (long long)k);
            return 0;
        }
    }
    return 1;
}

static PyObject *stance(PyObject *self, PyObject *arguments)
{
    enum { ANKLE, TOE_PLACE, TURN, TOE, PLANTS, HEEL_DOWN, TOE_DOWN, HEEL_OUT, TOE_OUT, TURN_OUT, WHOLE, COUNT };
    static const Item items[COUNT] = {{"ankle", 8, 3}, {"toe place", 8, 3}, {"turn", 8, 4}, {"toe", 8, 3},
        {"plants", 8, 3}, {"heel down", 1, 1}, {"toe down", 1, 1}, {"heel places", 8, 3}, {"toe places", 8, 3},
        {"turns", 8, 4}, {"stands", 8, 1}};
    Held held = {.count = 0};
    PyObject *given[COUNT];
    void *at[COUNT];
    long long frames, plants;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOOOOOOOOLL", given, given + 1, given + 2, given + 3, given + 4, given + 5,
            given + 6, given + 7, given + 8, given + 9, given + 10, &frames, &plants))
        return NULL;
    if (take_foot(&held, given, items, COUNT, PLANTS, HEEL_DOWN, frames, plants, at)) {
        const FootTrack track = {frames, at[ANKLE], at[TOE_PLACE], at[TURN], at[TOE]};
        const StanceFound found = {at[HEEL_DOWN], at[TOE_DOWN], at[HEEL_OUT], at[TOE_OUT], at[TURN_OUT], at[WHOLE]};
        status = find_stance(&track, at[PLANTS], plants, &found);
        if (status < 0)
            PyErr_NoMemory();
    }
    return let_go_none_if(status >= 0, &held);
}

PyMethodDef feet_methods[] = {
    {"stands", stands, METH_VARARGS, "Return the stretches in which points of feet stand."},
    {"foot_figures", foot_figures, METH_VARARGS, "Return how well feet stand, in seven figures."},
    {"foot_slide", foot_slide, METH_VARARGS, "Return how far a planted point slides from a frame to the next at most."},
    {"foot_drift", foot_drift, METH_VARARGS, "Return how far a planted point is from other tracks at most."},
    {"stance", stance, METH_VARARGS, "Write where a foot stands, from the plants of its heel and its toe."},
    {NULL, NULL, 0, NULL},
};
