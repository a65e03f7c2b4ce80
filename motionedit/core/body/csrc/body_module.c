/* Buffers from Python for what is in this folder: sizes are checked here, so that a slip there is an error and not a
   crash. */

#include "module.h"

#include "../../feet/csrc/stance.h"
#include "body.h"

#include <stdlib.h>

/* The buffers of a call, held as long as it runs. */
enum { MOST_HELD = 16 };
typedef struct {
    Py_buffer held[MOST_HELD];
    int count;
} Held;

/* Where `count` items of so many bytes are, one after the other; NULL, and an error, where they are not. */
static void *items_of(Held *held, PyObject *given, int64_t count, size_t bytes, int writable, const char *name)
{
    Py_buffer *buffer = held->held + held->count;
    if (PyObject_GetBuffer(given, buffer, writable ? PyBUF_WRITABLE : PyBUF_SIMPLE) < 0)
        return NULL;
    held->count++;
    if (count >= 0 && buffer->len / (Py_ssize_t)bytes == count && buffer->len % (Py_ssize_t)bytes == 0)
        return buffer->buf;
    PyErr_Format(PyExc_ValueError, "%s: %zd bytes do not fit", name, buffer->len);
    return NULL;
}

static void let_go(Held *held)
{
    for (int i = 0; i < held->count; i++)
        PyBuffer_Release(held->held + i);
}

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

/* Whether plants are at frames, and of points, that there are. */
static int are_plants(const FootTracks *feet)
{
    int64_t sum = 0;
    for (int64_t k = 0; k < feet->plants && sum >= 0; k++)
        sum = feet->counts[k] < 1 || feet->counts[k] > feet->stood - sum || feet->point[k] < 0 ||
                      feet->point[k] >= feet->points
                  ? -1
                  : sum + feet->counts[k];
    for (int64_t i = 0; i < feet->stood && sum >= 0; i++)
        if (feet->at[i] < 0 || feet->at[i] >= feet->frames)
            sum = -1;
    if (sum != feet->stood)
        PyErr_SetString(PyExc_ValueError, "plants are at no frames, or of no points");
    return sum == feet->stood;
}

static PyObject *foot_figures(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[6], *found = NULL;
    FootTracks feet = {0};
    FootFigures figures;
    long long frames, points, first, plants, stood;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOOOLLLLL(dddddd)", given, given + 1, given + 2, given + 3, given + 4,
            given + 5, &frames, &points, &first, &plants, &stood, &feet.scale, &feet.frame_time, &feet.near_floor,
            &feet.skates, &feet.slides, &feet.under))
        return NULL;
    feet.frames = frames, feet.points = points, feet.first = first, feet.plants = plants, feet.stood = stood;
    if (frames < 0 || points < 0 || first < 0) {
        PyErr_SetString(PyExc_ValueError, "no such frames or points");
        return NULL;
    }
    if ((feet.tracks = items_of(&held, given[0], 3 * frames * points, sizeof(double), 0, "tracks")) != NULL &&
        (feet.up = items_of(&held, given[1], 3, sizeof(double), 0, "up")) != NULL &&
        (feet.toes = items_of(&held, given[2], points, 1, 0, "toes")) != NULL &&
        (feet.at = items_of(&held, given[3], stood, sizeof(int64_t), 0, "frames")) != NULL &&
        (feet.point = items_of(&held, given[4], plants, sizeof(int64_t), 0, "points")) != NULL &&
        (feet.counts = items_of(&held, given[5], plants, sizeof(int64_t), 0, "counts")) != NULL && are_plants(&feet)) {
        measure_feet(&feet, &figures);
        found = Py_BuildValue("ddddddd", figures.skate_mean, figures.skate_ratio, figures.sliding_share,
            figures.penetration_share, figures.penetration_max, figures.drift_max, figures.floating_max);
    }
    let_go(&held);
    return found;
}

