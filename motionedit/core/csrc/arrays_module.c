/* Buffers from Python for whole arrays of rotations, from rotations.py and euler.py: sizes are checked here. */

#include "module.h"

#include "held.h"
#include "arrays.h"

#include <stdlib.h>
#include <string.h>

/* What is done to rows of numbers, two and two: how many numbers a row of each has, and how many axes a row of results
   adds; `planes` are of results, one after the other. */
typedef struct {
    RowWork *work;
    int64_t one, other, result, planes;
} OnRows;

enum { MOST_AXES = 8, MANY_ROWS = 1 << 12 };

/* Rows that are gone through together with others: so many numbers from row to row along each axis. */
typedef struct {
    const double *first;
    int64_t steps[MOST_AXES];
} Rows;

/* Whether the buffer is rows of `width` numbers that stand for `axes` axes of so many rows, the last axes of them or
   one row again and again; else it is to be copied, or an error is set. */
static int are_rows(const Py_buffer *buffer, int64_t width, int axes, const int64_t *counts, Rows *rows)
{
    const int own = buffer->ndim - 1, number = (int)sizeof(double);
    if (own < 0 || own > axes || buffer->shape[own] != width) {
        PyErr_Format(PyExc_ValueError, "not rows of %lld numbers", (long long)width);
        return 0;
    }
    if (buffer->format == NULL || strcmp(buffer->format, "d") != 0 || buffer->strides[own] != number)
        return 0;
    rows->first = buffer->buf;
    for (int axis = 0; axis < axes; axis++) {
        const int place = axis - (axes - own);
        rows->steps[axis] = 0;
        if (place < 0 || buffer->shape[place] == 1)
            continue;
        if (buffer->shape[place] != counts[axis]) {
            PyErr_SetString(PyExc_ValueError, "rows and results differ in number");
            return 0;
        }
        if (buffer->strides[place] % number != 0)
            return 0;
        rows->steps[axis] = buffer->strides[place] / number;
    }
    return 1;
}

/* Do it to all rows, along the last axis at once; axes that lie as one are taken as one. */
static void do_rows(const OnRows *of, Rows *one, Rows *other, int axes, int64_t *counts, double *out, int64_t apart)
{
    int64_t at[MOST_AXES] = {0};
    int last = axes - 1;
    while (last > 0 && one->steps[last - 1] == one->steps[last] * counts[last] &&
           other->steps[last - 1] == other->steps[last] * counts[last]) {
        counts[last - 1] *= counts[last];
        one->steps[last - 1] = one->steps[last], other->steps[last - 1] = other->steps[last];
        last--;
    }
    for (;;) {
        const double *a = one->first, *b = other->first;
        for (int axis = 0; axis < last; axis++)
            a += at[axis] * one->steps[axis], b += at[axis] * other->steps[axis];
        of->work(a, one->steps[last], b, other->steps[last], counts[last], out, apart);
        out += counts[last] * of->result;
        int axis = last - 1;
        while (axis >= 0 && ++at[axis] == counts[axis])
            at[axis--] = 0;
        if (axis < 0)
            return;
    }
}

/* True where it was done, False where the rows do not lie in memory as they have to. */
static PyObject *on_rows(const OnRows *of, PyObject *arguments)
{
    PyObject *given[3];
    Py_buffer b[3];
    int held = 0, done = -1;
    if (!PyArg_ParseTuple(arguments, "OOO", given, given + 1, given + 2))
        return NULL;
    while (held < 3 && PyObject_GetBuffer(given[held], b + held,
                           held == 2 ? PyBUF_WRITABLE | PyBUF_ND | PyBUF_FORMAT : PyBUF_RECORDS_RO) == 0)
        held++;
    if (held == 3) {
        /* An axis of one row stands for results that have no axes but their own. */
        int64_t counts[MOST_AXES] = {1}, rows = 1;
        const int before = of->planes > 1, axes = b[2].ndim - before - (of->result > 1);
        Rows one, other;
        int fits = axes >= 0 && axes <= MOST_AXES && (!before || b[2].shape[0] == of->planes) &&
                   (of->result == 1 || b[2].shape[b[2].ndim - 1] == of->result);
        for (int axis = 0; fits && axis < axes; axis++)
            rows *= counts[axis] = b[2].shape[axis + before];
        one.steps[0] = other.steps[0] = 0;
        if (!fits || !has_size(b + 2, rows * of->result * of->planes, sizeof(double), "results")) {
            if (!PyErr_Occurred())
                PyErr_SetString(PyExc_ValueError, "results have another shape");
        } else if (!are_rows(b, of->one, axes, counts, &one) || !are_rows(b + 1, of->other, axes, counts, &other))
            done = PyErr_Occurred() ? -1 : 0;
        else {
            PyThreadState *state = rows > MANY_ROWS ? PyEval_SaveThread() : NULL;
            if (rows > 0)
                do_rows(of, &one, &other, axes > 0 ? axes : 1, counts, b[2].buf, rows);
            if (state != NULL)
                PyEval_RestoreThread(state);
            done = 1;
        }
    }
    release(b, held);
    return done < 0 ? NULL : PyBool_FromLong(done);
}

