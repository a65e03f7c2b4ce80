/* Buffers from Python for the text of BVH files: sizes are checked here. */

#include "../../csrc/module.h"

#include "../../csrc/held.h"
#include "text.h"
#include "touched_rows.h"

#include <math.h>
#include <string.h>

static int read_double(const char *word, int64_t length, double *value)
{
    char text[LONGEST_WORD + 1];
    memcpy(text, word, length);
    text[length] = 0;
    *value = PyOS_string_to_double(text, NULL, NULL);
    if (PyErr_Occurred()) {
        PyErr_Clear();
        return 0;
    }
    return isfinite(*value);
}

static PyObject *rows_from_text(PyObject *self, PyObject *arguments)
{
    enum { TEXT, VALUES, STARTS, STOPS, COUNT };
    Py_buffer b[COUNT] = {{0}};
    RowsFound found = {0};
    long long columns;
    int status = -1;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Lw*w*w*", b, &columns, b + 1, b + 2, b + 3))
        return NULL;
    const int64_t room = b[STARTS].len / (Py_ssize_t)sizeof(int64_t);
    if (columns < 1)
        PyErr_SetString(PyExc_ValueError, "rows have columns");
    else if (has_size(b + STOPS, room, sizeof(int64_t), "stops") &&
             has_size(b + VALUES, room * columns, sizeof(double), "values"))
        status = read_rows(
            b[TEXT].buf, b[TEXT].len, columns, room, read_double, b[VALUES].buf, b[STARTS].buf, b[STOPS].buf, &found);
    release(b, COUNT);
    if (status < 0)
        return NULL;
    if (status == 0)
        Py_RETURN_NONE;
    return Py_BuildValue("LL", (long long)found.rows, (long long)found.decimals);
}

static PyObject *rows_to_text(PyObject *self, PyObject *arguments)
{
    enum { VALUES, ENDING, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    long long columns;
    int decimals;
    int64_t length = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*Liy*w*", b, &columns, &decimals, b + 1, b + 2))
        return NULL;
    const int64_t count = b[VALUES].len / (Py_ssize_t)sizeof(double);
    if (columns < 1 || count % columns || decimals < 1 || decimals > 17)
        PyErr_SetString(PyExc_ValueError, "no such rows, or no such decimals");
    else if (has_size(b + OUT, count * longest_number(decimals) + count / columns * b[ENDING].len, 1, "text")) {
        Py_BEGIN_ALLOW_THREADS length =
            write_rows(b[VALUES].buf, count / columns, columns, decimals, b[ENDING].buf, b[ENDING].len, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    release(b, COUNT);
    return length < -1 ? NULL : PyLong_FromLongLong(length);
}

static PyObject *plain_gaps(PyObject *self, PyObject *arguments)
{
    Py_buffer text = {0};
    long long count;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*L", &text, &count))
        return NULL;
    const int are_plain = has_plain_gaps(text.buf, text.len, count);
    PyBuffer_Release(&text);
    return PyBool_FromLong(are_plain);
}

static PyObject *splice(PyObject *self, PyObject *arguments)
{
    enum { TEXT, CELLS, VALUES, OUT, COUNT };
    Py_buffer b[COUNT] = {{0}};
    int decimals;
    int64_t length = -2;
    (void)self;
    if (!PyArg_ParseTuple(arguments, "y*y*y*iw*", b, b + 1, b + 2, &decimals, b + 3))
        return NULL;
    const int64_t words = b[CELLS].len;
    if (decimals < 1 || decimals > 17)
        PyErr_SetString(PyExc_ValueError, "no such decimals");
    else if (has_size(b + VALUES, words, sizeof(double), "values") &&
             has_size(b + OUT, b[TEXT].len + words * longest_number(decimals), 1, "text")) {
        Py_BEGIN_ALLOW_THREADS length =
            splice_words(b[TEXT].buf, b[TEXT].len, b[CELLS].buf, b[VALUES].buf, words, decimals, b[OUT].buf);
        Py_END_ALLOW_THREADS
    }
    release(b, COUNT);
    return length < -1 ? NULL : PyLong_FromLongLong(length);
}

/* Whether there are such joints, and such columns. */
static int are_places(const Turned *of)
{
    for (int64_t i = 0; i < of->count; i++)
        if (of->joints[i] < 0 || of->joints[i] >= of->all)
            return 0;
    for (int64_t i = 0; i < 3 * of->count; i++)
        if (of->columns[i] < 0 || of->columns[i] >= of->width)
            return 0;
    return 1;
}

static PyObject *rows_where_touched(PyObject *self, PyObject *arguments)
{
    PyObject *sums, *joints, *columns, *touched, *given, *values, *cells;
    long long count, all, frames, width;
    int are_written = -1;
    Turned of;
    Held held = {.count = 0};
    (void)self;
    if (!PyArg_ParseTuple(arguments, "OOOOOOOLLLLddd", &sums, &joints, &columns, &touched, &given, &values, &cells,
            &count, &all, &frames, &width, &of.sign, &of.most_middle, &of.most_wound))
        return NULL;
    of.count = count, of.all = all, of.frames = frames, of.width = width;
    double *const angles = items_of(&held, sums, 6 * count * frames, sizeof(double), 1, "sums");
    double *const rows = angles ? items_of(&held, values, frames * width, sizeof(double), 1, "values") : NULL;
    uint8_t *const written = rows ? items_of(&held, cells, frames * width, 1, 1, "cells") : NULL;
    of.joints = written ? items_of(&held, joints, count, sizeof(int64_t), 0, "joints") : NULL;
    of.columns = of.joints ? items_of(&held, columns, 3 * count, sizeof(int64_t), 0, "columns") : NULL;
    of.touched = of.columns ? items_of(&held, touched, frames * all, 1, 0, "what is touched") : NULL;
    of.given = of.touched ? items_of(&held, given, frames * width, sizeof(double), 0, "what is given") : NULL;
    if (of.given != NULL && !are_places(&of))
        PyErr_SetString(PyExc_ValueError, "no such joints, or no such columns");
    else if (of.given != NULL)
        are_written = touched_rows(&of, angles, rows, written);
    let_go(&held);
    return are_written < 0 ? NULL : PyBool_FromLong(are_written);
}

PyMethodDef text_methods[] = {
    {"rows_from_text", rows_from_text, METH_VARARGS,
        "Read rows of numbers; return how many and the most decimals, or None where it is no such text."},
    {"rows_to_text", rows_to_text, METH_VARARGS,
        "Write rows of numbers; return the text's length, -1 where one is large."},
    {"plain_gaps", plain_gaps, METH_VARARGS, "Return whether a text's blanks are so many, single ones and line feeds."},
    {"splice", splice, METH_VARARGS,
        "Copy text with some words replaced by numbers; return its length, -1 where one is large."},
    {"touched_rows", rows_where_touched, METH_VARARGS,
        "Write the angles of joints as rows where they are touched; False where that takes more."},
    {NULL, NULL, 0, NULL},
};
