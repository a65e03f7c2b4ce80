/* Buffers from Python for what is in this folder: sizes are checked here, so that a slip there is an error and not a
   crash. */

#include "module.h"

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

PyMethodDef body_methods[] = {
    {"stands", stands, METH_VARARGS, "Return the stretches in which points of feet stand."},
    {NULL, NULL, 0, NULL},
};