static PyObject *settled(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *given[4];
    long long frames, plants, half;
    double frame_time, faster, above;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOLLLddd", given, given + 1, given + 2, given + 3, &frames, &plants, &half,
            &frame_time, &faster, &above))
        return NULL;
    const double *places = items_of(&held, given[0], 3 * frames, sizeof *places, 0, "places");
    const double *up = places == NULL ? NULL : items_of(&held, given[1], 3, sizeof *up, 0, "up");
    const int64_t *counts = up == NULL ? NULL : items_of(&held, given[2], plants, sizeof *counts, 0, "counts");
    int64_t *spans = counts == NULL ? NULL : items_of(&held, given[3], 2 * plants, sizeof *spans, 1, "spans");
    if (spans != NULL) {
        int64_t sum = 0;
        for (long long k = 0; k < plants && sum >= 0; k++)
            sum = counts[k] < 1 || counts[k] > frames - sum ? -1 : sum + counts[k];
        if (sum != frames || half < 1)
            PyErr_SetString(PyExc_ValueError, "counts are not those of the places");
        else {
            status = find_settled(places, up, counts, plants, half, frame_time, faster, above, spans);
            if (status < 0)
                PyErr_NoMemory();
        }
    }
    let_go(&held);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *stance(PyObject *self, PyObject *arguments)
{
    enum { ANKLE, TOE_PLACE, TURN, TOE, PLANTS, HEEL_DOWN, TOE_DOWN, HEEL_OUT, TOE_OUT, TURN_OUT, WHOLE, COUNT };
    static const struct {
        const char *name;
        size_t bytes;
        int64_t width;
    } items[COUNT] = {{"ankle", 8, 3}, {"toe place", 8, 3}, {"turn", 8, 4}, {"toe", 8, 3}, {"plants", 8, 3},
        {"heel down", 1, 1}, {"toe down", 1, 1}, {"heel places", 8, 3}, {"toe places", 8, 3}, {"turns", 8, 4},
        {"stands", 8, 1}};
    Held held = {.count = 0};
    PyObject *given[COUNT];
    void *at[COUNT];
    long long frames, plants;
    int status = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOOOOOOOOLL", given, given + 1, given + 2, given + 3, given + 4, given + 5,
            given + 6, given + 7, given + 8, given + 9, given + 10, &frames, &plants))
        return NULL;
    int fits = 1;
    for (int i = 0; fits && i < COUNT; i++) {
        const int64_t count = items[i].width * (i == PLANTS ? plants : frames);
        at[i] = items_of(&held, given[i], count, items[i].bytes, i > PLANTS, items[i].name);
        fits = at[i] != NULL;
    }
    for (long long k = 0; fits && k < plants; k++) {
        const PlantSpan *plant = (const PlantSpan *)at[PLANTS] + k;
        fits = 0 <= plant->start && plant->start <= plant->stop && plant->stop < frames;
        if (!fits)
            PyErr_Format(PyExc_ValueError, "plant %lld is at no frames", k);
    }
    if (fits) {
        const FootTrack track = {frames, at[ANKLE], at[TOE_PLACE], at[TURN], at[TOE]};
        const StanceFound found = {at[HEEL_DOWN], at[TOE_DOWN], at[HEEL_OUT], at[TOE_OUT], at[TURN_OUT], at[WHOLE]};
        status = find_stance(&track, at[PLANTS], plants, &found);
        if (status < 0)
            PyErr_NoMemory();
    }
    let_go(&held);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

/* World transforms, of `frames` frames from the place where the arrays begin; either may be None. */
static int poses_of(
    Held *held, PyObject *positions, PyObject *rotations, long long frames, long long joints, Poses *poses)
{
    if (frames < 0 || joints < 0) {
        PyErr_SetString(PyExc_ValueError, "no such frames or joints");
        return 0;
    }
    *poses = (Poses){.frames = frames, .joints = joints};
    if (positions != Py_None) {
        poses->positions = items_of(held, positions, 3 * frames * joints, sizeof(double), 0, "positions");
        if (poses->positions == NULL)
            return 0;
    }
    if (rotations != Py_None) {
        poses->rotations = items_of(held, rotations, 4 * frames * joints, sizeof(double), 0, "rotations");
        if (poses->rotations == NULL)
            return 0;
    }
    return 1;
}

/* Where `count` joints of so many are; NULL, and an error, where one is none. */
static const int64_t *joints_of(Held *held, PyObject *given, int64_t count, const Poses *poses)
{
    const int64_t *joints = items_of(held, given, count, sizeof *joints, 0, "joints");
    for (int64_t i = 0; joints != NULL && i < count; i++)
        if (joints[i] < 0 || joints[i] >= poses->joints) {
            PyErr_Format(PyExc_ValueError, "no joint %lld", (long long)joints[i]);
            return NULL;
        }
    return joints;
}

/* What is done with joints of a motion: with so many indices of each item, numbers of its arrays, and of its results;
   these are of every item, or of every item at every frame. */
typedef struct {
    void (*work)(const Poses *, int64_t, const int64_t *, const double **, int64_t, double *);
    int64_t indices, numbers[3], results;
    int by_frame, needs_positions, needs_rotations;
} OnJoints;

