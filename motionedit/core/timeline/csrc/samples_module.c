/* Buffers from Python for motions sampled at parts of frames: sizes are checked here. */

#include "../../csrc/module.h"

#include "../../csrc/held.h"
#include "samples.h"

/* Refuse what does not fit; 0, for a check to return. */
static int refused(const char *message)
{
    PyErr_SetString(PyExc_ValueError, message);
    return 0;
}

/* Whether `count` numbers are from `least` up to, but not, `end`. */
static int are_within(const int64_t *numbers, int64_t count, int64_t least, int64_t end, const char *message)
{
    for (int64_t i = 0; i < count; i++)
        if (numbers[i] < least || numbers[i] >= end)
            return refused(message);
    return 1;
}

/* The frames and fractions of samples, of a motion of which a frame takes `bytes` in a buffer. */
static int take_samples(Held *held, PyObject *at, PyObject *t, const Py_buffer *motion, int64_t bytes, Samples *samples)
{
    if (bytes < 1)
        return refused("a motion has joints");
    *samples = (Samples){.frames = motion->len / bytes};
    samples->t = some_of(held, t, &samples->count, "fractions");
    if (samples->t == NULL || !has_size(motion, samples->frames * bytes, 1, "the motion"))
        return 0;
    samples->at = items_of(held, at, samples->count, sizeof(int64_t), 0, "frames");
    return samples->at != NULL && are_within(samples->at, samples->count, 0, samples->frames, "no such frames");
}

/* The rotations of so many joints and the samples of them; where `parts` are given, the weights among these. */
static int take_ways(Held *held, PyObject *rotations, long long joints, PyObject *at, PyObject *t, PyObject *parts,
    Samples *samples, Ways *ways)
{
    int64_t numbers;
    *ways = (Ways){.rotations = some_of(held, rotations, &numbers, "rotations"), .joints = joints};
    if (ways->rotations == NULL || !take_samples(held, at, t, held->held, 4 * joints * 8, samples))
        return 0;
    if (parts == NULL)
        return 1;
    const int64_t all = samples->count * joints;
    const double *const whole = items_of(held, parts, 3 * all, sizeof(double), 0, "parts of arcs");
    if (whole == NULL)
        return 0;
    ways->first = whole + all, ways->second = whole + 2 * all;
    return 1;
}

static PyObject *cosines_of_arcs(PyObject *self, PyObject *arguments)
{
    PyObject *rotations, *at, *t, *cosines, *sizes;
    Held held = {.count = 0};
    long long joints;
    Samples samples;
    Ways ways;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLOOOO", &rotations, &joints, &at, &t, &cosines, &sizes))
        return NULL;
    int fits = take_ways(&held, rotations, joints, at, t, NULL, &samples, &ways);
    double *const one = fits ? items_of(&held, cosines, samples.count * joints, 8, 1, "cosines") : NULL;
    double *const other = one == NULL ? NULL : items_of(&held, sizes, samples.count * joints, 8, 1, "sizes");
    fits = other != NULL;
    if (fits) {
        Py_BEGIN_ALLOW_THREADS arc_cosines(&samples, &ways, one, other);
        Py_END_ALLOW_THREADS
    }
    return let_go_none_if(fits, &held);
}

static PyObject *parts_of_arcs(PyObject *self, PyObject *arguments)
{
    PyObject *t, *parts;
    Held held = {.count = 0};
    Samples samples = {0};
    long long joints;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLO", &t, &joints, &parts))
        return NULL;
    samples.t = some_of(&held, t, &samples.count, "fractions");
    double *const whole =
        samples.t == NULL ? NULL : items_of(&held, parts, 3 * samples.count * joints, 8, 1, "parts of arcs");
    if (whole != NULL)
        arc_parts(&samples, joints, whole);
    return let_go_none_if(whole != NULL, &held);
}

static PyObject *weights_of_arcs(PyObject *self, PyObject *arguments)
{
    PyObject *t, *cosines, *parts;
    Held held = {.count = 0};
    Samples samples = {0};
    long long joints;
    double straight;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLOdO", &t, &joints, &cosines, &straight, &parts))
        return NULL;
    samples.t = some_of(&held, t, &samples.count, "fractions");
    const int64_t all = samples.count * joints;
    const double *const given = samples.t == NULL ? NULL : items_of(&held, cosines, all, 8, 0, "cosines");
    double *const whole = given == NULL ? NULL : items_of(&held, parts, 3 * all, 8, 1, "parts of arcs");
    if (whole != NULL)
        arc_weights(&samples, joints, given, straight, whole);
    return let_go_none_if(whole != NULL, &held);
}

static PyObject *turns_of_samples(PyObject *self, PyObject *arguments)
{
    PyObject *rotations, *at, *t, *parts, *turns;
    Held held = {.count = 0};
    long long joints;
    Samples samples;
    Ways ways;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLOOOO", &rotations, &joints, &at, &t, &parts, &turns))
        return NULL;
    const int fits = take_ways(&held, rotations, joints, at, t, parts, &samples, &ways);
    double *const out = fits ? items_of(&held, turns, 4 * samples.count * joints, 8, 1, "turns") : NULL;
    if (out != NULL) {
        Py_BEGIN_ALLOW_THREADS sampled_turns(&samples, &ways, out);
        Py_END_ALLOW_THREADS
    }
    return let_go_none_if(out != NULL, &held);
}