/* A method that does some work to rows of so many numbers each: of one, of the other, of the results, and planes of
   these. */
#define ON_ROWS(method, ...)                                                                                           \
    static PyObject *method(PyObject *self, PyObject *arguments)                                                       \
    {                                                                                                                  \
        (void)self;                                                                                                    \
        return on_rows(&(const OnRows){__VA_ARGS__}, arguments);                                                       \
    }
ON_ROWS(multiply, multiply_all, 4, 4, 4, 1)
ON_ROWS(between, between_all, 4, 4, 4, 1)
ON_ROWS(rotate, rotate_all, 4, 3, 3, 1)
ON_ROWS(unrotate, unrotate_all, 4, 3, 3, 1)
ON_ROWS(cross_rows, cross_all, 3, 3, 3, 1)
ON_ROWS(dot_rows, dot_all, 3, 3, 1, 1)
ON_ROWS(length, length_all, 3, 3, 1, 1)
ON_ROWS(half_cosine, half_cosine_all, 4, 4, 1, 1)
ON_ROWS(turn, turn_all, 4, 4, 1, 2)
ON_ROWS(scaled_vectors, scale_vectors, 3, 1, 4, 1)
ON_ROWS(scaled_shorter, scale_shorter, 4, 1, 3, 1)

static PyObject *turns_from_tangents(PyObject *self, PyObject *arguments)
{
    Py_buffer b[2] = {{0}};
    int axes[3];
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*iiiw*", b, axes, axes + 1, axes + 2, b + 1))
        return NULL;
    const int64_t count = b[1].len / (Py_ssize_t)(4 * sizeof(double));
    int fits =
        has_size(b, 3 * count, sizeof(double), "tangents") && has_size(b + 1, 4 * count, sizeof(double), "turns");
    fits = fits && are_three_axes(axes);
    if (fits) {
        Py_BEGIN_ALLOW_THREADS from_tangents(b[0].buf, axes, count, b[1].buf);
        Py_END_ALLOW_THREADS
    }
    return none_if(fits, b, 2);
}