/* Take the poses, first frame, joints, up to three arrays and the results that a call is given; whether all fit. */
static int take_joints(const OnJoints *of, PyObject *arguments, Held *held, Poses *poses, int64_t *first,
    int64_t *count, const int64_t **joints, const double **arrays, double **out)
{
    PyObject *positions, *rotations, *indices, *given, *results;
    long long frames, joint_count, begin, items;
    if (!PyArg_ParseTuple(arguments, "OOLLLOLO!O", &positions, &rotations, &frames, &joint_count, &begin, &indices,
            &items, &PyTuple_Type, &given, &results) ||
        !poses_of(held, positions, rotations, frames, joint_count, poses))
        return 0;
    *first = begin, *count = items;
    if (begin < 0 || items < 0 || (of->needs_positions && poses->positions == NULL) ||
        (of->needs_rotations && poses->rotations == NULL)) {
        PyErr_SetString(PyExc_ValueError, "no such frames, or no positions or rotations");
        return 0;
    }
    *joints = joints_of(held, indices, of->indices * items, poses);
    if (*joints == NULL)
        return 0;
    for (int i = 0; i < 3 && of->numbers[i] > 0; i++) {
        PyObject *array = PyTuple_GetItem(given, i);
        arrays[i] = array == NULL ? NULL : items_of(held, array, of->numbers[i] * items, sizeof(double), 0, "numbers");
        if (arrays[i] == NULL)
            return 0;
    }
    *out = items_of(held, results, of->results * items * (of->by_frame ? frames : 1), sizeof(double), 1, "results");
    return *out != NULL;
}

static PyObject *on_joints(const OnJoints *of, PyObject *arguments)
{
    Held held = {.count = 0};
    Poses poses;
    int64_t first, count;
    const int64_t *joints;
    const double *arrays[3] = {NULL, NULL, NULL};
    double *out;
    const int fits = take_joints(of, arguments, &held, &poses, &first, &count, &joints, arrays, &out);
    if (fits)
        of->work(&poses, first, joints, arrays, count, out);
    let_go(&held);
    if (!fits)
        return NULL;
    Py_RETURN_NONE;
}

static void ways_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)arrays;
    sum_ways(poses, first, joints, count, out);
}

static void products_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)arrays;
    sum_products(poses, first, joints, count, out);
}

static void widest_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    widest_turns(poses, first, joints, arrays[0], arrays[1], count, out);
}

static void carry_work(
    const Poses *poses, int64_t first, const int64_t *joints, const double **arrays, int64_t count, double *out)
{
    (void)first;
    carry(poses, joints, arrays[0], count, out);
}

static PyObject *ways(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){ways_work, 3, {0}, 3, 0, 1, 1}, arguments);
}

static PyObject *products(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){products_work, 1, {0}, 16, 0, 0, 1}, arguments);
}

static PyObject *widest(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){widest_work, 1, {4, 3}, 2, 0, 0, 1}, arguments);
}

static PyObject *carried(PyObject *self, PyObject *arguments)
{
    (void)self;
    return on_joints(&(const OnJoints){carry_work, 1, {3}, 3, 1, 1, 1}, arguments);
}

static PyObject *jerks(PyObject *self, PyObject *arguments)
{
    Held held = {.count = 0};
    PyObject *positions, *results, *found = NULL;
    long long frames, joints;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLLO", &positions, &frames, &joints, &results))
        return NULL;
    if (frames < 3 || joints < 0)
        return PyErr_Format(PyExc_ValueError, "no such frames or joints");
    const double *places = items_of(&held, positions, 3 * frames * joints, sizeof *places, 0, "positions");
    double *out = places == NULL ? NULL : items_of(&held, results, frames - 3, sizeof *out, 1, "results");
    if (out != NULL) {
        int64_t frame, joint;
        const double largest = squared_jerks(places, frames, joints, out, &frame, &joint);
        found = Py_BuildValue("dLL", largest, (long long)frame, (long long)joint);
    }
    let_go(&held);
    return found;
}

PyMethodDef body_methods[] = {
    {"ways", ways, METH_VARARGS, "Write sums of ways between joints, seen from others."},
    {"products", products, METH_VARARGS, "Write sums of products of joints' rotations."},
    {"widest", widest, METH_VARARGS, "Write how far joints swing and twist about their centers."},
    {"carried", carried, METH_VARARGS, "Write where points in joints' frames are at each frame."},
    {"jerks", jerks, METH_VARARGS, "Write squared third differences; return the largest, its frame and joint."},
    {"stands", stands, METH_VARARGS, "Return the stretches in which points of feet stand."},
    {"foot_figures", foot_figures, METH_VARARGS, "Return how well feet stand, in seven figures."},
    {"settled", settled, METH_VARARGS, "Write which frames of plants are the first and the last that have settled."},
    {"stance", stance, METH_VARARGS, "Write where a foot stands, from the plants of its heel and its toe."},
    {NULL, NULL, 0, NULL},
};