static PyObject *sums_of_samples(PyObject *self, PyObject *arguments)
{
    PyObject *rotations, *at, *t, *parts, *rotation, *chosen, *sums;
    Held held = {.count = 0};
    Placing placing = {0};
    long long joints;
    Samples samples;
    int axes[3];
    Ways ways;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLOOOOOiiiO", &rotations, &joints, &at, &t, &parts, &rotation, &chosen, axes,
            axes + 1, axes + 2, &sums))
        return NULL;
    int fits = take_ways(&held, rotations, joints, at, t, parts, &samples, &ways);
    placing.rotation = fits ? items_of(&held, rotation, 4, sizeof(double), 0, "rotation") : NULL;
    int64_t many = 0;
    const void *const places = placing.rotation == NULL ? NULL : some_of(&held, chosen, &many, "joints");
    fits = places != NULL && are_within(places, many, 0, joints, "no such joints") && are_three_axes(axes);
    double *const out = fits ? items_of(&held, sums, 6 * many * samples.count, 8, 1, "sums") : NULL;
    if (out != NULL) {
        Py_BEGIN_ALLOW_THREADS sampled_sums(&samples, &ways, &placing, places, many, axes, out);
        Py_END_ALLOW_THREADS
    }
    return let_go_none_if(out != NULL, &held);
}

/* Rows of so many numbers, and the columns of joints in them. */
static int take_columns(
    Held *held, PyObject *columns, PyObject *rows, int64_t frames, long long width, int64_t least, Columns *taken)
{
    int64_t count = 0;
    taken->columns = (const void *)some_of(held, columns, &count, "columns");
    taken->count = count / 3, taken->width = width;
    if (taken->columns == NULL || !are_within(taken->columns, count, least, width, "no such columns"))
        return 0;
    if (count % 3 != 0)
        return refused("three columns a joint");
    taken->rows = items_of(held, rows, frames * width, sizeof(double), 1, "rows");
    return taken->rows != NULL;
}

static PyObject *columns_of_angles(PyObject *self, PyObject *arguments)
{
    PyObject *sums, *seeds, *columns, *rows;
    Held held = {.count = 0};
    Columns taken = {0};
    Solving solving;
    long long frames, width;
    int status = -1;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLiiiddOOLO", &sums, &frames, solving.axes, solving.axes + 1, solving.axes + 2,
            &solving.locked, &solving.factor, &seeds, &columns, &width, &rows))
        return NULL;
    if (are_three_axes(solving.axes) && take_columns(&held, columns, rows, frames, width, 0, &taken)) {
        double *const given = items_of(&held, sums, 6 * taken.count * frames, sizeof(double), 1, "sums");
        const double *const first =
            given == NULL ? NULL : items_of(&held, seeds, 3 * taken.count, sizeof(double), 0, "seeds");
        if (first != NULL) {
            Py_BEGIN_ALLOW_THREADS status = angle_columns(given, frames, &solving, first, &taken);
            Py_END_ALLOW_THREADS
        }
    }
    let_go(&held);
    return status < 0 ? NULL : PyBool_FromLong(status);
}

static PyObject *columns_of_places(PyObject *self, PyObject *arguments)
{
    PyObject *translations, *at, *t, *rotation, *origin, *columns, *rows;
    Held held = {.count = 0};
    Columns taken = {0};
    Placing placing = {0};
    long long joints, placed, width;
    int64_t numbers;
    Samples samples;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OLOOLOOOLO", &translations, &joints, &at, &t, &placed, &rotation, &origin,
            &columns, &width, &rows))
        return NULL;
    const double *const given = some_of(&held, translations, &numbers, "translations");
    int fits = given != NULL && take_samples(&held, at, t, held.held, 3 * joints * 8, &samples);
    fits = fits && (placing.rotation = items_of(&held, rotation, 4, sizeof(double), 0, "rotation")) != NULL;
    fits = fits && (placing.origin = items_of(&held, origin, 3, sizeof(double), 0, "origin")) != NULL;
    fits = fits && take_columns(&held, columns, rows, samples.count, width, -1, &taken);
    fits = fits && (taken.count == joints || refused("columns of other joints"));
    if (fits)
        place_columns(&samples, given, placed, &placing, &taken);
    return let_go_none_if(fits, &held);
}

PyMethodDef sample_methods[] = {
    {"arc_cosines", cosines_of_arcs, METH_VARARGS, "Write the cosines of arcs between frames, and their sizes."},
    {"arc_parts", parts_of_arcs, METH_VARARGS, "Write half of arcs, of what is left of them, and of their ways."},
    {"arc_weights", weights_of_arcs, METH_VARARGS, "Write the weights of both ends of arcs, from tangents of parts."},
    {"sampled_turns", turns_of_samples, METH_VARARGS, "Write rotations at fractions of the ways between frames."},
    {"sampled_sums", sums_of_samples, METH_VARARGS, "Write `euler_sums` of rotations on the ways between frames."},
    {"angle_columns", columns_of_angles, METH_VARARGS,
        "Write continuous Euler angles as columns of rows; False where one is locked."},
    {"place_columns", columns_of_places, METH_VARARGS, "Write translations between frames as columns of rows."},
    {NULL, NULL, 0, NULL},
};