static PyObject *sums_of_euler(PyObject *self, PyObject *arguments)
{
    enum { ROTATIONS, JOINTS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long joints;
    int axes[3];
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Ly*iiiw*", b, &joints, b + 1, axes, axes + 1, axes + 2, b + 2))
        return NULL;
    const Py_ssize_t number = sizeof(double);
    const int64_t count = b[JOINTS].len / (Py_ssize_t)sizeof(int64_t);
    const int64_t frames = joints > 0 ? b[ROTATIONS].len / number / 4 / joints : 0;
    int fits = are_three_axes(axes) && has_size(b + ROTATIONS, frames * joints * 4, sizeof(double), "rotations") &&
               has_size(b + JOINTS, count, sizeof(int64_t), "joints") &&
               has_size(b + OUT, 6 * count * frames, sizeof(double), "sums");
    for (int64_t i = 0; fits && i < count; i++)
        if (((const int64_t *)b[JOINTS].buf)[i] < 0 || ((const int64_t *)b[JOINTS].buf)[i] >= joints) {
            PyErr_Format(PyExc_ValueError, "there are %lld joints", joints);
            fits = 0;
        }
    if (fits) {
        Py_BEGIN_ALLOW_THREADS euler_sums(b[ROTATIONS].buf, 4 * joints, b[JOINTS].buf, count, frames, axes, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    return none_if(fits, b, COUNT);
}

static PyObject *lay_rows(PyObject *self, PyObject *arguments)
{
    enum { TRACKS, COLUMNS, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    double factor;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*Ldw*", b, b + 1, &frames, &factor, b + 2))
        return NULL;
    const int64_t count = b[COLUMNS].len / (Py_ssize_t)sizeof(int64_t), *columns = b[COLUMNS].buf;
    const int64_t width = frames > 0 ? b[OUT].len / (Py_ssize_t)sizeof(double) / frames : 0;
    int fits = has_size(b + TRACKS, count * frames, sizeof(double), "tracks") &&
               has_size(b + OUT, width * frames, sizeof(double), "rows");
    for (int64_t i = 0; fits && i < count; i++)
        if (columns[i] < 0 || columns[i] >= width) {
            PyErr_Format(PyExc_ValueError, "rows have %lld columns", (long long)width);
            fits = 0;
        }
    if (fits) {
        Py_BEGIN_ALLOW_THREADS rows_of_tracks(b[TRACKS].buf, columns, count, frames, factor, b[OUT].buf, width);
        Py_END_ALLOW_THREADS
    }
    return none_if(fits, b, COUNT);
}

/* Whether each run is of a joint that there is, and of frames that it has. */
static int are_runs(const int64_t *runs, int64_t count, int64_t joints, int64_t frames)
{
    for (int64_t i = 0; i < count; i++, runs += 3)
        if (runs[0] < 0 || runs[0] >= joints || runs[1] < 0 || runs[1] > runs[2] || runs[2] > frames) {
            PyErr_Format(PyExc_ValueError, "run %lld has no such joint, or no such frames", (long long)i);
            return 0;
        }
    return 1;
}

static PyObject *make_continuous(PyObject *self, PyObject *arguments)
{
    enum { ANGLES, RUNS, SEEDS, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long frames;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "w*y*y*L", b, b + 1, b + 2, &frames))
        return NULL;
    const Py_ssize_t number = sizeof(double);
    const int64_t count = b[RUNS].len / (Py_ssize_t)(3 * sizeof(int64_t));
    const int64_t axes = count > 0 ? b[SEEDS].len / number / count : 1;
    const int64_t joints = frames > 0 && axes > 0 ? b[ANGLES].len / number / axes / frames : 0;
    int fits = has_size(b + RUNS, 3 * count, sizeof(int64_t), "runs") &&
               has_size(b + SEEDS, axes * count, sizeof(double), "seeds");
    if (fits && (axes < 1 || axes > 3)) {
        PyErr_SetString(PyExc_ValueError, "a joint turns about one to three axes");
        fits = 0;
    }
    fits = fits && (count == 0 || has_size(b + ANGLES, joints * axes * frames, sizeof(double), "angles")) &&
           are_runs(b[RUNS].buf, count, joints, frames);
    for (int64_t i = 0; fits && i < count; i++) {
        const int64_t *run = (const int64_t *)b[RUNS].buf + 3 * i;
        double *angles = (double *)b[ANGLES].buf + run[0] * axes * frames + run[1];
        nearest_angles(angles, axes, frames, run[2] - run[1], (const double *)b[SEEDS].buf + i * axes);
    }
    return none_if(fits, b, COUNT);
}

PyMethodDef array_methods[] = {
    {"multiply", multiply, METH_VARARGS,
        "Write the products of quaternions; False where they lie otherwise in memory."},
    {"between", between, METH_VARARGS, "Write a^-1 b of unit quaternions; False as `multiply`."},
    {"rotate", rotate, METH_VARARGS, "Write vectors turned by quaternions; False as `multiply`."},
    {"unrotate", unrotate, METH_VARARGS, "Write vectors turned back by quaternions; False as `multiply`."},
    {"cross", cross_rows, METH_VARARGS, "Write the cross products of vectors; False as `multiply`."},
    {"dot", dot_rows, METH_VARARGS, "Write the dot products of vectors; False as `multiply`."},
    {"length", length, METH_VARARGS, "Write the lengths of vectors, the second given; False as `multiply`."},
    {"half_cosine", half_cosine, METH_VARARGS, "Write |a . b| of quaternions; False as `multiply`."},
    {"turn", turn, METH_VARARGS, "Write sines and cosines of half the turns between rotations; False as `multiply`."},
    {"scaled_vectors", scaled_vectors, METH_VARARGS,
        "Write vectors, each times a number, into quaternions whose first numbers stay; False as `multiply`."},
    {"scaled_shorter", scaled_shorter, METH_VARARGS,
        "Write the vectors of quaternions, each times a number and of the shorter way; False as `multiply`."},
    {"from_tangents", turns_from_tangents, METH_VARARGS,
        "Write the quaternions of three turns, given the tangents of half their angles."},
    {"euler_sums", sums_of_euler, METH_VARARGS,
        "Write the sines, cosines and lengths that the Euler angles of some joints are arc tangents of."},
    {"rows_of_tracks", lay_rows, METH_VARARGS, "Write tracks, times a factor, as columns of rows."},
    {"nearest_angles", make_continuous, METH_VARARGS, "Make runs of Euler angles continuous, in place."},
    {NULL, NULL, 0, NULL},
};
